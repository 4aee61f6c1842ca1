"""The oracle's measurements over all metals, brushings, cameras and weaves, as Markdown tables."""

from collections.abc import Iterable, Iterator, Sequence

from firmware_sim.mitsuba.config import Brushing, Invariance, MitsubaScene
from litrig.base.table_normals import TableNormal
from processing.ptm.model import Colour
from tests.oracle.measure import (
    fabric_verdict,
    light_errors,
    perspective_error,
    predict_brushing,
    ptm_fit,
    split_errors,
    truth_noise_db,
)
from tests.oracle.shoot import BOTH, FABRICS, MATERIALS, METALS, NAIVE, OTHER_BRUSHINGS, RELIEF, Studio, Way

BRUSHINGS: tuple[Brushing, ...] = ("parallels", *OTHER_BRUSHINGS)
DISTANCES_RADII = (4.0, 8.0, 20.0)
WAYS: dict[str, Way] = {
    "rectified": TableNormal.RECTIFIED,
    "view": TableNormal.VIEW,
    "camera": TableNormal.CAMERA,
    "naive crop": NAIVE,
}
COLOURS: tuple[Colour, ...] = ("rgb", "lrgb")
Row = Sequence[str]


def brushings(studio: Studio) -> str:
    """Predict each brushing of each metal, with the right tangents and with wrong ones."""
    return _table(
        ("material", "camera at, radii", *(f"{brushing}, dB" for brushing in BRUSHINGS)),
        (_brushing(studio, name, distance) for name in MATERIALS for distance in (None, *DISTANCES_RADII)),
    )


def noises(studio: Studio) -> str:
    """Say what part of those errors is the truth's own noise."""
    return _table(
        ("material", *(f"{brushing}, dB" for brushing in BRUSHINGS)),
        (
            (name, *(f"{truth_noise_db(studio, material, brushing):.1f}" for brushing in BRUSHINGS))
            for name, material in MATERIALS.items()
        ),
    )


def splits(studio: Studio) -> str:
    """Compare a low and a high table with either way alone."""
    return _table(
        ("camera at, radii", "brushing that is predicted", "low + high", "rectified alone", "camera alone"),
        (_split(studio, distance, brushing) for distance in DISTANCES_RADII for brushing in OTHER_BRUSHINGS),
    )


def perspective(studio: Studio) -> str:
    """Compare the ways to bring a perspective picture to the table."""
    return _table(("metal", "camera at, radii", *WAYS), _perspective_rows(studio))


def fabrics(studio: Studio) -> str:
    """Let the build find the invariance of each weave."""
    return _table(
        (
            "weave made with R",
            "camera",
            "R found",
            "change over k",
            "energy outside R, in the surface",
            "in the picture",
        ),
        (_fabric(studio, invariance, distance) for distance in (None, 8.0) for invariance in FABRICS),
    )


def relighting(studio: Studio) -> str:
    """Fit a PTM, through the file and back, beside NumPy's least squares in double precision."""
    return _table(("PTM", "ours, dB", "float least squares, dB", "lost, dB"), (_ptm(studio, c) for c in COLOURS))


def mirror_balls(studio: Studio) -> str:
    """Read light directions off a chrome ball."""
    return _table(
        ("camera at, radii", "mean, deg", "most, deg", "taken for orthographic: mean, deg", "outline off, % of R"),
        (_mirror_ball(studio, distance) for distance in (None, *DISTANCES_RADII)),
    )


def _mirror_ball(studio: Studio, distance_radii: float | None) -> Row:
    errors = light_errors(studio, distance_radii)
    naive = light_errors(studio, distance_radii, ignore_distance=True)
    figures = (
        f"{errors.mean_deg:.2f}",
        f"{errors.most_deg:.2f}",
        f"{naive.mean_deg:.2f}",
        f"{errors.outline:.2%}"[:-1],
    )
    return _camera(distance_radii), *figures


def _brushing(studio: Studio, name: str, distance_radii: float | None) -> Row:
    results = (predict_brushing(studio, MATERIALS[name], brushing, distance_radii) for brushing in BRUSHINGS)
    return name, _camera(distance_radii), *(f"{result.right_db:.1f} / {result.off_by_90_db:.1f}" for result in results)


def _camera(distance_radii: float | None) -> str:
    return "orthographic" if distance_radii is None else f"{distance_radii:g}"


def _split(studio: Studio, distance_radii: float, brushing: Brushing) -> Row:
    errors = split_errors(studio, BOTH, distance_radii, brushing)
    return f"{distance_radii:g}", brushing, *(f"{error:.4f}" for error in errors)


def _perspective_rows(studio: Studio) -> Iterator[Row]:
    for name, metal in METALS.items():
        for distance in DISTANCES_RADII:
            yield name, f"{distance:g}", *(f"{_mean_error(studio, metal, distance, way):.3f}" for way in WAYS.values())
        floor = f"{_mean_error(studio, metal, None, NAIVE):.3f}"
        yield name, "orthographic", *(floor for _ in WAYS)


def _mean_error(studio: Studio, metal: MitsubaScene, distance_radii: float | None, way: Way) -> float:
    errors = [perspective_error(studio, metal, distance_radii, way, brushing) for brushing in OTHER_BRUSHINGS]
    return sum(errors) / len(errors)


def _fabric(studio: Studio, invariance: Invariance, distance_radii: float | None) -> Row:
    report = fabric_verdict(studio, invariance, distance_radii).invariance
    camera = "orthographic" if distance_radii is None else f"at {distance_radii:g} radii"
    evidence = None if invariance == "isotropic" else report.of(invariance)
    shares = ("–", "–") if evidence is None else (f"{evidence.outside_surface:.3f}", f"{evidence.outside_picture:.3f}")
    return str(invariance), camera, str(report.found), f"{report.variation:.3f}", *shares


def _ptm(studio: Studio, colour: Colour) -> Row:
    result = ptm_fit(studio, RELIEF, studio.folder / f"{colour}.ptm", colour)
    lost_db = result.lstsq_db - result.ours_db
    return colour.upper(), f"{result.ours_db:.2f}", f"{result.lstsq_db:.2f}", f"{lost_db:.3f}"


def _table(headings: Row, rows: Iterable[Row]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
