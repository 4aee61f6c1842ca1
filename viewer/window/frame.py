"""One frame of the window after the other: hand and stage brought together by imgui."""

import shlex
from pathlib import Path

from click import echo
from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui

from litrig.base.errors import LitrigError
from viewer.window.display import DisplayTarget
from viewer.window.keys import CLOSE_KEYS, KEYS, SAVE_KEYS
from viewer.window.panel import WIDTH_EM, panel
from viewer.window.picture_area import mouse_on_picture, picture_area
from viewer.window.saving import Saving, render_command
from viewer.window.stage import Stage
from viewer.window.state import Hand, Shown

Size = tuple[int, int]

REST_S = 0.15
"""After so long without a change, edges are made smooth."""
_PADDING_EM = 0.8
_GROUND, _PANEL = ImVec4(0.125, 0.129, 0.141, 1.0), ImVec4(0.155, 0.16, 0.17, 1.0)
_FIELD, _TOUCHED, _PRESSED = ImVec4(0.23, 0.24, 0.26, 1.0), ImVec4(0.3, 0.32, 0.35, 1.0), ImVec4(0.36, 0.4, 0.45, 1.0)
_TOUCHABLE = ("frame_bg", "button", "header")


class Frame:
    """What the window keeps from frame to frame."""

    def __init__(self, file: Path, hand: Hand, stage: Stage, saving: Saving) -> None:
        self._file, self._hand, self._stage, self._saving = file, hand, stage, saving
        self._said = ""
        self._size: Size = (1, 1)
        self._seen: Shown | None = None
        self._changed_s = -REST_S

    def show(self) -> bool:
        """Show one frame and answer to what came in; tells if the window is to stay open."""
        whole = imgui.get_content_region_avail()
        width = hello_imgui.em_size(WIDTH_EM)
        area = (max(1.0, float(int(whole.x - width))), max(1.0, float(int(whole.y))))
        corner = imgui.get_cursor_screen_pos()
        stays = self._keys()
        self._hand = mouse_on_picture(self._hand, area)
        imgui.set_cursor_screen_pos(ImVec2(corner.x + area[0], corner.y))
        imgui.push_style_color(imgui.Col_.child_bg, _PANEL)
        padding = hello_imgui.em_size(_PADDING_EM)
        imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(padding, padding / 2))
        if imgui.begin_child("panel", ImVec2(whole.x - area[0], area[1]), imgui.ChildFlags_.always_use_window_padding):
            self._panel()
        imgui.end_child()
        imgui.pop_style_var()
        imgui.pop_style_color()
        imgui.set_cursor_screen_pos(corner)
        picture_area(self._picture(area), area)
        return stays

    def _keys(self) -> bool:
        # Whoever types a number, or chooses from a list, means that.
        if imgui.get_io().want_text_input or imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
            return True
        for key in KEYS:
            if imgui.is_key_pressed(getattr(imgui.Key, key.name), key.repeats):
                self._hand = key.answer(self._hand)
        for name, ending in SAVE_KEYS.items():
            if imgui.is_key_pressed(getattr(imgui.Key, name), False):
                self._save(ending)
        return not any(imgui.is_key_pressed(getattr(imgui.Key, name), False) for name in CLOSE_KEYS)

    def _panel(self) -> None:
        wishes = panel(self._hand, self._saving, self._size, self._said)
        self._hand, self._saving = wishes.hand, wishes.saving
        if wishes.save is not None:
            self._save(wishes.save)
        if wishes.copy:
            output = Path(f"{self._saving.stem}.png")
            imgui.set_clipboard_text(shlex.join(render_command(self._file, self._hand.shown, self._sized, output)))
            self._said = "the command that makes this picture is on the clipboard"

    def _picture(self, area: tuple[float, float]) -> DisplayTarget:
        scale = imgui.get_io().display_framebuffer_scale
        self._size = (max(1, round(area[0] * scale.x)), max(1, round(area[1] * scale.y)))
        now_s = imgui.get_time()
        if self._seen is not None and self._hand.shown != self._seen:
            self._changed_s = now_s
        self._seen = self._hand.shown
        return self._stage.show(self._hand.shown, self._size, moving=now_s - self._changed_s < REST_S)

    @property
    def _sized(self) -> Size:
        return self._saving.size or self._size

    def _save(self, ending: str) -> None:
        """Save a snapshot; what hinders it is said in the window, which stays."""
        path = self._saving.free_name(ending)
        try:
            self._stage.save(self._hand.shown, self._sized, path)
        except (LitrigError, OSError) as error:
            self._said = str(error)
            echo(self._said, err=True)
        else:
            self._said = f"saved {path}"
            echo(self._said)


def dress() -> None:
    """Make imgui dark and plain, and leave the arrow keys to the picture."""
    io = imgui.get_io()
    io.config_flags &= ~imgui.ConfigFlags_.nav_enable_keyboard
    imgui.style_colors_dark()
    style = imgui.get_style()
    style.window_padding = ImVec2(0, 0)
    style.window_border_size = style.child_border_size = style.frame_border_size = 0
    style.frame_rounding = style.grab_rounding = 4
    style.item_spacing = ImVec2(8, 6)
    style.set_color_(imgui.Col_.window_bg, _GROUND)
    style.set_color_(imgui.Col_.popup_bg, _PANEL)
    style.set_color_(imgui.Col_.check_mark, ImVec4(0.95, 0.8, 0.5, 1.0))
    for name in _TOUCHABLE:
        for state, colour in (("", _FIELD), ("_hovered", _TOUCHED), ("_active", _PRESSED)):
            style.set_color_(getattr(imgui.Col_, name + state), colour)
