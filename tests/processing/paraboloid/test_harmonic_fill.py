"""Functions that satisfy Laplace's equation on the sphere are known: what is cut out of them must come back."""

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.paraboloid import harmonic_fill, multigrid
from processing.paraboloid.harmonic_fill import fill
from processing.paraboloid.maps import texel_directions
from processing.paraboloid.read import lookup

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
SIZE = 96


def unit(*vector: float) -> F64:
    direction: F64 = np.array(vector) / np.linalg.norm(vector)
    return direction


def known_outside(towards: F64, angle_rad: float, size: int = SIZE) -> list[Mask]:
    return [directions @ towards < np.cos(angle_rad) for directions in texel_directions(size)]


def harmonic(directions: F64, away_from: F64) -> F64:
    """Logarithms of the ratio of distances to two poles each; all six are on the other side."""
    beside = np.cross(away_from, unit(0.3, 0.5, 0.8))
    across = np.cross(away_from, beside)
    poles = [unit(*(-away_from + 0.3 * x * beside + 0.3 * y * across)) for x, y in ((1, 0), (-1, 0.5), (0, 1))]
    near = [1 - directions @ pole for pole in (*poles, -away_from)]
    with np.errstate(divide="ignore"):
        return np.stack([np.log(near[k] / near[k + 1]).clip(-6, 6) for k in range(3)], axis=-1)


@pytest.mark.parametrize(
    ("towards", "angle_rad"),
    [((0, 0, -1), 0.8), ((0, 0, 1), 0.4), ((1, 0.2, 0.1), 0.9), ((0.4, 0.2, -0.9), 2.2)],
    ids=["in the back half", "in the front half", "across the seam", "most of the sphere"],
)
@pytest.mark.parametrize("size", [SIZE, 75])
def test_a_hole_in_a_harmonic_function_is_filled_with_that_function(
    towards: tuple[float, float, float], angle_rad: float, size: int
) -> None:
    axis = unit(*towards)
    known = known_outside(axis, angle_rad, size)
    truth = [harmonic(directions, axis) for directions in texel_directions(size)]
    holed = [np.where(mask[..., None], plane, np.nan) for mask, plane in zip(known, truth, strict=True)]
    found = fill(holed[0], holed[1], known[0], known[1])
    for mask, plane, true in zip(known, found, truth, strict=True):
        # Corners too: a texel beyond the circle is known only if the other half's there are.
        np.testing.assert_allclose(plane[~mask], true[~mask], atol=2e-3)


def test_what_is_known_keeps_its_bits_and_corners_go_on_across_the_seam() -> None:
    random = np.random.default_rng(1)
    front, back = random.uniform(-5, 5, (2, SIZE, SIZE, 2)).astype(np.float32)
    known = known_outside(unit(1, 0, 0.3), 0.7)
    found = fill(front, back, known[0], known[1])
    directions = texel_directions(SIZE)
    for mask, given, plane, d in zip(known, (front, back), found, directions, strict=True):
        within = np.abs(d[..., 2]) >= 0
        within &= (d[..., 2] >= 0) == (d[SIZE // 2, SIZE // 2, 2] > 0)
        np.testing.assert_array_equal(plane[mask & within], given[mask & within])
        far = ~within & (np.abs(d[..., 2]) > 4 / SIZE)
        np.testing.assert_allclose(plane[far], lookup(found[0], found[1], d[far]), atol=1e-5)
    assert np.isfinite(found).all()


def test_a_source_is_the_laplacian_on_the_sphere() -> None:
    """A spherical harmonic of degree l has the Laplacian −l(l + 1) times itself."""
    towards = unit(0.8, 0.1, -0.4)
    known = known_outside(towards, 1.2)
    truth = [np.stack([d[..., 0], d[..., 0] * d[..., 2]], axis=-1) for d in texel_directions(SIZE)]
    source = [plane * np.array([-2.0, -6.0]) for plane in truth]
    found = fill(truth[0], truth[1], known[0], known[1], (source[0], source[1]))
    for mask, plane, true in zip(known, found, truth, strict=True):
        np.testing.assert_allclose(plane[~mask], true[~mask], atol=5e-3)


def test_the_filling_stays_between_what_is_known() -> None:
    random = np.random.default_rng(2)
    front, back = random.uniform(0, 1, (2, SIZE, SIZE, 1))
    scattered = random.uniform(size=(2, SIZE, SIZE)) < 0.03
    found = fill(front, back, scattered[0], scattered[1])
    assert min(plane.min() for plane in found) >= 0
    assert max(plane.max() for plane in found) <= 1


def test_a_half_that_is_known_whole_fills_the_other() -> None:
    """By reflection at the seam: what is harmonic and x on the rim is x times tan(θ/2), θ from the other pole.

    The rim is as sharp as a texel is large.
    """
    everything, nothing = np.ones((SIZE, SIZE), bool), np.zeros((SIZE, SIZE), bool)
    front, back = texel_directions(SIZE)
    _, found = fill(front[..., :1], np.zeros((SIZE, SIZE, 1)), everything, nothing)
    inner = back[..., 2] < 0
    expected = back[..., 0] / (1 - back[..., 2])
    np.testing.assert_allclose(found[inner][..., 0], expected[inner], atol=2 / SIZE)


def test_one_known_texel_fills_everything() -> None:
    known = np.zeros((2, 40, 40), bool)
    known[0, 17, 20] = True
    values = np.where(known, 3.5, np.nan)[..., None]
    found = fill(values[0], values[1], known[0], known[1])
    np.testing.assert_allclose(found, 3.5, atol=1e-6)


@pytest.mark.parametrize(
    ("value", "known", "reason"),
    [
        (1.0, np.zeros((8, 8), bool), "nothing is known"),
        (np.nan, np.ones((8, 8), bool), "no finite numbers"),
        (1.0, np.ones((8, 9), bool), "do not fit"),
        (1.0, np.ones((8, 8)), "boolean"),
    ],
    ids=["nothing", "NaN", "shape", "kind"],
)
def test_what_cannot_be_filled_is_refused(value: float, known: Mask, reason: str) -> None:
    plane = np.full((8, 8, 3), value)
    with pytest.raises(InputError, match=reason):
        fill(plane, plane, known, known)


def test_only_corners_being_known_is_nothing() -> None:
    corner = np.zeros((16, 16), bool)
    corner[0, 0] = True
    with pytest.raises(InputError, match="nothing is known"):
        fill(np.ones((16, 16, 3)), np.ones((16, 16, 3)), corner, corner)


@pytest.mark.parametrize("seed", range(8))
def test_in_ragged_holes_each_texel_is_the_mean_of_its_neighbours(seed: int) -> None:
    """Holes of single texels, lines, and all but some, at odd sizes: where multigrid has its trouble."""
    random = np.random.default_rng(seed)
    size = int(random.integers(20, 90))
    values = random.uniform(0, 1, (2, size, size, 1))
    unknown = np.stack(known_outside(unit(*random.normal(size=3)), random.uniform(0.2, 2.8), size))
    unknown ^= random.uniform(size=unknown.shape) < (0.0, 0.02, 0.3)[seed % 3]
    unknown[0, :, size // 3] ^= seed % 2 == 0
    found = fill(values[0], values[1], ~unknown[0], ~unknown[1])
    along = (2 * np.arange(size) + 1) / size - 1
    inner = np.hypot(along, along[:, None])[1:-1, 1:-1] < 1 - 3 / size
    for hole, plane in zip(unknown, np.stack(found)[..., 0], strict=True):
        mean = (plane[2:, 1:-1] + plane[:-2, 1:-1] + plane[1:-1, 2:] + plane[1:-1, :-2]) / 4
        here = inner & hole[1:-1, 1:-1]
        np.testing.assert_allclose(plane[1:-1, 1:-1][here], mean[here], atol=1e-5)


@pytest.mark.parametrize("sourced", [False, True])
def test_a_hole_that_multigrid_leaves_is_filled_all_the_same(sourced: bool) -> None:
    """No cycle changes nothing at all, so that a tolerance of 0 is never met."""
    axis = unit(0.8, 0.1, -0.4)
    known = known_outside(axis, 1.2, 40)
    truth = [np.stack([d[..., 0], d[..., 0] * d[..., 2]], axis=-1) for d in texel_directions(40)]
    source = (truth[0] * np.array([-2.0, -6.0]), truth[1] * np.array([-2.0, -6.0])) if sourced else None
    one = fill(truth[0], truth[1], known[0], known[1], source)
    other = fill(truth[0], truth[1], known[0], known[1], source, tolerance=0)
    np.testing.assert_allclose(other, one, atol=1e-5)
    assert any(np.any(a != b) for a, b in zip(one, other, strict=True))


def test_a_hole_that_nothing_fills_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harmonic_fill, "MOST_DIRECTLY", 100)
    known = known_outside(unit(1, 0, 0), 1.2, 40)
    front, back = (d[..., :1] for d in texel_directions(40))
    with pytest.raises(InputError, match=r"filling \d{4} texels still changes by .* take a smaller map"):
        fill(front, back, known[0], known[1], tolerance=0)


@pytest.mark.parametrize("seed", range(4))
def test_holes_of_any_kind_are_filled_in_few_cycles(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(multigrid, "_MOST_CYCLES", 20)
    monkeypatch.setattr(harmonic_fill, "MOST_DIRECTLY", 0)
    random = np.random.default_rng(seed)
    front, back = random.uniform(0, 1, (2, 33 + seed, 33 + seed, 1))
    one = np.zeros((2, *front.shape[:2]), bool)
    one[seed % 2, 10 + seed, 20] = True
    chess = np.zeros_like(one)
    chess[:, ::2, ::2] = chess[:, 1::2, 1::2] = True
    few: Mask = np.less(random.uniform(size=one.shape), 0.5 * 0.1 ** (seed % 3))
    line = np.zeros_like(one)
    line[seed % 2, :, 15] = True
    masks: list[Mask] = [one, ~one, line, ~line, chess, few]
    for known in masks:
        assert np.isfinite(fill(front, back, known[0], known[1])).all()


def test_few_known_texels_of_many_are_no_trouble(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is known around them is, on coarse grids, far larger than they are."""
    monkeypatch.setattr(multigrid, "_MOST_CYCLES", 15)
    monkeypatch.setattr(harmonic_fill, "MOST_DIRECTLY", 0)
    known = np.zeros((2, 128, 128), bool)
    known[0, 64, 64:66] = True
    front, back = np.random.default_rng(0).uniform(0, 1, (2, 128, 128, 1))
    found = np.stack(fill(front, back, known[0], known[1]))
    assert np.all(found >= front[64, 64:66].min() - 1e-5) and np.all(found <= front[64, 64:66].max() + 1e-5)
