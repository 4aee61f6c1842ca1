"""The picture in the window, and the mouse on it."""

from imgui_bundle import ImVec2, imgui

from viewer.window.display import DisplayTarget
from viewer.window.state import Button, Hand
from viewer.window.turn import spot_at

Size = tuple[int, int]

_BUTTONS = {imgui.MouseButton_.left: Button.OBJECT, imgui.MouseButton_.right: Button.LIGHT}


def picture_area(display: DisplayTarget | None, size: tuple[float, float]) -> None:
    """Show a picture, pixel by pixel, from the cursor on."""
    if display is not None:
        # The first row of a texture is the lowest.
        texture = imgui.ImTextureRef(display.colour.glo)
        imgui.image(texture, ImVec2(*size), uv0=ImVec2(0, 1), uv1=ImVec2(1, 0))


def mouse_on_picture(hand: Hand, size: tuple[float, float]) -> Hand:
    """Let the hand answer to the mouse over a picture of that size, from the cursor on."""
    corner, mouse = imgui.get_cursor_screen_pos(), imgui.get_io().mouse_pos
    spot = spot_at((mouse.x - corner.x, mouse.y - corner.y), size)
    either = imgui.ButtonFlags_.mouse_button_left | imgui.ButtonFlags_.mouse_button_right
    imgui.invisible_button("picture", ImVec2(*size), either)
    if imgui.is_item_activated():
        for button, purpose in _BUTTONS.items():
            if imgui.is_mouse_clicked(button):
                hand = hand.pressed(purpose, spot)
    elif hand.grip is not None:
        hand = hand.dragged(spot) if imgui.is_item_active() else hand.released()
    wheel = imgui.get_io().mouse_wheel
    if wheel and imgui.is_item_hovered():
        hand = hand.scrolled(wheel, spot)
    return hand
