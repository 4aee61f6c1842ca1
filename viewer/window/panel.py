"""The panel beside the picture: what can be chosen, and what the keys do."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui

from viewer.view import Projection
from viewer.window.keys import HELP, LIGHT_HELP
from viewer.window.light_disc import light_disc
from viewer.window.saving import ENDINGS, Saving
from viewer.window.state import Hand

WIDTH_EM = 17.0
_DIM = ImVec4(0.6, 0.62, 0.65, 1.0)
_LARGEST_PX = 8192


@dataclass(frozen=True)
class Wishes:
    """What was asked for in the panel.

    Attributes
    ----------
    save : ending of a snapshot to be saved; None saves none
    copy : put the command that makes the picture on the clipboard
    """

    hand: Hand
    saving: Saving
    save: str | None = None
    copy: bool = False


def panel(hand: Hand, saving: Saving, picture: tuple[int, int], said: str) -> Wishes:
    """Show the panel, and return what was asked for.

    Parameters
    ----------
    picture : width and height of the picture on the screen, in pixels
    said : the last thing that is to be told
    """
    hand = _mesh(hand)
    if hand.shown.mesh is not None:
        hand = _projection(hand)
    hand = _light(hand)
    _heading("View")
    if imgui.button("Reset", ImVec2(-1, 0)):
        hand = hand.reset()
    _facts(hand)
    wishes = _snapshot(hand, saving, picture)
    if said:
        imgui.push_style_color(imgui.Col_.text, _DIM)
        imgui.text_wrapped(said)
        imgui.pop_style_color()
    _help(hand)
    return wishes


def _heading(text: str) -> None:
    imgui.spacing()
    imgui.separator_text(text)


def _mesh(hand: Hand) -> Hand:
    _heading("Mesh")
    imgui.set_next_item_width(-1)
    if imgui.begin_combo("##mesh", _mesh_name(hand.shown.mesh)):
        for mesh in hand.meshes:
            chosen, _ = imgui.selectable(_mesh_name(mesh), mesh == hand.shown.mesh)
            if chosen:
                hand = hand.on_mesh(mesh)
        if imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_combo()
    return hand


def _mesh_name(mesh: str | None) -> str:
    return "flat" if mesh is None else Path(mesh).name


def _projection(hand: Hand) -> Hand:
    for projection in reversed(Projection):
        if projection is not Projection.PERSPECTIVE:
            imgui.same_line()
        if imgui.radio_button(projection.value, hand.shown.projection is projection):
            hand = hand.in_projection(projection)
    return hand


def _light(hand: Hand) -> Hand:
    light = hand.shown.light
    if light is None:
        return hand
    _heading("Light")
    side = hello_imgui.em_size(9.0)
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + (imgui.get_content_region_avail().x - side) / 2)
    moved = light_disc(light, side)
    imgui.text_disabled(f"u {light[0]:+.3f}   v {light[1]:+.3f}")
    return hand if moved == light else hand.lit_from(moved)


def _facts(hand: Hand) -> None:
    shown = hand.shown
    if shown.mesh is not None:
        view = shown.view
        imgui.text_disabled(f"yaw {view.yaw_deg:.1f}°  pitch {view.pitch_deg:.1f}°")
        imgui.text_disabled(f"roll {view.roll_deg:.1f}°  zoom {view.zoom:.2f}")
    else:
        imgui.text_disabled(f"zoom {shown.zoom:.2f}")


def _snapshot(hand: Hand, saving: Saving, picture: tuple[int, int]) -> Wishes:
    _heading("Snapshot")
    if hand.shown.mesh is None:
        imgui.text_disabled("at the picture's own size")
    else:
        saving = _size(saving, picture)
    save = None
    width = (imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x) / len(ENDINGS)
    for ending in ENDINGS:
        if ending != ENDINGS[0]:
            imgui.same_line()
        if imgui.button(ending[1:].upper(), ImVec2(width, 0)):
            save = ending
    copy = imgui.button("Copy the command", ImVec2(-1, 0))
    return Wishes(hand, saving, save, copy)


def _size(saving: Saving, picture: tuple[int, int]) -> Saving:
    changed, as_shown = imgui.checkbox("as large as here", saving.size is None)
    if changed:
        saving = dataclasses.replace(saving, size=None if as_shown else picture)
    if saving.size is not None:
        imgui.set_next_item_width(-1)
        changed, sides = imgui.input_int2("##size", list(saving.size))
        if changed:
            width, height = (min(max(side, 1), _LARGEST_PX) for side in sides)
            saving = dataclasses.replace(saving, size=(width, height))
    return saving


def _help(hand: Hand) -> None:
    _heading("Keys")
    if imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
        for key, what in HELP:
            if key == LIGHT_HELP and hand.shown.light is None:
                continue
            imgui.table_next_row()
            imgui.table_next_column()
            imgui.text(key)
            imgui.table_next_column()
            imgui.text_colored(_DIM, what)
        imgui.end_table()
