"""How well a material gives back the pictures that it was fitted to, and how well those it has not seen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.progress import Progress, Report, silent
from processing.decoded import spread
from processing.ptm.fit import Fit
from processing.ptm.model import Ptm, Strip
from processing.ptm.relighting.relight import relight
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_PIXELS, _PIXELS_WEIGHTED = 6_000, 4_000
# A light that alone decides a coefficient cannot be left out.
_LEAST_FREEDOM = 1e-3
_WORST = 3


@dataclass(frozen=True)
class FitQuality:
    """Peak signal-to-noise ratios against white, in dB; infinite for no error at all.

    Attributes
    ----------
    psnr_db : over all frames
    per_light_db : (N,) frame by frame
    residuals : (H, W) float32, RMS error of each pixel over frames and channels
    """

    psnr_db: float
    per_light_db: F64
    residuals: F32

    def worst(self, count: int) -> list[int]:
        """Return the indices of the frames that fit worst, the worst first."""
        return [int(index) for index in np.argsort(self.per_light_db, kind="stable")[:count]]


def fit_quality(ptm: Ptm, stack: Stack, light_dirs: NDArray[np.floating], report: Report = silent) -> FitQuality:
    """Relight at the light of every frame and compare; values are cut to 0..1 first, as a display shows them.

    Parameters
    ----------
    stack : N pictures
    light_dirs : (N, 3), as for the fit
    """
    errors = np.zeros(len(stack))
    squares = np.zeros(stack.shape, np.float32)
    for index in range(len(stack)):
        shown = np.clip(relight(ptm, light_dirs[index]), 0, 1)
        squared = np.mean((shown - stack.frame(index, ptm.space)) ** 2, axis=-1)
        errors[index] = np.mean(squared, dtype=np.float64)
        squares += squared
        report(Progress("comparing", index + 1, len(stack), stack.paths[index].name))
    return FitQuality(float(psnr_db(errors.mean())), psnr_db(errors), np.sqrt(squares / len(stack)))


@dataclass(frozen=True)
class FitReport:
    """What a fit is worth, measured on a sample of its pixels; in dB against white, infinite for no error.

    Attributes
    ----------
    fit_db : of the coefficients as they were fitted, over all lights
    stored_db : of what a file holds of them; None where it holds all
    per_light_db : (N,) of the fit, light by light
    left_out_db : (N,) of each picture as the fit without it predicts it; not a number where there is no fit without it
    pixels : how many were looked at
    kept_share : mean weight of the pictures; 1 in least squares
    """

    fit_db: float
    stored_db: float | None
    per_light_db: F64
    left_out_db: F64
    pixels: int
    kept_share: float

    @property
    def left_out_mean_db(self) -> float:
        """Of all pictures that can be left out, each predicted without itself; not a number where none can."""
        known = self.left_out_db[~np.isnan(self.left_out_db)]
        return float(psnr_db(np.mean(10 ** (-known / 10)))) if len(known) else float("nan")

    def worst(self, count: int) -> list[int]:
        """Return the indices of the lights that the others predict worst, the worst first."""
        order = np.argsort(np.nan_to_num(self.left_out_db, nan=np.inf, posinf=1e9), kind="stable")
        return [int(index) for index in order[:count]]

    def lines(self, names: Sequence[str]) -> list[str]:
        """Say it to a person, a line a light; `names` of the pictures."""
        stored = "" if self.stored_db is None else f"; as stored {self.stored_db:.2f} dB"
        kept = "" if self.kept_share == 1 else f"; {self.kept_share:.0%} of the values count"
        width = max(map(len, names))
        worst = ", ".join(f"{names[index]} {_decibels(self.left_out_db[index])}" for index in self.worst(_WORST))
        return [
            f"fit: {self.fit_db:.2f} dB over {len(names)} pictures and {self.pixels} pixels{stored}{kept}",
            f"{'picture':{width}}       fit  predicted by the others",
            *(
                f"{name:{width}}  {_decibels(fit_db):>8}  {_decibels(left_out_db):>8}"
                for name, fit_db, left_out_db in zip(names, self.per_light_db, self.left_out_db, strict=True)
            ),
            f"predicted by the others: {_decibels(self.left_out_mean_db)} in all; worst {worst}",
        ]

    def facts(self, names: Sequence[str]) -> dict[str, Any]:
        """Say it to a program; what is not a finite number is null."""
        return {
            "fit_db": _finite(self.fit_db),
            "stored_db": None if self.stored_db is None else _finite(self.stored_db),
            "predicted_db": _finite(self.left_out_mean_db),
            "pixels": self.pixels,
            "kept_share": self.kept_share,
            "pictures": [
                {"name": name, "fit_db": _finite(fit_db), "predicted_db": _finite(left_out_db)}
                for name, fit_db, left_out_db in zip(names, self.per_light_db, self.left_out_db, strict=True)
            ],
            "worst": [names[index] for index in self.worst(_WORST)],
        }


def _decibels(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.1f} dB"


def _finite(value: float) -> float | None:
    return round(float(value), 3) if np.isfinite(value) else None


def report_on(fitted: Fit, stored: Callable[[Strip], Strip] | None = None) -> FitReport:
    """Compare a fit with its pictures.

    Leaving a picture out needs no second fit. In least squares with weights w, design Φ and H = Φ(ΦᵀWΦ)⁻¹ΦᵀW, the
    error at a light whose picture was left out is its residual divided by 1 − H_nn. With robust weights these are kept
    as they are. For LRGB, what the split into luminance and colour costs is added.

    Parameters
    ----------
    stored : what is left of coefficients in a file
    """
    whole = fitted.settings.near is None and fitted.settings.robust == "no"
    pixels = spread(fitted.shape, _PIXELS if whole else _PIXELS_WEIGHTED)
    values, coefficients, weights, design = fitted.at(pixels)
    strip = fitted.split(coefficients)
    predicted = _each(design, coefficients)
    shown = _shown(design, strip)
    residual = values - predicted
    freedom = 1 - _leverage(design, weights, fitted.held)
    left_out = residual / np.maximum(freedom, _LEAST_FREEDOM)[..., None] + (predicted - shown)
    lost = (freedom < _LEAST_FREEDOM).mean(axis=1) > 0.5
    # A display cuts off what is not 0..1.
    errors = np.mean((values - np.clip(shown, 0, 1)) ** 2, axis=(1, 2), dtype=np.float64)
    alone = np.mean((values - np.clip(values - left_out, 0, 1)) ** 2, axis=(1, 2), dtype=np.float64)
    after = None
    if stored is not None:
        kept = np.clip(_shown(design, stored(strip)), 0, 1)
        after = float(psnr_db(np.mean((values - kept) ** 2, dtype=np.float64)))
    return FitReport(
        fit_db=float(psnr_db(errors.mean())),
        stored_db=after,
        per_light_db=psnr_db(errors),
        left_out_db=np.where(lost, np.nan, psnr_db(alone)),
        pixels=len(pixels),
        kept_share=float(weights.mean()),
    )


def psnr_db(squared_error: NDArray[np.floating] | np.floating) -> F64:
    """Turn mean squared errors into decibels against white."""
    with np.errstate(divide="ignore"):
        decibels: F64 = -10 * np.log10(np.asarray(squared_error, np.float64))
    return decibels


def _shown(design: F64, strip: Strip) -> F32:
    """Relight pixels (T, n, C) at each light, (N, n, 3)."""
    values = _each(design, strip.coefficients)
    return values if strip.colour is None else values * strip.colour


def _each(design: F64, coefficients: F32) -> F32:
    if design.shape[1] == 1:
        return np.asarray(np.tensordot(design[:, 0].astype(np.float32), coefficients, axes=1), np.float32)
    return np.asarray(np.einsum("npt,tpc->npc", design, coefficients), np.float32)


def _leverage(design: F64, weights: F32, held: F64) -> F64:
    """Return the diagonal of the hat matrix, (N, 1) where all pixels are alike and (N, n) otherwise."""
    if design.shape[1] == 1 and np.all(weights == 1):
        weights = weights[:, :1]
    each = np.broadcast_to(design, (*weights.shape, design.shape[2]))
    normal = np.einsum("np,npt,nps->pts", weights, each, each) + np.diag(held)
    inverse = np.linalg.pinv(normal, hermitian=True)
    return np.asarray(np.einsum("np,npt,pts,nps->np", weights, each, inverse, each, optimize=True), np.float64)
