"""What a plan will cost, held against the drivers on simulated devices, whose clock nobody waits for."""

import itertools
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition.forecast import Forecast, forecast, usual_rig
from acquisition.forecast_motion import ArmMotion, TableMotion
from acquisition.forecast_picture import Picture
from acquisition.plans import Aim, Plan, amc_plan, ptm_plan
from acquisition.plans.light_path import LightPath, evenly
from acquisition.plans.poses import AmcPoses, ProductPoses, PtmPoses
from acquisition.plans.shooting import Exposures, Reference
from acquisition.plans.turn import Turn
from acquisition.tour import tour_cost
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError
from rig.arm.geometry import Joints
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig, CameraConfig, RigConfig, SpindleLampConfig, TurntableConfig
from rig.grbl.config import StepperTurntableConfig
from rig.sections import ArmSection, CameraSection, TurntableSection
from tests.acquisition.plans.any_plan import any_plan
from tests.acquisition.plans.test_light_path import dome_rig
from tests.rig.dynamixel.wires import Bench as ServoBench
from tests.rig.grbl.bench import Bench as GrblBench

LIGHTS = tuple(Aim(20.0 + 50 * i, 20.0 + 8 * i) for i in range(6))
ANGLES_DEG = (20.0, 25.0, 25.6, 25.7, 200.0, 30.0, -90.0, -89.0)
ACCELERATION = {"speed_deg_s": 60.0, "acceleration_deg_s2": 200.0}


def rig(**parts: Any) -> RigConfig:
    return usual_rig().model_copy(update=parts)


def lit_by(**lamp: Any) -> RigConfig:
    return rig(lights=SpindleLampConfig.model_validate({"kind": "grbl-spindle", **lamp}))


@pytest.mark.parametrize("backlash_deg", [0.0, 1.0, 4.0])
def test_the_servo_takes_as_long_as_forecast(backlash_deg: float) -> None:
    bench = ServoBench()
    settings = {**ACCELERATION, "backlash_deg": backlash_deg}
    table = bench.turntable(**settings)
    table.home()
    motion = TableMotion.of(TurntableConfig.model_validate({"port": "x", **settings}))
    here_deg = table.move_to(10.0).angle_deg and 10.0
    for angle_deg in ANGLES_DEG:
        began_s = bench.now_s()
        table.move_to(angle_deg)
        legs_deg = motion.legs_deg(here_deg, angle_deg)
        expected_s = motion.time_s(legs_deg) + motion.settling_s(legs_deg)
        assert bench.now_s() - began_s == pytest.approx(expected_s, rel=0.05, abs=0.06), (here_deg, angle_deg)
        here_deg = angle_deg


def test_the_arm_takes_as_long_as_forecast() -> None:
    zones = [{"name": "post", "azimuth_deg": (80, 100), "elevation_deg": (20, 60)}]
    keys: dict[str, Any] = {**ACCELERATION, "zones": zones}
    bench = GrblBench(settings={120: 200.0, 121: 200.0, 110: 20_000.0, 111: 20_000.0})
    arm = bench.arm(**keys)
    arm.home()
    motion = ArmMotion(ArmConfig.model_validate({"port": "x", **keys}))
    arm.move_to(70, 30)
    here = Joints(70, 30)
    for azimuth_deg, elevation_deg in ((110, 30), (112, 31), (300, 80), (310, 10)):
        began_s = bench.clock.time_s
        arm.move_to(azimuth_deg, elevation_deg)
        way = motion.way(here, Aim(azimuth_deg, elevation_deg))
        # A controller does not stop at the bends of a way, and along a diagonal both axes brake.
        assert bench.clock.time_s - began_s == pytest.approx(motion.time_s(here, way), rel=0.25, abs=0.15)
        here = way[-1]


@given(st.floats(-300, 300), st.floats(-300, 300), st.floats(0, 5))
def test_every_approach_of_the_table_ends_upwards_and_runs_up_by_the_backlash(
    here_deg: float, goal_deg: float, backlash_deg: float
) -> None:
    legs_deg = TableMotion(90, 600, backlash_deg).legs_deg(here_deg, goal_deg)
    if here_deg == goal_deg:
        assert legs_deg == ()
    elif here_deg <= goal_deg - backlash_deg:
        assert legs_deg == (goal_deg - here_deg,)
    else:
        assert legs_deg[0] == pytest.approx(here_deg - goal_deg + backlash_deg)
        assert sum(legs_deg) == pytest.approx(here_deg - goal_deg + 2 * backlash_deg)


def test_a_stepper_does_not_run_up_from_below_its_limit() -> None:
    config = StepperTurntableConfig(kind="grbl", port="x", min_deg=0.0, backlash_deg=2.0, settings={123: 80.0})
    motion = TableMotion.of(config)
    assert motion.legs_deg(10, 1) == (10, 1)
    assert motion.acceleration_deg_s2 == 80
    assert motion.assumptions == ()
    assert TableMotion.of(config.model_copy(update={"settings": {}})).assumptions == ("the table's $123 is 500",)


def test_a_tour_takes_the_travel_times_that_it_was_made_by() -> None:
    config = rig()
    assert isinstance(config.arm, ArmConfig)
    aims = tuple(aim for aim in evenly(40) if aim.azimuth_deg)
    costs = travel_times_s(config.arm, [(aim.azimuth_deg, aim.elevation_deg) for aim in aims])
    motion = ArmMotion(config.arm)
    first_s = motion.time_s(motion.home, motion.way(motion.home, aims[0]))
    expected = forecast(Plan(PtmPoses(LightPath(aims))), config)
    assert expected.moves_s == pytest.approx(tour_cost(costs, range(len(aims))) + first_s)


def test_a_tour_is_forecast_to_be_quicker_than_the_spiral() -> None:
    toured, spiral = (forecast(ptm_plan(80, usual_rig(), order=order), usual_rig()) for order in ("tour", "given"))
    assert toured.moves_s < 0.45 * spiral.moves_s
    assert toured.arm_deg < 0.3 * spiral.arm_deg


def test_forwards_and_backwards_is_shorter_than_with_a_way_back_each_time() -> None:
    turns = 4
    one = forecast(Plan(ProductPoses(Turn(1), LightPath(LIGHTS))), usual_rig())
    all_of_them = forecast(Plan(ProductPoses(Turn(turns), LightPath(LIGHTS))), usual_rig())
    assert all_of_them.arm_deg < turns * one.arm_deg
    assert all_of_them.table_deg > one.table_deg == 0


def test_average_frames_take_exposures_and_no_ways() -> None:
    one, three = (forecast(Plan(AmcPoses(Turn(16)), Exposures(average=n)), usual_rig()) for n in (1, 3))
    assert (three.moves_s, three.table_deg) == pytest.approx((one.moves_s, one.table_deg))
    assert three.exposures_s == pytest.approx(3 * one.exposures_s)
    assert three.disk_bytes == pytest.approx(3 * one.disk_bytes, rel=1e-6)


def test_a_stop_more_exposes_twice_as_long_and_changing_costs_frames() -> None:
    picture = Picture(0.5, 0.04, 1, "")
    assert picture.time_s(1, changed=False) == pytest.approx(2 * picture.time_s(0, changed=False))
    assert picture.time_s(-5, changed=False) == pytest.approx(0.5 / 32 + 2.5 * 0.04)
    assert picture.time_s(0, changed=True) == pytest.approx(picture.time_s(0, changed=False) + 2 * 0.5)


def test_a_lamp_that_has_to_warm_up_does_so_at_each_pose() -> None:
    plan = Plan(PtmPoses(LightPath(LIGHTS)))
    cold, warm = (forecast(plan, lit_by(warm_up_s=warm_up_s)) for warm_up_s in (0.0, 2.0))
    assert warm.settles_s == pytest.approx(cold.settles_s + 2 * 6)


def test_a_lamp_of_a_dome_warms_up_when_it_is_lit() -> None:
    dome = dome_rig().model_copy(update={"camera": usual_rig().camera})
    plan = ptm_plan(12, dome)
    once, twice = (forecast(replace(plan, exposures=Exposures(average=n)), dome) for n in (1, 2))
    assert once.settles_s == pytest.approx(12 * 0.05) == twice.settles_s
    assert once.moves_s == once.arm_deg == 0


def test_frames_are_kept_while_the_rig_moves() -> None:
    slow = rig(turntable=TurntableConfig(port="x", speed_deg_s=5.0))
    still = forecast(Plan(AmcPoses(Turn(8)), Exposures(average=10)), usual_rig())
    moving = forecast(amc_plan(80), slow)
    assert moving.steps_s < 0.05 * still.steps_s


def test_dark_frames_move_nothing() -> None:
    plan = amc_plan(16)
    dark = replace(plan, references=(Reference(Role.DARK, 50, when="both"),))
    assert forecast(dark, usual_rig()).moves_s == forecast(plan, usual_rig()).moves_s
    assert forecast(replace(dark, references=(Reference(Role.DARK, ask="Cover it"),)), usual_rig()).asks == 2


@pytest.mark.parametrize(("pixel_format", "share"), [("MJPG", 0.4), ("YUYV", 1.9)])
def test_the_disk_is_reckoned_by_pixels(pixel_format: str, share: float) -> None:
    sizes = []
    for width, height in ((640, 480), (1280, 960)):
        camera = CameraConfig.model_validate(
            {"device": "x", "width": width, "height": height, "pixel_format": pixel_format}
        )
        expected = forecast(amc_plan(100), rig(camera=camera))
        sizes.append(expected.disk_bytes / 100)
        assert f"at {share:g} bytes a pixel" in expected.assumptions[0]
    assert sizes[1] - sizes[0] == pytest.approx(3 * 640 * 480 * share)


def test_of_devices_of_other_packages_it_says_what_it_assumes() -> None:
    foreign = rig(
        turntable=TurntableSection(kind="other", port="x"),
        arm=ArmSection(kind="other", port="x"),
        camera=CameraSection(kind="other"),
    )
    expected = forecast(Plan(ProductPoses(Turn(3), LightPath(LIGHTS))), foreign)
    assert len(expected.assumptions) == 3
    assert "30 MB a picture" in expected.assumptions[0]
    assert expected.moves_s > 18 * 2
    assert expected.disk_bytes > 18 * 30e6


def test_a_way_that_zones_bar_is_refused_with_its_step() -> None:
    wall = {"name": "wall", "azimuth_deg": [170, 190], "elevation_deg": [-90, 90]}
    arm = ArmConfig.model_validate({"port": "x", "zones": [wall]})
    plan = Plan(PtmPoses(LightPath(LIGHTS)))
    with pytest.raises(InputError, match=r"step 0 \(000000_az020.*no way leads to azimuth 20°"):
        forecast(plan, rig(arm=arm))


@given(any_plan())
def test_every_plan_can_be_forecast_and_its_parts_add_up(plan: Plan) -> None:
    expected = forecast(plan, usual_rig())
    parts = (expected.homing_s, expected.moves_s, expected.settles_s, expected.exposures_s, expected.steps_s)
    assert all(part >= 0 for part in parts)
    assert expected.total_s == pytest.approx(sum(parts))
    assert expected.asks == sum(bool(step.ask) for step in plan)
    assert expected.as_json()["total_s"] == pytest.approx(expected.total_s, abs=1e-3)
    assert isinstance(expected, Forecast)
    angles_deg = [step.angle_deg for step in plan if step.angle_deg is not None]
    assert expected.table_deg >= sum(abs(b - a) for a, b in itertools.pairwise(angles_deg)) - 1e-6
