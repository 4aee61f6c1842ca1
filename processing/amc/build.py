"""From a turn of pictures to an Anisotropic MatCap (the AMC paper, sections 4 and 5).

Pictures → slices of table normals (`shots`, `resample`) → what is wrong with the sample (`flaws`) → R (`probe`,
`invariance`) → even slices (`table`). All in linear light.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder.capture import Capture
from litrig.base.errors import InputError
from litrig.base.progress import Report, silent
from litrig.base.table_normals import TableNormal
from processing.amc.flaws.mend import Flaws, mend
from processing.amc.geometry import SphereView
from processing.amc.invariance import InvarianceReport, find_invariance
from processing.amc.model import Amc, Invariance, TangentAngle
from processing.amc.noise import noise_variance
from processing.amc.probe import Probe, make_probe
from processing.amc.resample import dilate
from processing.amc.settings import Settings
from processing.amc.shots import Shots, Slices, find_shots
from processing.amc.split import fit_envelope
from processing.amc.table import make_table
from processing.outline.orbit import Outline
from processing.room import make_room

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class AmcResult:
    """An AMC and how it came about.

    Attributes
    ----------
    amc : the table
    outline : the sphere's silhouette, found or given, and how it moved
    distance_radii : camera to sphere centre that was used; None for orthographic
    invariance : what the test over the turn said, also when R was prescribed
    flaws : what was found wrong with the sample, and filled
    picture_shape : height and width of the pictures
    residuals : (N,) RMS difference between each captured slice and the table, in linear light, away from the rim
    coverage : share of the table's disc that was seen and not filled
    """

    amc: Amc
    outline: Outline
    distance_radii: float | None
    invariance: InvarianceReport
    flaws: Flaws
    picture_shape: tuple[int, int]
    residuals: F64
    coverage: float


def build(
    capture: Capture, settings: Settings | None = None, *, mask: Mask | None = None, report: Report = silent
) -> AmcResult:
    """Build the table from one turn of the sphere.

    Parameters
    ----------
    capture : frames with turntable angles
    settings : every choice; the defaults when None
    mask : (H, W) bool over the picture that was shot first, what is not the material's there

    Raises
    ------
    InputError
        Frames without an angle, fewer than eight, a gap between angles, a sphere that is not found or is cut by the
        border, a mask of another size.
    """
    settings = settings or Settings()
    shots = find_shots(capture, settings, report)
    slices, flaws = _mended(shots, settings, mask, report)
    return _assemble(shots, slices, flaws, settings)


def build_unlit(
    lit: AmcResult,
    capture: Capture,
    settings: Settings | None = None,
    *,
    mask: Mask | None = None,
    report: Report = silent,
) -> AmcResult:
    """Build the companion of a table from the same turn without its key light (the AMC paper, section 6.1).

    A renderer reads the one where the key light falls and the other in its shadow, so that both have one circle, R,
    depth, table normal and kind of angle.

    Raises
    ------
    InputError
        As `build`.
    """
    like = lit.amc
    settings = replace(
        settings or Settings(),
        circle=lit.outline.circle,
        distance_radii=lit.distance_radii,
        invariance=like.invariance,
        depth=len(like.slices),
        tangent_angle=like.tangent_angle,
    )
    shots = replace(find_shots(capture, settings, report), outline=lit.outline)
    if shots.stack.shape != lit.picture_shape:
        (height, width), (lit_height, lit_width) = shots.stack.shape, lit.picture_shape
        raise InputError(
            f"{capture.folder}: its pictures have {width} × {height} pixels, those with the key light {lit_width} × "
            f"{lit_height}; shoot both turns with the same camera at the same place"
        )
    slices, flaws = _mended(shots, settings, mask, report)
    return _assemble(shots, slices, flaws, settings)


def build_split(
    capture: Capture, settings: Settings | None = None, *, mask: Mask | None = None, report: Report = silent
) -> tuple[AmcResult, AmcResult]:
    """Build two tables whose sum is the material: what is akin to diffuse light, and the gloss above it.

    Each has the table normal that suits it: the camera's, which is exact for Lambert, and the rectified one. The low
    part is a smooth lower envelope over the normals; R is found for each.

    Raises
    ------
    InputError
        As `build`.
    """
    settings = settings or Settings()
    shots = find_shots(capture, settings, report)
    low_settings = replace(settings, table_normal=TableNormal.CAMERA)
    low, low_flaws = _mended(shots, low_settings, mask, report)
    if shots.distance_radii is None:
        room = make_room(low.light.shape)
        room.array[:] = low.light
        high, high_flaws = replace(low, room=room), low_flaws
    else:
        high, high_flaws = _mended(shots, settings, mask, report)
    envelope = fit_envelope(low.light, low.normals, low.valid)
    low.light[:] = envelope.below(low.light, low.normals)
    high.light[:] -= envelope.below(high.light, high.normals)
    return (
        _assemble(shots, low, low_flaws, low_settings),
        _assemble(shots, high, high_flaws, settings),
    )


def _mended(shots: Shots, settings: Settings, mask: Mask | None, report: Report) -> tuple[Slices, Flaws]:
    view = SphereView(settings.table_normal, shots.distance_radii)
    slices = shots.slices(view, settings.size, report)
    marks = None if mask is None else shots.marked(mask, view, settings.size)
    return slices, mend(slices, shots, settings, marks)


def _assemble(shots: Shots, slices: Slices, flaws: Flaws, settings: Settings) -> AmcResult:
    """Find R and make even slices, in place of the shot ones."""
    probe = make_probe(slices, shots.series)
    evidence = _find_invariance(probe, slices, settings)
    chosen = _choose(settings, evidence)
    repeats, depth = _period(chosen, settings, shots.series.told)
    tangent_angle = settings.tangent_angle or _tangent_angle(chosen, evidence)
    turn = slices.turn.upright if tangent_angle is TangentAngle.SURFACE else slices.turn
    residuals = (probe.upright() if turn is not slices.turn else probe).residuals(depth, repeats)
    table = make_table(slices.room, shots.series, turn, depth, repeats)
    amc = Amc(
        slices=dilate(table, slices.valid, out=table),
        valid=np.broadcast_to(slices.valid, table.shape[:3]),
        invariance=chosen,
        table_normal=settings.table_normal,
        slice_angles_deg=tuple(float(angle) for angle in shots.tangents_deg),
        source=shots.source,
        tangent_angle=tangent_angle,
    )
    return AmcResult(
        amc=amc,
        outline=shots.outline,
        distance_radii=shots.distance_radii,
        invariance=evidence,
        flaws=flaws,
        picture_shape=shots.stack.shape,
        residuals=residuals,
        coverage=min(1.0, float(slices.valid.mean() / (np.pi / 4))) * (1 - flaws.filled),
    )


def _find_invariance(probe: Probe, slices: Slices, settings: Settings) -> InvarianceReport:
    return find_invariance(
        probe.harmonics(),
        probe.upright().harmonics(),
        settings.threshold,
        most_repeats=settings.most_repeats,
        noise=float(np.sqrt(noise_variance(slices.light, slices.valid, slices.difference_gain))),
        regions=probe.regions,
    )


def _choose(settings: Settings, evidence: InvarianceReport) -> Invariance:
    """Keep every slice where one cannot tell."""
    if settings.invariance != "auto":
        return settings.invariance
    return 1 if evidence.found == "cannot tell" else evidence.found


def _period(chosen: Invariance, settings: Settings, captured: int) -> tuple[int, int]:
    """Return by how much k is multiplied, and the slices to store."""
    if chosen == "isotropic":
        return 1, 1
    return chosen, settings.depth or max(1, -(-captured // chosen))


def _tangent_angle(chosen: Invariance, evidence: InvarianceReport) -> TangentAngle:
    """Store over the picture's angle, as the paper does, unless folding by R would lose what the surface keeps."""
    if chosen == "isotropic" or chosen <= 2:
        return TangentAngle.PICTURE
    entry = evidence.of(chosen)
    better = entry is not None and entry.outside_surface < entry.outside_picture
    return TangentAngle.SURFACE if better else TangentAngle.PICTURE
