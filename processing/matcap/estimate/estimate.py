"""The size of the filter that a material is, from a MatCap alone (the MatCap paper, section 3)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.matcap.estimate.find_regions import find_regions
from processing.matcap.estimate.meridians import Meridians
from processing.matcap.estimate.profiles import Of
from processing.matcap.estimate.region_estimate import Question, RegionEstimate, best_of
from processing.matcap.estimate.regions import Region
from processing.matcap.estimate.rules import Rule
from processing.matcap.estimate.signatures import Signatures
from processing.matcap.filter import MATT_FILTER_SIZE, slope_of

Kind = Literal["values", "edges", "auto"]

_KINDS: dict[Kind, tuple[Of, ...]] = {
    "values": ("values", "bumps"),
    "edges": ("edges",),
    "auto": ("values", "bumps", "edges"),
}
_MOST_FOUND = 3
_SMALLEST_SIDE = 16
_WHITE = 1 - 0.5 / 255


@dataclass(frozen=True)
class FilterEstimate:
    """A material's filter.

    Attributes
    ----------
    filter_size : ν in radians squared
    slope : μ(ν)
    chosen : the region that says so, by its place in `regions`; None where none can
    remarks : what a person should know
    """

    filter_size: float
    slope: float
    chosen: int | None
    regions: tuple[RegionEstimate, ...]
    remarks: tuple[str, ...]

    @property
    def signatures(self) -> tuple[Signatures, ...]:
        """The signatures of all regions."""
        return tuple(region.signatures for region in self.regions)


def estimate_filter_size(
    component: NDArray[np.floating],
    rois: Sequence[Region] | None = None,
    *,
    of: Kind = "auto",
    rule: Rule = "plateau",
    quantile: float | None = None,
    clipped: NDArray[np.bool_] | None = None,
) -> FilterEstimate:
    """Estimate the size of the filter that blurs a component's lights, and the slope that goes with it.

    The sharpest feature decides: the light there is taken for a point, a line or an edge, so that all of its variance
    is the material's (equation 4).

    Parameters
    ----------
    component : (S, S, 3) linear light, the disc inscribed in the square
    rois : regions around sharp features; None to find them
    of : where a region's light is a point or line, "values" of R, above the ground it stands on if need be; where it
        has an edge, "edges", |R′|; "auto" asks both
    rule : which window counts; "paper" for its four cases, and its equation 6
    quantile : 0 to 1, which of a region's pixels counts; by default the median, by the paper's rule the least
    clipped : (S, S) bool, pixels brighter than the picture could hold; by default those at white

    Raises
    ------
    InputError
        The component is no square picture of finite light, or a region is not on the disc.
    """
    matcap = np.asarray(component)
    _check(matcap)
    meridians = Meridians.of(matcap)
    share = quantile if quantile is not None else (0.5 if rule == "plateau" else 0.0)
    question = Question(rule, share, matcap.max(axis=2) >= _WHITE if clipped is None else clipped)
    kinds = _KINDS[of] if rule == "plateau" else tuple(kind for kind in _KINDS[of] if kind != "bumps")
    asked: list[tuple[Region, tuple[Of, ...]]]
    if rois is None:
        asked = [(one.region, (one.of,)) for one in find_regions(meridians, question.clipped, kinds, _MOST_FOUND)]
    else:
        asked = [(region, kinds) for region in rois]
    return _sharpest(tuple(best_of(meridians, region, kinds, question) for region, kinds in asked))


def _check(matcap: NDArray[np.floating]) -> None:
    size = matcap.shape[0] if matcap.ndim else 0
    if matcap.shape != (size, size, 3) or size < _SMALLEST_SIDE:
        raise InputError(
            f"{' × '.join(map(str, matcap.shape))} is no square picture of {_SMALLEST_SIDE} pixels or more, in three "
            "channels; give a larger one, cropped to the ball"
        )
    if not np.all(np.isfinite(matcap)):
        raise InputError("holds colours that are no numbers; mend it")


def _sharpest(regions: tuple[RegionEstimate, ...]) -> FilterEstimate:
    usable = [index for index, region in enumerate(regions) if np.isfinite(region.variance)]
    trusted = [index for index in usable if regions[index].trusted]
    if not usable:
        why = "no region has a signature that can be used" if regions else "no feature is sharp enough"
        remark = f"{why}: taken for matt; mark a sharp light with a region"
        return FilterEstimate(MATT_FILTER_SIZE, slope_of(MATT_FILTER_SIZE), None, regions, (remark,))
    best = min(trusted or usable, key=lambda index: regions[index].variance)
    variance = regions[best].variance
    remarks = regions[best].remarks
    if slope_of(variance) == 0:
        remarks = (*remarks, f"a filter size of {variance:.3g} is more than any material's: its slope is held at 0")
    return FilterEstimate(variance, slope_of(variance), best, regions, remarks)
