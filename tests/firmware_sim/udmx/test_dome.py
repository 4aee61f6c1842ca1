import tomllib

import numpy as np
import pytest

from firmware_sim.config import ReliefScene, SimConfig
from firmware_sim.errors import SideChannelError
from firmware_sim.launch import simulated_rig
from firmware_sim.rig_toml import rig_toml
from firmware_sim.scene.pose import LitLamp, Pose
from firmware_sim.scene.relief import Relief
from firmware_sim.udmx.config import DomeSim
from firmware_sim.udmx.dome import Dome


def slots_of(*lit: int) -> bytes:
    return bytes(255 * (slot in lit) for slot in range(512))


def test_lamps_are_spread_evenly_between_the_elevations() -> None:
    directions = Dome(DomeSim(lamps=100)).directions_deg
    assert all(15 <= elevation_deg <= 75 for _, elevation_deg in directions)
    around = np.exp(1j * np.radians([azimuth_deg for azimuth_deg, _ in directions]))
    assert abs(around.mean()) < 0.02
    heights = np.sin(np.radians([elevation_deg for _, elevation_deg in directions]))
    np.testing.assert_allclose(np.diff(heights), np.diff(heights)[0], atol=1e-4)


def test_gains_of_rig_toml_make_up_for_uneven_lamps() -> None:
    config = SimConfig(scene=ReliefScene(), dome=DomeSim(lamps=9, unevenness=0.5))
    assert config.dome is not None
    dome = Dome(config.dome)
    assert max(dome.brightness) == 2 * min(dome.brightness)
    lights = tomllib.loads(rig_toml(config, "/dev/a", "/dev/b", "/c"))["lights"]
    lit = dome.lit(bytes(round(255 * lamp["gain"]) for lamp in lights["lamp"]) + bytes(503))
    assert [lamp.power for lamp in lit] == pytest.approx([min(dome.brightness)] * 9, abs=1 / 255)
    assert [(lamp["azimuth_deg"], lamp["elevation_deg"]) for lamp in lights["lamp"]] == list(dome.directions_deg)


def test_crossed_wires_and_dead_lamps() -> None:
    dome = Dome(DomeSim(lamps=8, unevenness=0, swapped=(2, 5), dead=(3,)))
    assert [lamp[:2] for lamp in dome.lit(slots_of(2))] == [dome.directions_deg[5]]
    assert [lamp[:2] for lamp in dome.lit(slots_of(5, 3))] == [dome.directions_deg[2]]
    dome.mend()
    assert [lamp[:2] for lamp in dome.lit(slots_of(2, 3))] == list(dome.directions_deg[2:4])


def test_sixteen_bits() -> None:
    dome = Dome(DomeSim(lamps=2, unevenness=0, sixteen_bit=True))
    assert [lamp.power for lamp in dome.lit(b"\1\2\xff\xff" + bytes(508))] == [258 / 65_535, 1]


def test_light_of_several_lamps_adds_up() -> None:
    scene = Relief(ReliefScene())
    lamps = (LitLamp(30, 40, 1.0), LitLamp(200, 60, 0.5))
    pictures = [scene.light([Pose(0, 0, 0, 0, dome)], (60, 80)) for dome in ((), lamps[:1], lamps[1:], lamps)]
    dark, one, other, both = pictures
    np.testing.assert_allclose(both - dark, one - dark + other - dark, atol=1e-6)
    on_the_arm = scene.light([Pose(0, 30, 40, 1.0)], (60, 80))
    np.testing.assert_array_equal(one, on_the_arm)


def test_a_lamp_that_is_not_there_cannot_break() -> None:
    with simulated_rig(SimConfig(scene=ReliefScene(), dome=DomeSim(lamps=4))) as sim:
        with pytest.raises(SideChannelError, match=r"there are lamps 0\.\.3 only"):
            sim.side_channel.request("lights.dead", lamp=4)
        sim.side_channel.request("lights.swap", one=0, other=3)
        assert sim.side_channel.status()["dome"] == []
