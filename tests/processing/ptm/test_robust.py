from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.ptm.basis import PTM, Basis
from processing.ptm.conditioning import fitting_matrix, ridge_weights
from processing.ptm.fit import fit
from processing.ptm.robust import Robust, fit_weighted
from processing.stack import Stack
from tests.processing.ptm.relief import dome, write_relief

F32 = NDArray[np.float32]
LIGHTS = dome(50)
BASES = [PTM, Basis("hsh", 4), Basis("hsh", 9)]


def clean(basis: Basis, pixels: int = 200) -> tuple[F32, NDArray[np.float64]]:
    """Values (N, P, 3) that the basis describes, and their coefficients (T, P, 3)."""
    random = np.random.default_rng(1)
    truth = 0.08 * random.standard_normal((basis.terms, pixels, 3))
    truth += np.linalg.lstsq(basis.evaluate(LIGHTS), np.full(50, 0.5), rcond=None)[0][:, None, None]
    return np.tensordot(basis.evaluate(LIGHTS), truth, 1).astype(np.float32), truth


def spoiled(values: F32, share: float, seed: int = 2) -> F32:
    """Shadows in a share of the pictures of each pixel, highlights in half as many."""
    random = np.random.default_rng(seed)
    lot = random.uniform(size=values.shape[:2])[..., None]
    return np.where(lot < share, 0.0, np.where(lot > 1 - share / 2, 1.0, values)).astype(np.float32)


def fitted(values: F32, basis: Basis, robust: Robust) -> tuple[F32, F32]:
    solver = fitting_matrix(basis, LIGHTS).astype(np.float32)
    plain = np.tensordot(solver, values, 1)
    return fit_weighted(values, basis.evaluate(LIGHTS)[:, None], np.zeros(basis.terms), plain, robust)


@pytest.mark.parametrize("basis", BASES, ids=str)
@pytest.mark.parametrize("robust", ["no", "trimmed", "reweighted"])
def test_what_is_not_spoiled_is_fitted_exactly(basis: Basis, robust: Robust) -> None:
    values, truth = clean(basis)
    assert fitted(values, basis, robust)[0] == pytest.approx(truth, abs=2e-4)


@pytest.mark.parametrize("basis", BASES, ids=str)
def test_shadows_and_highlights_are_held_back(basis: Basis) -> None:
    values, truth = clean(basis)
    errors = {
        robust: float(np.sqrt(np.mean((fitted(spoiled(values, 0.1), basis, robust)[0] - truth) ** 2)))
        for robust in ("no", "trimmed", "reweighted")
    }
    assert errors["trimmed"] < 0.5 * errors["no"]
    assert errors["reweighted"] < 0.1 * errors["no"]


def test_weights_tell_what_was_held_back() -> None:
    values, _ = clean(PTM)
    spoilt = spoiled(values, 0.1)
    _, weights = fitted(spoilt, PTM, "reweighted")
    bad = (np.abs(spoilt - values) > 0.1).any(axis=-1)
    assert weights[bad].mean() < 0.1
    assert weights[~bad].mean() > 0.8


def test_a_pixel_whose_pictures_are_nearly_all_alike_falls_back_on_least_squares() -> None:
    """Trimmed to lights that cannot carry the basis, there is nothing to solve."""
    lights = np.concatenate([np.tile([0.6, 0.0, 0.8], (8, 1)), dome(9)])
    values = np.concatenate([np.full((8, 1, 3), 0.5), np.linspace(0, 1, 9)[:, None, None] * np.ones((1, 1, 3))])
    plain = np.tensordot(np.linalg.pinv(PTM.evaluate(lights)), values, 1).astype(np.float32)
    coefficients, _ = fit_weighted(
        values.astype(np.float32), PTM.evaluate(lights)[:, None], np.zeros(6), plain, "trimmed"
    )
    assert np.isfinite(coefficients).all()


def test_ridge_holds_in_every_way_of_fitting_alike() -> None:
    values, _ = clean(PTM)
    held = ridge_weights(PTM.evaluate(LIGHTS), 0.01)
    plain = np.tensordot(fitting_matrix(PTM, LIGHTS, 0.01), values, 1).astype(np.float32)
    weighted, _ = fit_weighted(values, PTM.evaluate(LIGHTS)[:, None], held, np.zeros_like(plain), "no")
    assert weighted == pytest.approx(plain, abs=1e-4)


def test_cast_shadows_pull_a_robust_fit_less(tmp_path: Path) -> None:
    """Inside the plateau's shadow the robust fit is brighter: it describes the surface and not the shadow."""
    stack = Stack(write_relief(tmp_path, LIGHTS))
    plain, robust = (fit(stack, LIGHTS, colour="rgb", robust=way) for way in ("no", "reweighted"))
    mean = PTM.evaluate(LIGHTS).mean(axis=0).astype(np.float32)
    lifted = np.tensordot(mean, robust.coefficients - plain.coefficients, 1).mean(axis=-1)
    shadowed = np.mean([stack.encoded(index).mean(-1) < 0.02 for index in range(50)], axis=0)
    assert lifted[(shadowed > 0.15) & (shadowed < 0.5)].mean() > 0.02
    assert abs(lifted[shadowed == 0].mean()) < 0.02
