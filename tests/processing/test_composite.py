"""Brackets, averages, dark frames and the white card, on light that is known."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.capture_folder.capture import Capture, CapturedFrame, Exposure, Role
from litrig.base.errors import FormatError
from litrig.base.pictures import read_linear, write_codes, write_exr
from litrig.base.radiometry import encode_srgb, to_u8
from processing.composite import Composite, pictures_of
from processing.stack import Stack

F32 = NDArray[np.float32]
SHAPE = (60, 80, 3)
LIGHT = np.array([0.0, 0.6, 0.8])


def ramp(brightest: float) -> F32:
    return np.broadcast_to(np.linspace(0.002, brightest, SHAPE[1], dtype=np.float32)[None, :, None], SHAPE).copy()


def jpeg_like(path: Path, linear: F32) -> Path:
    write_codes(path, to_u8(encode_srgb(linear)))
    return path


def exr(path: Path, linear: F32) -> Path:
    write_exr(path, {"RGB": np.ascontiguousarray(linear, np.float32)}, {"litrig.kind": "picture"})
    return path


def only(capture: Capture) -> F32:
    stack = Stack.of(capture)
    assert len(stack) == 1
    return stack.linear(0)


def test_a_bracket_tells_more_light_and_more_shadow_than_one_exposure(tmp_path: Path) -> None:
    truth = ramp(3.0)
    exposures = tuple(
        Exposure(jpeg_like(tmp_path / f"{ev:+d}.png", truth * np.float32(2.0**ev)), float(ev)) for ev in (-2, 0, 3)
    )
    frame = CapturedFrame(exposures[1].path, exposures=exposures)
    merged = only(Capture(tmp_path, "x", (frame,)))
    one = read_linear(exposures[1].path)
    assert np.all(np.abs(merged / truth - 1)[:, 2:] < 0.02), "within the grain of eight bits, all over"
    assert np.abs(one / truth - 1)[:, -10:].min() > 0.5, "alone it is clipped"
    assert np.abs(merged / truth - 1)[:, 1].max() < np.abs(one / truth - 1)[:, 1].max(), "and coarser in the shadow"


def test_an_average_is_less_noisy_and_not_biased(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    truth = np.full(SHAPE, 0.3, np.float32)
    frames = [truth + random.normal(0, 0.03, SHAPE).astype(np.float32) for _ in range(16)]
    exposures = tuple(Exposure(exr(tmp_path / f"{n}.exr", frame)) for n, frame in enumerate(frames))
    merged = only(Capture(tmp_path, "x", (CapturedFrame(exposures[0].path, exposures=exposures),)))
    assert merged.std() == pytest.approx(0.03 / 4, rel=0.1)
    assert merged.mean() == pytest.approx(0.3, abs=1e-3)


def test_dark_frames_come_off_by_their_exposure(tmp_path: Path) -> None:
    truth, ambient = ramp(0.5), np.float32(0.08)
    frame = CapturedFrame(exr(tmp_path / "a.exr", truth + ambient))
    dark = exr(tmp_path / "dark.exr", np.full(SHAPE, ambient))
    longer = exr(tmp_path / "dark2.exr", np.full(SHAPE, 4 * ambient))
    same = Capture(tmp_path, "x", (frame, CapturedFrame(dark, Role.DARK)))
    other = Capture(tmp_path, "x", (frame, CapturedFrame(longer, Role.DARK, exposures=(Exposure(longer, 2.0),))))
    for capture in (same, other):
        np.testing.assert_allclose(only(capture), truth, atol=1e-6)


def test_a_white_card_evens_out_the_lamps_and_their_colour(tmp_path: Path) -> None:
    truth = np.full(SHAPE, 0.4, np.float32)
    slope = np.linspace(0.6, 1.0, SHAPE[1], dtype=np.float32)[None, :, None]
    lamp = slope * np.array([1.0, 0.8, 0.5], np.float32)
    frame = CapturedFrame(exr(tmp_path / "a.exr", truth * lamp), light=LIGHT)
    card = CapturedFrame(exr(tmp_path / "w.exr", np.float32(0.9) * lamp * np.ones(SHAPE, np.float32)), Role.WHITE)
    evened = only(Capture(tmp_path, "x", (frame, card)))
    inner = evened[:, 4:-4]
    assert inner.max() / inner.min() < 1.02
    assert (truth * lamp).max() / (truth * lamp).min() > 3


def test_each_light_has_its_own_white_card(tmp_path: Path) -> None:
    other = np.array([0.6, 0.0, 0.8])
    frames = [
        CapturedFrame(exr(tmp_path / f"{n}.exr", np.full(SHAPE, 0.3 * power, np.float32)), light=light)
        for n, (light, power) in enumerate(((LIGHT, 1.0), (other, 0.5)))
    ]
    cards = [
        CapturedFrame(exr(tmp_path / f"w{n}.exr", np.full(SHAPE, 0.8 * power, np.float32)), Role.WHITE, light=light)
        for n, (light, power) in enumerate(((LIGHT, 1.0), (other, 0.5)))
    ]
    stack = Stack.of(Capture(tmp_path, "x", (*frames, *cards)))
    assert stack.linear(0).mean() == pytest.approx(stack.linear(1).mean(), rel=1e-4)


def test_without_references_files_stay_as_they_are(tmp_path: Path) -> None:
    frames = [CapturedFrame(exr(tmp_path / "a.exr", ramp(0.5)))]
    assert pictures_of(Capture(tmp_path, "x", tuple(frames)), frames) == [tmp_path / "a.exr"]


def test_parts_of_another_size_are_named(tmp_path: Path) -> None:
    small = exr(tmp_path / "small.exr", np.zeros((5, 5, 3), np.float32))
    large = exr(tmp_path / "large.exr", ramp(0.5))
    with pytest.raises(FormatError, match=r"small\.exr: is 5 × 5 pixels"):
        Composite(large, (Exposure(large), Exposure(small, 1.0))).linear()
