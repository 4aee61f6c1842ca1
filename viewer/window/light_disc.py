"""A disc that stands for the hemisphere of lights, seen from the camera; the light is dragged on it."""

import math

from imgui_bundle import ImVec2, imgui

from viewer.window.state import Light

_RING_ELEVATIONS_DEG = (30, 60)


def light_disc(light: Light, side: float) -> Light:
    """Show where the light is, and return where it was dragged; that may be beyond the disc."""
    corner = imgui.get_cursor_screen_pos()
    radius = side / 2 - 4
    middle = ImVec2(corner.x + side / 2, corner.y + side / 2)
    imgui.invisible_button("light", ImVec2(side, side))
    if imgui.is_item_active():
        mouse = imgui.get_io().mouse_pos
        light = ((mouse.x - middle.x) / radius, (middle.y - mouse.y) / radius)
    _draw(light, middle, radius, bright=imgui.is_item_hovered() or imgui.is_item_active())
    return light


def _draw(light: Light, middle: ImVec2, radius: float, *, bright: bool) -> None:
    lines, rim, ground = (imgui.get_color_u32((*(grey,) * 3, 1.0)) for grey in (0.27, 0.55 if bright else 0.4, 0.11))
    paper = imgui.get_window_draw_list()
    paper.add_circle_filled(middle, radius, ground, 64)
    for elevation_deg in _RING_ELEVATIONS_DEG:
        paper.add_circle(middle, radius * math.cos(math.radians(elevation_deg)), lines, 64)
    paper.add_line(ImVec2(middle.x - radius, middle.y), ImVec2(middle.x + radius, middle.y), lines)
    paper.add_line(ImVec2(middle.x, middle.y - radius), ImVec2(middle.x, middle.y + radius), lines)
    paper.add_circle(middle, radius, rim, 64, 1.5)
    place = ImVec2(middle.x + light[0] * radius, middle.y - light[1] * radius)
    paper.add_circle_filled(place, radius * 0.13, imgui.get_color_u32((1.0, 0.85, 0.45, 0.25)))
    paper.add_circle_filled(place, radius * 0.075, imgui.get_color_u32((1.0, 0.87, 0.55, 1.0)))
