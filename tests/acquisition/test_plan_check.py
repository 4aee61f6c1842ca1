from collections.abc import Callable
from typing import Any

import pytest

from acquisition.plan_check import check_against
from acquisition.plans import Aim, Plan, amc_plan, ptm_plan
from acquisition.plans.light_path import LightPath
from acquisition.plans.poses import AmcPoses, PtmPoses
from acquisition.plans.turn import Turn
from litrig.base.errors import InputError
from rig.config import AlwaysOnConfig, ArmConfig, CameraConfig, RigConfig, SpindleLampConfig, TurntableConfig
from rig.sections import ArmSection
from tests.acquisition.plans.test_light_path import DOME, dome_rig

CAMERA = CameraConfig(device="x")
LAMP = SpindleLampConfig(kind="grbl-spindle")
LIGHTS = tuple(Aim(20.0 + 50 * i, 20.0 + 8 * i) for i in range(6))
PTM = Plan(PtmPoses(LightPath(LIGHTS)))


def arm(**keys: Any) -> RigConfig:
    return RigConfig(arm=ArmConfig.model_validate({"port": "x", **keys}), lights=LAMP, camera=CAMERA)


def table(**keys: Any) -> RigConfig:
    return RigConfig(turntable=TurntableConfig.model_validate({"port": "x", **keys}), camera=CAMERA)


def dome(angles: tuple[tuple[float, float], ...] = DOME) -> RigConfig:
    return dome_rig(angles).model_copy(update={"camera": CAMERA})


def test_plans_within_reach_pass_without_a_remark() -> None:
    assert check_against(amc_plan(64, closure=True), table()) == ()
    assert check_against(PTM, arm()) == ()
    assert check_against(ptm_plan(12, dome()), dome()) == ()


@pytest.mark.parametrize(
    ("plan", "config", "message"),
    [
        (amc_plan(8), lambda: RigConfig(), r"no camera: RIG\.toml has no \[camera\]"),
        (amc_plan(8), lambda: arm(), r"step 0 \(000000_tt000\.00\): the rig has no turntable"),
        (amc_plan(8), lambda: table(max_deg=180.0), r"step 5 .*225° is outside -360\.\.180°; nothing moved"),
        (amc_plan(8, closure=True), lambda: table(max_deg=350.0), r"step 8 .*closure_tt360\.00\): turntable: 360°"),
        (Plan(AmcPoses(Turn(8, start_deg=-400))), lambda: table(), r"step 0 .*-400° is outside"),
        (PTM, lambda: arm().model_copy(update={"lights": None}), r"step 0 .*no lights: RIG\.toml has no \[lights\]"),
        (PTM, lambda: table().model_copy(update={"lights": LAMP}), r"step 0 .*no arm, and its lamps have no dir"),
        (PTM, lambda: arm(max_elevation_deg=50.0), r"step 4 .*elevation 52° is outside its reach .*5\.\.50"),
        (
            PTM,
            lambda: arm(zones=[{"name": "post", "azimuth_deg": [100, 140], "elevation_deg": [20, 60]}]),
            r"step 2 .*in the zone 'post'",
        ),
        (ptm_plan(12, dome()), lambda: dome(DOME[:6]), r"step 6 .*lamp 6 does not exist; the rig has 0\.\.5"),
        (
            ptm_plan(12, dome()),
            lambda: dome(tuple((a, e + 1) for a, e in DOME)),
            r"step 0 .*lamp 0 hangs at azimuth 0°, elevation 21°, not at 0°, 20°",
        ),
    ],
)
def test_what_the_rig_cannot_shoot_is_refused_with_the_step(
    plan: Plan, config: Callable[[], RigConfig], message: str
) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        check_against(plan, config())
    assert "\n" not in str(refusal.value)


def test_what_only_a_driver_knows_is_said() -> None:
    foreign = RigConfig(arm=ArmSection(kind="other", port="x"), lights=AlwaysOnConfig(kind="always-on"), camera=CAMERA)
    assert check_against(PTM, foreign) == (
        "what an arm of kind other reaches only its driver knows; it is checked before it moves",
    )
