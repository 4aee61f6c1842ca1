"""The oracle of filter sizes: MatCaps whose variances are known (the MatCap paper, figure 5), as a Markdown table."""

import numpy as np

from tests.processing.matcap.estimate.primitives import SHAPES, Primitive, Shape, estimated, has_one_mode

SIZES = (128, 256, 512)
THETAS, DEVIATIONS = (0.4, 0.7, 1.0), (0.08, 0.14, 0.2, 0.28, 0.4)


def filter_sizes() -> str:
    """Estimate every light at every resolution, and say how far off variances are."""
    lines = ["| light | resolution | median | 90th percentile | most | of those with one mode: 90th percentile |"]
    lines.append("| --- |" + " --- |" * 5)
    for shape in SHAPES:
        lines += [_row(shape, size) for size in SIZES]
    return "\n".join(lines)


def _row(shape: Shape, size: int) -> str:
    lights = [Primitive(shape, theta, deviation) for theta in THETAS for deviation in DEVIATIONS]
    errors = np.array([abs(estimated(light, size).filter_size / light.variance - 1) for light in lights])
    simple = errors[[has_one_mode(light) for light in lights]]
    figures = (np.median(errors), np.quantile(errors, 0.9), errors.max(), np.quantile(simple, 0.9))
    return f"| {shape} | {size} | " + " | ".join(f"{figure:.2%}".replace("%", " %") for figure in figures) + " |"
