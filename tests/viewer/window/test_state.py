"""How what is shown answers to hand and key, without a window."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewer.view import Projection
from viewer.window.keys import CLOSE_KEYS, KEYS, SAVE_KEYS
from viewer.window.state import LOWEST_LIGHT, ZOOM_A_NOTCH, ZOOM_LIMITS, Button, Hand, ball_radius, start
from viewer.window.turn import Spot, arc, matrix, then

MESHES = (None, "torus", "sphere")
spots = st.tuples(st.floats(-2, 2), st.floats(-2, 2))


def lit(mesh: str | None = "torus") -> Hand:
    return start(mesh, MESHES, (-0.4, 0.4))


def unlit() -> Hand:
    return start("torus", MESHES[1:], None)


def apart(first: Hand, second: Hand) -> float:
    """How far two turns are from each other, as matrices."""
    return float(np.abs(matrix(first.shown.turn) - matrix(second.shown.turn)).max())


@given(begin=spots, way=st.lists(spots, max_size=4), end=spots)
def test_a_drag_depends_on_its_ends_alone(begin: Spot, way: list[Spot], end: Spot) -> None:
    held = lit().pressed(Button.OBJECT, begin)
    wandering = held
    for spot in way:
        wandering = wandering.dragged(spot)
    assert wandering.dragged(end) == held.dragged(end)
    assert apart(wandering.dragged(begin), lit()) < 1e-9
    turned = then(lit().shown.turn, arc(begin, end, ball_radius(1.0)))
    assert held.dragged(end).shown.turn == turned


def test_what_is_not_held_does_not_move() -> None:
    assert lit().dragged((0.3, 0.3)) == lit()
    assert lit().pressed(Button.OBJECT, (0, 0)).released().dragged((0.3, 0.3)) == lit()


def test_turning_leaves_the_light_and_lighting_leaves_the_turn() -> None:
    turned = lit().pressed(Button.OBJECT, (0, 0)).dragged((0.4, 0.1)).shown
    assert turned.light == lit().shown.light and turned.turn != lit().shown.turn
    relit = lit().pressed(Button.LIGHT, (0.2, 0.1)).dragged((0.5, -0.25)).shown
    assert relit == dataclasses.replace(lit().shown, light=(0.5, -0.25))


def test_light_that_was_captured_cannot_be_moved() -> None:
    assert unlit().pressed(Button.LIGHT, (0.2, 0.2)).dragged((0.5, 0.5)) == unlit()
    assert unlit().lit_from((0.5, 0.5)) == unlit()


@given(spot=st.tuples(st.floats(-50, 50), st.floats(-50, 50)))
def test_the_light_never_leaves_its_hemisphere(spot: Spot) -> None:
    light = lit().lit_from(spot).shown.light
    assert light is not None
    assert math.hypot(*light) <= 1
    if math.hypot(*spot) > 1:
        assert math.hypot(*light) == pytest.approx(LOWEST_LIGHT, abs=1e-4)
        np.testing.assert_allclose(np.array(light) / LOWEST_LIGHT, np.array(spot) / math.hypot(*spot), atol=1e-3)


@given(notches=st.floats(-3, 3), spot=spots, pan=spots)
def test_zooming_a_flat_picture_keeps_what_is_under_the_mouse(notches: float, spot: Spot, pan: Spot) -> None:
    before = lit(None).pressed(Button.OBJECT, (0, 0)).dragged(pan).released()
    after = before.scrolled(notches, spot)
    grown = ZOOM_A_NOTCH**notches
    assert after.shown.zoom == pytest.approx(grown)
    for axis in (0, 1):
        was = (spot[axis] - before.shown.pan[axis]) / before.shown.zoom
        assert (spot[axis] - after.shown.pan[axis]) / after.shown.zoom == pytest.approx(was, abs=1e-9)


def test_zoom_ends_somewhere_and_the_view_can_be_made() -> None:
    for notches, limit in ((1000, ZOOM_LIMITS[1]), (-1000, ZOOM_LIMITS[0])):
        assert lit().scrolled(notches, (0, 0)).shown.view.zoom == limit


def test_what_is_done_during_a_drag_is_not_undone_by_it() -> None:
    held = lit().pressed(Button.OBJECT, (0, 0)).dragged((0.1, 0))
    for done in (
        held.in_other_projection(),
        held.scrolled(2, (0, 0)),
        held.on_mesh("sphere"),
        held.lit_from((0.1, 0.1)),
    ):
        shown = done.dragged((0.3, 0)).shown
        assert dataclasses.replace(shown, turn=done.shown.turn) == done.shown


def test_a_mesh_keeps_the_turn_and_flat_starts_anew() -> None:
    turned = lit().turned_by(1, 2).scrolled(3, (0, 0))
    assert turned.on_mesh("sphere").shown == dataclasses.replace(turned.shown, mesh="sphere")
    assert turned.on_mesh(None).shown.zoom == 1


def test_the_next_mesh_goes_round() -> None:
    hand, seen = lit(None), []
    for _ in range(4):
        seen.append(hand.shown.mesh)
        hand = hand.on_next_mesh()
    assert seen == [None, "torus", "sphere", None]


def test_a_mesh_from_a_file_can_be_chosen_again() -> None:
    hand = start("cup.obj", MESHES, None)
    assert hand.on_mesh("torus").on_mesh("cup.obj").shown == hand.shown
    assert set(hand.meshes) == {*MESHES, "cup.obj"}


def test_reset_goes_home_on_the_mesh_that_is_shown() -> None:
    away = lit().on_mesh("sphere").turned_by(2, 1).scrolled(2, (0, 0)).lit_from((0, 0)).in_other_projection()
    assert away.reset().shown == dataclasses.replace(lit().shown, mesh="sphere")


def test_arrows_bring_the_front_where_they_point() -> None:
    for step, axis, sign in (((1, 0), 0, 1), ((-1, 0), 0, -1), ((0, 1), 1, 1), ((0, -1), 1, -1)):
        before, after = (matrix(hand.shown.turn) for hand in (lit(), lit().turned_by(*step)))
        front = before.T @ [0, 0, 1]
        assert np.sign((after @ front)[axis]) == sign
    assert lit(None).turned_by(1, 1) == lit(None)


def test_projections_take_turns() -> None:
    once = lit().in_other_projection()
    assert once.shown.projection is Projection.ORTHOGRAPHIC
    assert once.in_other_projection() == lit()


def test_every_key_does_one_thing_and_something() -> None:
    names = [key.name for key in KEYS] + [*SAVE_KEYS, *CLOSE_KEYS]
    assert len(set(names)) == len(names)
    away = lit().turned_by(1, 1)
    for key in KEYS:
        assert key.answer(away) != away, key.name


@given(begin=spots, end=spots, notches=st.floats(-3, 3))
def test_the_view_is_made_of_numbers_that_can_be_typed(begin: Spot, end: Spot, notches: float) -> None:
    hand = lit().pressed(Button.OBJECT, begin).dragged(end).released().scrolled(notches, (0, 0))
    view = hand.shown.view
    for number in (view.yaw_deg, view.pitch_deg, view.roll_deg, view.zoom):
        assert float(str(number)) == number
        assert len(str(number)) <= 9
    np.testing.assert_allclose(view.camera((9, 9)).view_from_object, matrix(hand.shown.turn), atol=5e-5)
