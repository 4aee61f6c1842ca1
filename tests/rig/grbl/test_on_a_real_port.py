"""Stepper turntable, arm and lamp through RIG.toml, on the ports of a simulator in its own process."""

from typing import Any

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from rig.config import read_rig
from rig.errors import RigError
from rig.rig import open_rig
from tests.rig.grbl.bench import QUICK

PARTS = frozenset({"turntable", "arm", "lights"})


@pytest.mark.parametrize(
    "sim",
    [
        pytest.param({"stepper": {"axis": "Z"}}, id="on a controller of its own"),
        pytest.param(
            {"stepper": {"axis": "A", "on_the_arm": True}, "arm": {"dialect": "grblHAL", "settings": QUICK}},
            id="on the arm's, with grblHAL",
        ),
    ],
)
def test_a_stepper_table_and_an_arm_go_where_they_are_told(sim: dict[str, Any]) -> None:
    config = {"scene": {"kind": "relief"}, "arm": {"settings": QUICK}, **sim}
    with simulated_rig(SimConfig.model_validate(config)) as running:
        with open_rig(read_rig(running.rig_toml), use=PARTS) as rig:
            rig.home()
            assert rig.turn_to(30.0).angle_deg == pytest.approx(30, abs=0.01)
            rig.light_from(120, 40)
            rig.lights.switch_on()
            status = running.side_channel.status()
            assert status["lamp"] == 1
            places = (status["turntable_deg"], status["azimuth_deg"], status["elevation_deg"])
            assert places == pytest.approx((30, 120, 40), abs=0.02)
        with open_rig(read_rig(running.rig_toml), use=frozenset({"turntable"})) as rig:
            rig.turntable.home()
            assert rig.turntable.locate().angle_deg == pytest.approx(30, abs=0.01), "nothing has moved its zero"


def test_a_table_on_one_of_the_arms_own_axes_is_refused(tmp_path: Any) -> None:
    path = tmp_path / "rig.toml"
    path.write_text('[turntable]\nkind = "grbl"\nport = "/dev/x"\naxis = "Y"\n[arm]\nport = "/dev/x"\n', "utf-8")
    with pytest.raises(RigError, match=r"axis Y is one of the arm's; the table's is Z, A, B or C"):
        open_rig(read_rig(path), use=frozenset({"turntable"}))
