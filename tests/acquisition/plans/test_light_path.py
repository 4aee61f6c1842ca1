from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition.plans import Aim, ptm_plan
from acquisition.plans.choose_lights import LightWish, choose_lights
from acquisition.plans.light_path import Sector, evenly, far_apart, in_tour, lamps_of, on_rings, onto_lamps, towards
from acquisition.tour import tour_cost
from litrig.base.directions import direction_from_angles
from litrig.base.errors import FormatError, InputError
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig, RigConfig
from rig.udmx.config import UdmxConfig, UdmxLamp

DOME = tuple((37.0 * i % 360, 20.0 + 5 * i) for i in range(12))
LP = "3\na.jpg 1 0 1\nb.jpg 0 1 1\nc.jpg 0 0.1 1\n"


def dome_rig(angles: tuple[tuple[float, float], ...] = DOME) -> RigConfig:
    lamps = tuple(UdmxLamp(channels=(i + 1,), azimuth_deg=a, elevation_deg=e) for i, (a, e) in enumerate(angles))
    return RigConfig(lights=UdmxConfig(kind="udmx", lamp=lamps))


def directions(aims: list[Aim]) -> np.ndarray:
    return np.array([direction_from_angles(aim.azimuth_deg, aim.elevation_deg) for aim in aims])


def test_lights_are_spread_evenly() -> None:
    aims = evenly(200)
    assert all(15 <= aim.elevation_deg <= 80 for aim in aims)
    spread = directions(aims)
    nearest = np.sort(np.arccos(np.clip(spread @ spread.T, -1, 1)), axis=1)[:, 1]
    assert nearest.min() > 0.6 * np.median(nearest)
    np.testing.assert_allclose(spread.mean(0)[:2], 0, atol=0.02)


@given(st.integers(1, 60), st.floats(-40, 300), st.floats(1, 359.9))
def test_lights_keep_to_their_sector(lights: int, start: float, width: float) -> None:
    sector = Sector(10, 70, (start, start + width))
    wider = Sector(9.99, 70.01, (start - 0.001, start + width + 0.001))
    assert all(wider.holds(aim) for aim in evenly(lights, sector))


def test_rings_are_turned_against_each_other() -> None:
    aims = on_rings([(20, 4), (40, 4)])
    assert [aim.azimuth_deg for aim in aims] == [0, 90, 180, 270, 45, 135, 225, 315]
    assert [aim.elevation_deg for aim in aims] == [20] * 4 + [40] * 4


def test_rings_over_a_part_of_the_turn_have_lights_at_both_ends() -> None:
    assert [aim.azimuth_deg for aim in on_rings([(30, 3), (60, 1)], (-90, 90))] == [270, 0, 90, 270]


def test_lights_of_a_list_keep_its_order(tmp_path: Path) -> None:
    (tmp_path / "l.lp").write_text(LP, encoding="utf-8")
    path = choose_lights(LightWish(file=tmp_path / "l.lp", order="given"), None)
    assert path.aims == (Aim(0, 45), Aim(90, 45), Aim(90, 84.289))
    assert path.made_from["source"] == "file"
    assert path.made_from["file"] == "l.lp"


def test_lights_of_a_list_beyond_the_cone_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "l.lp").write_text(LP, encoding="utf-8")
    wish = LightWish(file=tmp_path / "l.lp", sector=Sector(10, 80))
    assert len(choose_lights(wish, None).aims) == 2
    with pytest.raises(InputError, match=r"none of 3 lies within the elevations 10\.\.20°"):
        choose_lights(LightWish(file=tmp_path / "l.lp", sector=Sector(10, 20)), None)


def test_of_many_lights_those_are_chosen_that_lie_far_apart() -> None:
    chosen = directions(far_apart(evenly(200), 20))
    apart_deg = np.degrees(np.arccos(np.clip(np.sort(chosen @ chosen.T, axis=1)[:, -2], -1, 1)))
    assert apart_deg.min() > 20


@given(st.integers(6, 40), st.data())
def test_lamps_of_a_dome_are_chosen_once_each_and_in_order(count: int, data: st.DataObject) -> None:
    angles = tuple((round(i * 137.5 % 360, 3), round(10 + 70 * i / count, 3)) for i in range(count))
    wanted = data.draw(st.integers(6, count))
    aims = [step.aim for step in ptm_plan(wanted, dome_rig(angles)) if step.aim is not None]
    lamps = [aim.lamp for aim in aims]
    assert len(lamps) == wanted
    assert lamps == sorted(set(lamps))
    assert [(aim.azimuth_deg, aim.elevation_deg) for aim in aims] == [angles[lamp] for lamp in lamps]


def test_all_lamps_of_a_dome_in_the_cone_are_taken_if_no_number_is_said() -> None:
    path = choose_lights(LightWish(sector=Sector(30, 60)), dome_rig())
    assert [aim.lamp for aim in path.aims] == [2, 3, 4, 5, 6, 7, 8] == path.made_from["lamps"]


def test_directions_near_a_domes_lamps_are_those_lamps() -> None:
    wanted = towards(directions([Aim(37.5, 25.4), Aim(0.0, 20.0)]))
    assert onto_lamps(wanted, DOME) == [lamps_of(DOME)[1], lamps_of(DOME)[0]]
    with pytest.raises(InputError, match=r"azimuth 40°, elevation 25°: the dome's nearest lamp, 1, hangs 2\.7° off"):
        onto_lamps([Aim(40, 25)], DOME)


@pytest.mark.parametrize("lights", [5, 13])
def test_more_lamps_than_there_are_and_too_few_are_refused(lights: int) -> None:
    with pytest.raises(InputError, match=r"lights: \d+ is outside"):
        ptm_plan(lights, dome_rig())


def test_a_tour_is_much_shorter_than_the_spiral() -> None:
    spiral = [(aim.azimuth_deg, aim.elevation_deg) for aim in evenly(50)]
    toured = [(aim.azimuth_deg, aim.elevation_deg) for aim in in_tour(evenly(50))]
    way = [np.linalg.norm(np.diff(points, axis=0), axis=1).sum() for points in (toured, spiral)]
    assert sorted(toured) == sorted(spiral)
    assert way[0] < 0.25 * way[1]


def test_a_tour_goes_by_the_travel_time_of_the_arm_if_that_is_known() -> None:
    arm = ArmConfig.model_validate({"port": "x", "max_azimuth_deg": 720.0, "azimuth_origin_deg": -720.0})
    costs = travel_times_s(arm, [(aim.azimuth_deg, aim.elevation_deg) for aim in evenly(60)])
    by_time, by_angle = ([evenly(60).index(aim) for aim in in_tour(evenly(60), known)] for known in (arm, None))
    assert sorted(by_time) == list(range(60))
    assert tour_cost(costs, by_time) < tour_cost(costs, by_angle)


def test_lights_beyond_the_arms_reach_are_put_in_order_all_the_same() -> None:
    arm = ArmConfig.model_validate({"port": "x", "max_elevation_deg": 50.0})
    assert in_tour(evenly(20), arm) == in_tour(evenly(20))


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        (lambda: Sector(40, 30), r"40\.\.30° must rise"),
        (lambda: Sector(float("nan"), 30), r"must rise"),
        (lambda: Sector(10, 30, (0, 400)), r"azimuth_deg: 0\.\.400° must rise, by 360° at most"),
        (lambda: LightWish(count=9, rings=((20, 9),)), r"leave out count and file"),
        (lambda: choose_lights(LightWish(), None), r"count: is missing, for the rig has no dome"),
        (lambda: evenly(10**9), r"lights: 1000000000 is outside 1\.\.2000"),
        (lambda: choose_lights(LightWish(file=Path("absent.lp")), None), r"absent\.lp: no such file"),
    ],
)
def test_lights_that_nobody_can_have_are_refused(wish: object, message: str) -> None:
    assert callable(wish)
    with pytest.raises(InputError, match=message):
        wish()


def test_a_damaged_list_is_named(tmp_path: Path) -> None:
    (tmp_path / "l.lp").write_text("2\na.jpg 1 0 0\n", encoding="utf-8")
    with pytest.raises(FormatError, match=r"l\.lp: promises 2 lights and has 1"):
        choose_lights(LightWish(file=tmp_path / "l.lp"), None)
