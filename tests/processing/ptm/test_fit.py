from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from litrig.base.progress import Progress
from litrig.base.radiometry import encode_srgb
from processing.ptm.basis import PTM, Basis
from processing.ptm.colour_split import split_colour
from processing.ptm.fit import fit
from processing.ptm.model import Colour, Space
from processing.ptm.quality import fit_quality
from processing.ptm.relighting.relight import relight
from processing.stack import Stack
from tests.base.test_pictures import write_dng
from tests.processing.ptm.relief import dome, relief_pictures, write_relief

LIGHTS = dome(24)


@pytest.fixture(scope="module")
def relief(tmp_path_factory: pytest.TempPathFactory) -> Stack:
    return Stack(write_relief(tmp_path_factory.mktemp("relief"), LIGHTS))


def write_polynomial(folder: Path, coefficients: NDArray[np.float64], colour: NDArray[np.float64]) -> Stack:
    """16-bit pictures of (6, H, W) polynomials times a colour (3,)."""
    paths = []
    for index, (u, v, _) in enumerate(LIGHTS):
        values = np.tensordot([u * u, v * v, u * v, u, v, 1], coefficients, axes=1)[..., None] * colour
        assert 0 <= values.min() <= values.max() <= 1
        paths.append(folder / f"{index:03d}.png")
        cv2.imwrite(str(paths[-1]), np.rint(values[..., ::-1] * 65535).astype(np.uint16))
    return Stack(paths)


def polynomials() -> NDArray[np.float64]:
    y, x = np.mgrid[:5, :7] / 7
    return np.stack([-0.1 + 0 * x, -0.1 * x, 0.05 * y, 0.1 * x, -0.1 * y, 0.5 + 0.1 * x])


@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
def test_pictures_of_a_polynomial_give_it_back(colour: Colour, tmp_path: Path) -> None:
    truth, tint = polynomials(), np.array([1.0, 0.7, 0.3])
    ptm = fit(write_polynomial(tmp_path, truth, tint), LIGHTS, colour=colour)
    product = ptm.coefficients if ptm.colour is None else ptm.coefficients * ptm.colour
    assert product == pytest.approx(truth[..., None] * tint, abs=1e-4)
    assert ptm.coefficients.shape == (6, 5, 7, 3 if colour == "rgb" else 1)
    assert ptm.coefficients.dtype == np.float32


def test_the_fit_is_the_least_squares_of_every_pixel(relief: Stack) -> None:
    pictures = np.rint(relief_pictures(LIGHTS) * 255) / 255
    u, v, _ = LIGHTS.T
    design = np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=1)
    expected = np.linalg.lstsq(design, pictures.reshape(len(LIGHTS), -1), rcond=None)[0]
    assert fit(relief, LIGHTS, colour="rgb").coefficients.reshape(6, -1) == pytest.approx(expected, abs=1e-4)


def test_luminance_times_colour_comes_near_to_three_polynomials(relief: Stack) -> None:
    rgb, lrgb = (fit_quality(fit(relief, LIGHTS, colour=colour), relief, LIGHTS).psnr_db for colour in ("rgb", "lrgb"))
    assert rgb - 1 < lrgb <= rgb + 1e-3


def test_the_split_is_the_best_of_rank_one() -> None:
    """Against the singular values of the weighted coefficients: what rank one must leave."""
    random = np.random.default_rng(4)
    tint = random.uniform(0.2, 1, (9, 3))
    columns = random.standard_normal((9, 6))[..., None] * tint[:, None] + 0.1 * random.standard_normal((9, 6, 3))
    root = np.linalg.qr(random.standard_normal((30, 6)))[1]
    luminance, colour = split_colour(np.moveaxis(columns, 1, 0).astype(np.float32), root.T @ root)
    product = np.moveaxis(luminance * colour, 0, 1)
    left = np.linalg.norm(root @ (columns - product), axis=(1, 2))
    least = np.sqrt((np.linalg.svd(root @ columns, compute_uv=False)[:, 1:] ** 2).sum(axis=1))
    assert left == pytest.approx(least, rel=0.02)


def test_a_pixel_that_is_always_black_is_neutral_and_finite(relief: Stack) -> None:
    ptm = fit(relief, LIGHTS)
    assert ptm.colour is not None
    assert np.isfinite(ptm.coefficients).all()
    assert np.isfinite(ptm.colour).all()
    assert ptm.colour[0, 0] == pytest.approx([1, 1, 1])
    assert ptm.coefficients[:, 0, 0] == pytest.approx(0)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_the_space_decides_what_is_fitted(space: Space, relief: Stack) -> None:
    ptm = fit(relief, LIGHTS, colour="rgb", space=space, source="digest")
    mean = np.mean([relief.frame(index, space) for index in range(len(relief))], axis=0)
    fitted = np.mean([relight(ptm, light) for light in LIGHTS], axis=0)
    assert fitted == pytest.approx(mean, abs=1e-4)
    assert (ptm.space, ptm.source) == (space, "digest")


def test_raising_the_light_to_the_right_brightens_what_faces_right(relief: Stack) -> None:
    """The hill's right flank is brighter under a light from the right, its upper flank under one from above."""
    ptm = fit(relief, LIGHTS)
    right, left, up, down = (relight(ptm, np.array(light)) for light in [(0.7, 0), (-0.7, 0), (0, 0.7), (0, -0.7)])
    assert right[19, 23].mean() > left[19, 23].mean() + 0.1
    assert up[13, 17].mean() > down[13, 17].mean() + 0.1


def test_quality_names_the_frames_that_fit_worst(relief: Stack) -> None:
    quality = fit_quality(fit(relief, LIGHTS), relief, LIGHTS)
    worst = quality.worst(3)
    assert quality.per_light_db[worst[0]] == quality.per_light_db.min()
    assert quality.per_light_db.min() <= quality.psnr_db <= quality.per_light_db.max()
    squared = np.mean(10 ** (-quality.per_light_db / 10))
    assert quality.psnr_db == pytest.approx(-10 * np.log10(squared))


def test_quality_is_the_distance_to_the_pictures(relief: Stack) -> None:
    ptm = fit(relief, LIGHTS, colour="rgb")
    shown = np.clip(relight(ptm, LIGHTS[5]), 0, 1)
    expected = -10 * np.log10(np.mean((shown - relief.encoded(5)) ** 2))
    assert fit_quality(ptm, relief, LIGHTS).per_light_db[5] == pytest.approx(expected, abs=1e-3)


def test_every_frame_and_then_every_strip_is_reported(relief: Stack) -> None:
    steps: list[Progress] = []
    fit(relief, LIGHTS, report=steps.append)
    assert [step.done for step in steps if step.job == "reading"] == list(range(1, len(LIGHTS) + 1))
    assert [step.done for step in steps if step.job == "fitting"] == [relief.shape[0]]


def test_lights_and_pictures_must_be_as_many(relief: Stack) -> None:
    with pytest.raises(InputError, match="24 pictures but 23 lights"):
        fit(relief, LIGHTS[:-1])


@pytest.mark.parametrize("z", [0.0, -0.3])
def test_a_light_that_is_not_above_the_horizon_is_named(relief: Stack, z: float) -> None:
    lights = LIGHTS.copy()
    lights[3, 2] = z
    with pytest.raises(InputError, match=f"{relief.paths[3].name}: its light is not above the horizon .z = {z:g}"):
        fit(relief, lights)


def test_residuals_are_the_error_of_each_pixel(relief: Stack) -> None:
    quality = fit_quality(fit(relief, LIGHTS), relief, LIGHTS)
    assert quality.residuals.shape == relief.shape
    assert -20 * np.log10(np.sqrt(np.mean(quality.residuals**2))) == pytest.approx(quality.psnr_db, abs=1e-3)


@pytest.mark.parametrize("ending", ["png", "exr", "dng"])
def test_pictures_of_every_kind_give_the_same_light(ending: str, tmp_path: Path) -> None:
    """A grey board in 16 bits, floats and camera RAW, brighter under each light that is higher up."""
    paths = [tmp_path / f"{index:02d}.{ending}" for index in range(len(LIGHTS))]
    for path, (_, _, z) in zip(paths, LIGHTS, strict=True):
        light = np.full((64, 64, 3), 0.5 * z, np.float32)
        if ending == "png":
            cv2.imwrite(str(path), np.rint(encode_srgb(light) * 65535).astype(np.uint16))
        elif ending == "exr":
            write_picture(path, light)
        else:
            write_dng(path, np.rint(512 + light[..., 0] * (65535 - 512)).astype(np.uint16))
    ptm = fit(Stack(paths), LIGHTS, basis=Basis("hsh", 4), colour="rgb", space="linear")
    lit = relight(ptm, np.array([0.3, 0.4, np.sqrt(0.75)]))[20:40, 20:40]
    assert lit == pytest.approx(0.5 * np.sqrt(0.75), rel=0.02)


@pytest.mark.parametrize("basis", [PTM, Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9), Basis("hsh", 16)], ids=str)
def test_more_terms_fit_better_and_each_is_the_least_squares(basis: Basis, relief: Stack) -> None:
    ptm = fit(relief, LIGHTS, basis=basis, colour="rgb")
    pictures = (np.rint(relief_pictures(LIGHTS) * 255) / 255).reshape(len(LIGHTS), -1)
    expected = np.linalg.lstsq(basis.evaluate(LIGHTS), pictures, rcond=None)[0]
    assert ptm.basis == basis
    assert ptm.coefficients.reshape(basis.terms, -1) == pytest.approx(expected, abs=2e-3)
    quality = fit_quality(ptm, relief, LIGHTS).psnr_db
    least = {3: 15, 4: 20, 6: 21, 9: 23, 16: 27}[basis.terms]
    assert quality > least


def test_lights_that_differ_in_elevation_alone_need_a_basis_that_they_can_carry(relief: Stack) -> None:
    """An arc through the zenith tells nothing about the direction across."""
    arc = np.array([[np.sin(a), 0.0, np.cos(a)] for a in np.linspace(-1.2, 1.2, len(LIGHTS))])
    with pytest.raises(InputError, match="in one line"):
        fit(relief, arc)
    held = fit(relief, arc, ridge=0.01)
    assert np.isfinite(held.coefficients).all()
