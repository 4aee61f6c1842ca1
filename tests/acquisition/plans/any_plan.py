"""Plans of every kind, with every option, for hypothesis."""

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from acquisition.plans import Plan
from acquisition.plans.light_path import LightPath, Sector, evenly
from acquisition.plans.poses import AmcPoses, PoseSequence, ProductPoses, PtmPoses
from acquisition.plans.shooting import Exposures, Reference
from acquisition.plans.turn import Turn
from litrig.base.capture_folder.capture import Role


def turns(fewest: int, most: int) -> SearchStrategy[Turn]:
    return st.builds(
        Turn,
        slices=st.integers(fewest, most),
        start_deg=st.floats(-360, 360),
        range_deg=st.floats(1, 360) | st.just(360.0),
        repeats=st.integers(1, 3),
        closure=st.booleans(),
    )


def light_paths(fewest: int, most: int) -> SearchStrategy[LightPath]:
    sectors = st.builds(
        Sector, st.floats(-10, 30), st.floats(40, 90), st.tuples(st.floats(-90, 90), st.floats(100, 250))
    )
    return st.builds(
        lambda lights, sector: LightPath(tuple(evenly(lights, sector))), st.integers(fewest, most), sectors
    )


def references() -> SearchStrategy[tuple[Reference, ...]]:
    one = st.builds(
        Reference,
        role=st.sampled_from([Role.WHITE, Role.DARK, Role.BALL, Role.CHART]),
        frames=st.integers(1, 3),
        when=st.sampled_from(["start", "end", "both"]),
        under=st.sampled_from(["every-light", "one-light"]),
        bracket=st.booleans(),
        ask=st.sampled_from([None, "", "Cover the lens"]),
    )
    return st.lists(one, max_size=4, unique_by=lambda reference: reference.role).map(tuple)


def poses() -> SearchStrategy[PoseSequence]:
    return (
        st.builds(AmcPoses, turns(8, 40))
        | st.builds(PtmPoses, light_paths(6, 20))
        | st.builds(ProductPoses, turns(1, 5), light_paths(1, 6))
    )


def any_plan() -> SearchStrategy[Plan]:
    exposures = st.builds(
        Exposures,
        bracket_ev=st.lists(st.integers(-8, 8).map(lambda n: n / 2), min_size=1, max_size=4, unique=True).map(tuple),
        average=st.integers(1, 3),
    )
    return st.builds(Plan, poses(), exposures, references(), st.none() | st.integers(1, 30))
