import itertools
from collections.abc import Callable

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from acquisition.plans import Aim, Plan, Step, amc_plan, ptm_plan
from acquisition.plans.light_path import LightPath
from acquisition.plans.poses import AmcPoses, ProductPoses, PtmPoses
from acquisition.plans.shooting import COVER_LENS, SAMPLE_BACK, Exposures, Reference
from acquisition.plans.turn import Turn
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError
from tests.acquisition.plans.any_plan import any_plan

LIGHTS = LightPath(tuple(Aim(60.0 * i, 20.0 + 10 * i) for i in range(6)))


def angles(plan: Plan, role: Role = Role.FRAME) -> list[float | None]:
    return [step.angle_deg for step in plan if step.role is role]


@given(any_plan())
def test_a_plan_is_as_long_as_it_says_and_the_same_each_time(plan: Plan) -> None:
    steps = list(plan)
    assert len(plan) == len(steps)
    assert list(plan) == steps
    assert [step.step for step in steps] == list(range(len(plan)))


@given(any_plan())
def test_no_two_steps_of_a_plan_are_the_same_frame(plan: Plan) -> None:
    frames = [(step.role, step.angle_deg, step.aim, step.exposure_ev, step.lit, step.repeat) for step in plan]
    assert len(set(frames)) == len(frames)
    assert len({step.stem for step in plan}) == len(frames)


@given(any_plan())
def test_what_a_plan_was_made_from_can_be_kept_as_toml(plan: Plan) -> None:
    assert f'kind = "{plan.kind}"' in tomli_w.dumps({"plan": plan.parameters()})


@given(any_plan())
def test_only_dark_frames_are_unlit_and_they_move_nothing(plan: Plan) -> None:
    for step in plan:
        assert step.lit is (step.role is not Role.DARK)
        assert step.lit or (step.angle_deg, step.aim) == (None, None)


@given(st.integers(8, 600))
def test_slices_divide_one_turn_without_adding_up_errors(slices: int) -> None:
    assert angles(amc_plan(slices)) == [360 * s / slices for s in range(slices)]


def test_the_shorthand_of_a_turn_shoots_its_slices_and_nothing_else() -> None:
    assert [step.role for step in amc_plan(8)] == [Role.FRAME] * 8
    closed = list(amc_plan(8, closure=True))
    assert closed[8] == Step(8, Role.CLOSURE, 360.0)
    assert closed[:8] == list(amc_plan(8))


def test_less_than_a_turn_is_shot_from_end_to_end_and_closed_at_its_start() -> None:
    plan = Plan(AmcPoses(Turn(10, start_deg=-45, range_deg=90, closure=True)))
    assert angles(plan) == [-45 + 10 * s for s in range(10)]
    assert angles(plan, Role.CLOSURE) == [-45]
    assert angles(Plan(ProductPoses(Turn(1, range_deg=90), LIGHTS))) == [0.0] * 6


def test_repeats_go_through_the_same_angles_again() -> None:
    plan = Plan(AmcPoses(Turn(8, start_deg=10, repeats=2, closure=True)))
    assert angles(plan)[8:] == angles(plan)[:8]
    assert [step.repeat for step in plan] == [0] * 8 + [1] * 8 + [0]
    assert angles(plan, Role.CLOSURE) == [370.0]


def test_the_first_pose_is_visited_again_after_every_so_many() -> None:
    plan = Plan(AmcPoses(Turn(8, start_deg=5, closure=True)), Exposures((1.0, 0.0), 2), revisit_every=3)
    closures = [step for step in plan if step.role is Role.CLOSURE]
    assert [step.angle_deg for step in closures] == [5.0, 5.0, 365.0]
    assert [step.step for step in closures] == [12, 25, 34]
    assert [step.repeat for step in closures] == [0, 1, 0]
    assert {step.exposure_ev for step in closures} == {1.0}, "they are held against the first frame"


def test_every_slice_is_shot_under_every_light_forwards_and_backwards_in_turn() -> None:
    plan = Plan(ProductPoses(Turn(3, range_deg=90, closure=True), LIGHTS))
    frames = [step for step in plan if step.role is Role.FRAME]
    assert [step.angle_deg for step in frames] == [0.0] * 6 + [45.0] * 6 + [90.0] * 6
    aims = [step.aim for step in frames]
    there, back, again = aims[:6], aims[6:12], aims[12:]
    assert there == again == back[::-1] == list(LIGHTS.aims)
    assert list(plan)[-1] == Step(18, Role.CLOSURE, 0.0, LIGHTS.aims[0])


def test_each_exposure_of_a_bracket_is_a_step_and_so_is_each_frame_of_an_average() -> None:
    plan = Plan(AmcPoses(Turn(8)), Exposures((-2.0, 0.0, 2.0), 2))
    first = list(plan)[:6]
    assert [(step.exposure_ev, step.repeat) for step in first] == [(-2, 0), (-2, 1), (0, 0), (0, 1), (2, 0), (2, 1)]
    assert {step.angle_deg for step in first} == {0.0}
    assert first[5].stem == "000005_tt000.00_ev+2.0_n02"


def test_references_stand_around_the_frames_in_an_order_that_changes_little() -> None:
    roles = (Role.WHITE, Role.DARK, Role.BALL, Role.CHART)
    plan = Plan(PtmPoses(LIGHTS), references=tuple(Reference(role, when="both") for role in roles))
    order = [role for role, _ in itertools.groupby(step.role for step in plan)]
    around = [Role.DARK, Role.WHITE, Role.CHART, Role.BALL]
    assert order == [*around, Role.FRAME, *reversed(around)]
    tasks = [(step.role, step.ask) for step in plan if step.ask]
    card, ball, chart = (
        f"Put the {what} in place of the sample" for what in ("white card", "mirror ball", "colour chart")
    )
    assert tasks == [
        (Role.WHITE, card),
        (Role.CHART, chart),
        (Role.BALL, ball),
        (Role.FRAME, SAMPLE_BACK),
        (Role.BALL, ball),
        (Role.CHART, chart),
        (Role.WHITE, card),
    ]


def test_references_are_shot_under_every_light_the_highest_or_none() -> None:
    references = (
        Reference(Role.WHITE, 2),
        Reference(Role.BALL, under="one-light"),
        Reference(Role.CHART),
        Reference(Role.DARK),
    )
    plan = Plan(ProductPoses(Turn(2, start_deg=30), LIGHTS), references=references)
    aims = {role: [step.aim for step in plan if step.role is role] for role in Role}
    assert aims[Role.WHITE] == [aim for aim in LIGHTS.aims for _ in range(2)]
    assert aims[Role.BALL] == aims[Role.CHART] == [LIGHTS.aims[5]]
    assert aims[Role.DARK] == [None]
    assert set(angles(plan, Role.WHITE)) == {30.0}


def test_references_have_the_frames_bracket_only_if_that_is_asked_for() -> None:
    references = (Reference(Role.WHITE), Reference(Role.DARK, bracket=True, when="end"))
    plan = Plan(AmcPoses(Turn(8)), Exposures((-3.0, 1.0)), references)
    exposures = {role: [step.exposure_ev for step in plan if step.role is role] for role in Role}
    assert exposures[Role.WHITE] == [1.0]
    assert exposures[Role.DARK] == [-3.0, 1.0]


def test_a_person_who_covers_the_lens_is_asked_to_uncover_it_once() -> None:
    cover, uncover = COVER_LENS
    dark = Reference(Role.DARK, 3, ask=cover, ask_after=uncover)
    plan = Plan(AmcPoses(Turn(8)), references=(dark, Reference(Role.WHITE)))
    tasks = [(step.step, step.ask) for step in plan if step.ask]
    assert tasks == [(0, cover), (3, f"{uncover}. Put the white card in place of the sample"), (4, SAMPLE_BACK)]


def test_a_ball_that_stays_beside_the_sample_needs_nobody() -> None:
    plan = Plan(PtmPoses(LIGHTS), references=(Reference(Role.BALL, ask=""),))
    assert not any(step.ask for step in plan)


def test_file_names_tell_the_pose() -> None:
    assert [step.stem for step in amc_plan(8)][1] == "000001_tt045.00"
    assert next(iter(ptm_plan(6))).stem.startswith("000000_az000.00_el")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: amc_plan(7), r"slices: 7 is outside 8\.\.100000; 64 to 512 are usual"),
        (lambda: amc_plan(10**9), r"slices: 1000000000 is outside"),
        (lambda: ptm_plan(5), r"lights: 5 is outside 6\.\.2000"),
        (lambda: Turn(8, range_deg=361), r"range_deg: 361 is outside 0\.\.360; for more turns raise repeats"),
        (lambda: Turn(8, range_deg=0), r"range_deg: 0 turns nothing"),
        (lambda: Turn(8, start_deg=float("nan")), r"start_deg: nan is outside"),
        (lambda: Turn(8, repeats=0), r"repeats: 0 is outside"),
        (lambda: Exposures(()), r"bracket_ev: 0 is outside"),
        (lambda: Exposures((0.0, float("inf"))), r"bracket_ev: inf is outside"),
        (lambda: Exposures((1.0, 1.0)), r"bracket_ev: has an exposure twice"),
        (lambda: Exposures(average=0), r"average: 0 is outside"),
        (lambda: Reference(Role.FRAME), r"a reference is white, dark, ball or chart, not frame"),
        (lambda: Reference(Role.WHITE, 0), r"white\.frames: 0 is outside"),
        (lambda: Plan(AmcPoses(Turn(8)), references=(Reference(Role.DARK),) * 2), r"a role stands there twice"),
        (lambda: Plan(AmcPoses(Turn(8)), revisit_every=0), r"revisit_every: 0 is outside"),
        (lambda: Plan(AmcPoses(Turn(1000, repeats=101))), r"101,000 steps, more than 100,000; lower slices"),
    ],
)
def test_plans_that_make_nothing_are_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("slices", "size", "few"), [(255, 128, "fewer"), (256, 128, ""), (512, 128, ""), (520, 128, "more")]
)
def test_slices_are_held_against_the_size_of_the_table(slices: int, size: int, few: str) -> None:
    advice = Turn(slices, table_size=size).advice()
    assert (few in advice and "256 to 512" in advice) if few else advice == ""


def test_slices_of_a_part_of_a_turn_count_as_those_of_a_whole_one() -> None:
    assert Turn(128, range_deg=180).advice() == ""
