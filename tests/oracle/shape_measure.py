"""Measurements of shape editing against mitsuba, by the commands and on mitsuba's own files."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from click.testing import CliRunner
from numpy.typing import NDArray

from litrig.base.pictures import read_linear
from litrig.commands import cli
from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.buffers.camera import CameraSaid
from processing.shape.buffers_exr import ReadOptions, read_buffers
from processing.shape.env_exr import read_environments
from processing.shape.lit_sphere import ball_normals, lit_sphere
from processing.shape.model import Environments, ShadingBuffers, SurfaceEnvironment
from processing.shape.recompose import recompose
from processing.shape.reconstruct import reconstruct
from tests.oracle.compare import psnr_db
from tests.oracle.first_hit import load_first_hit
from tests.oracle.shape_scenes import Probe, Render, Scene, Thing, render

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
DIFFUSE, REFLECTION = "first_hit.diffuse", "first_hit.reflection"
TRUTH_SEED = 2
TURNED_DEG = 1.0
"""Normals that an edit turns by more count as edited."""


@dataclass(frozen=True)
class Quality:
    """How pictures are rendered: mitsuba's variant, their side and samples a pixel, and where files go."""

    variant: str
    side_px: int
    samples: int
    folder: Path
    _made: dict[tuple[Scene, int], Render] = field(default_factory=dict, compare=False)

    def render(self, scene: Scene, seed: int = 1) -> Render:
        """Render a scene, once."""
        if (scene, seed) not in self._made:
            self._made[scene, seed] = render(scene, self.variant, self.side_px, self.samples, seed)
        return self._made[scene, seed]

    def write(self, picture: Render, name: str) -> "Stored":
        path = self.folder / name
        return Stored(path, picture.write(load_first_hit(self.variant), path))


class Stored(NamedTuple):
    """A file of mitsuba's, and the camera's matrix."""

    path: Path
    matrix: Path

    def read(self) -> ShadingBuffers:
        return read_buffers(self.path, ReadOptions(camera=CameraSaid(self.matrix)))

    def reconstructed(self, *options: object) -> Environments:
        """Reconstruct environments by the command."""
        output = self.path.with_suffix(".env.exr")
        _run("reconstruct", self.path, "-o", output, "--world-to-camera", self.matrix, *options)
        return read_environments(output)

    def recomposed(self, normals: Path, surface: int) -> F32:
        """Shade a surface under other normals by the command, in the light that was reconstructed before."""
        output, light = self.path.with_suffix(".edited.exr"), self.path.with_suffix(".env.exr")
        how = ("--world-to-camera", self.matrix, "--normals", normals, "--surface", surface)
        _run("recompose", self.path, light, *how, "-o", output)
        return read_linear(output)


def _run(*arguments: object) -> None:
    result = CliRunner().invoke(cli, ["shape", *map(str, arguments)])
    assert result.exit_code == 0, result.stderr or repr(result.exception)


class Ball(NamedTuple):
    """An environment on a ball, as it should be and as it was reconstructed.

    Attributes
    ----------
    truth, ours : (S, S, 3)
    whole, told : (S, S), the ball, and what of it the surface's pixels tell
    """

    truth: F32
    ours: F32
    whole: Mask
    told: Mask

    def error(self, where: Mask) -> float:
        """Return the RMS error relative to the truth's RMS."""
        return relative_rmse(self.ours[where], self.truth[where])


class Rebuilt(NamedTuple):
    """What was reconstructed from one picture, its share of all mirrored directions, and that picture."""

    diffuse: Ball
    reflection: Ball
    coverage: float
    picture: F32


POSES = {
    "teapot": Thing("teapot", "matt and metal", tilt_deg=15, turn_deg=-25),
    "vase": Thing("vase", "matt and metal", tilt_deg=15),
    "torus": Thing("torus", "matt and metal", tilt_deg=50),
}
IN_FRONT = (0.0, 0.0, 5.2)


def rebuilt(quality: Quality, shape: str, probe: Probe) -> Rebuilt:
    """Reconstruct a probe from a thing that nothing shadows (figure 6); the truth is a ball of the same material."""
    lone = Scene((POSES[shape],), probe, shadows=False, eye=IN_FRONT)
    rendered = quality.render(lone)
    stored = quality.write(rendered, f"{shape}-{probe}.exr")
    (environment,) = stored.reconstructed("--size", 256).values()
    truth = quality.render(_ball(probe, "matt and metal"))
    buffers = stored.read()
    found = next(iter(reconstruct(buffers).known.values()))
    normals, inside = ball_normals(quality.side_px)
    front, back = found.astype(np.float32)[..., None]
    told = (lookup(front, back, _mirrored(normals))[..., 0] > 0.5) & inside
    reached = _reached(buffers.normals[buffers.surfaces > 0], normals) & inside
    sides = [lit_sphere(environment, quality.side_px, part)[0] for part in ("diffuse", "reflection")]
    rim = inside & (truth.planes["A"] > 0.999)
    return Rebuilt(
        Ball(truth.layer(DIFFUSE), sides[0], rim, rim & reached),
        Ball(truth.layer(REFLECTION), sides[1], rim, rim & told),
        float(told.sum() / inside.sum()),
        rendered.layer(""),
    )


def _ball(probe: Probe, material: str) -> Scene:
    ball = Thing("sphere", material)
    return Scene((ball,), probe, shadows=False, eye=IN_FRONT, half_width=1.0)


class Residuals(NamedTuple):
    """How the diffuse light of a thing that shadows itself was fitted (figure 2).

    Attributes
    ----------
    brightest : how much brighter a pixel is than the fit at most, by the RMS of the shading
    bias, rmse : of the environment, relative to a ball's of which nothing is in shadow, over normals that are told
    """

    brightest: float
    bias: float
    rmse: float


def residuals(quality: Quality, shape: str, probe: Probe, method: str) -> Residuals:
    """Fit the diffuse light of a thing in its own shadow and compare it with that of an open ball."""
    thing = replace(POSES[shape], material="white")
    stored = quality.write(quality.render(Scene((thing,), probe, eye=IN_FRONT)), f"shadowed-{shape}-{probe}.exr")
    sheet = quality.folder / f"shadowed-{shape}-{probe}-{method}.png"
    (environment,) = stored.reconstructed("--size", 64, "--diffuse", method, "--report", sheet).values()
    buffers = stored.read()
    here = buffers.surfaces > 0
    fitted = harmonics.evaluate(buffers.normals[here]) @ environment.diffuse
    shading = buffers.diffuse[here]
    scale = np.sqrt(np.mean(shading**2))
    truth = quality.render(_ball(probe, "white"))
    normals, inside = ball_normals(quality.side_px)
    told = inside & (truth.planes["A"] > 0.999) & _reached(buffers.normals[here], normals)
    ours, wanted = lit_sphere(environment, quality.side_px, "diffuse")[0][told], truth.layer(DIFFUSE)[told]
    bias = float(np.mean(ours - wanted) / np.mean(wanted))
    return Residuals(float(np.max(shading - fitted) / scale), bias, relative_rmse(ours, wanted))


class Edit(NamedTuple):
    """A thing with other normals, shaded again and rendered again. PSNR in dB, linear light, over edited pixels.

    Attributes
    ----------
    ours_db, alone_db, diffuse_only_db : of our picture, of the shading left alone, and with reflections left alone
    noise_db : of one truth by another, that is, what noise allows
    others_kept : every pixel of anything else has its bits
    pictures, reflections : (H, W, 3) as rendered, ours, truth; the whole light, and what is mirrored of it
    where : (H, W), edited pixels
    environment : that was reconstructed
    """

    ours_db: float
    alone_db: float
    diffuse_only_db: float
    noise_db: float
    others_kept: bool
    pictures: tuple[F32, F32, F32]
    reflections: tuple[F32, F32, F32]
    where: Mask
    environment: SurfaceEnvironment

    @property
    def margin_db(self) -> float:
        """How much better ours is than the better of what could be done without reflections."""
        return self.ours_db - max(self.alone_db, self.diffuse_only_db)


BUMPS = {"teapot": (12, 5, 0.03), "vase": (9, 8, 0.04), "sphere": (10, 6, 0.06)}
RED = {
    "teapot": Thing("teapot", "red", turn_deg=-25),
    "vase": Thing("vase", "red"),
    "sphere": Thing("sphere", "red"),
}
FLOORS = {"teapot": -0.61, "vase": -0.99, "sphere": -1.0}


def on_a_floor(shape: str, probe: Probe) -> Scene:
    """Return a scene as of figure 9: one thing of glossy red plastic on a grey floor."""
    return Scene((RED[shape],), probe, floor=FLOORS[shape])


def edit(quality: Quality, scene: Scene, index: int, name: str) -> Edit:
    """Give one thing bumps after rendering, by the commands, and render it with those bumps."""
    thing = scene.things[index]
    bumped_scene = scene.with_bumps(index, BUMPS[thing.shape])
    plain, bumped, truth = quality.render(scene), quality.render(bumped_scene), quality.render(bumped_scene, TRUTH_SEED)
    surface = plain.surface_of(thing)
    stored, other = quality.write(plain, f"{name}.exr"), quality.write(bumped, f"{name}-bumped.exr")
    environments = stored.reconstructed("--size", 256, "--surface", surface)
    ours = stored.recomposed(other.path, surface)
    before, after = stored.read(), other.read()
    where = (before.surfaces == surface) & (after.surfaces == surface)
    turn = np.degrees(np.arccos(np.clip(np.sum(before.normals * after.normals, axis=-1), -1, 1)))
    where &= turn > TURNED_DEG
    closed = replace(before, reflection_occlusion=np.zeros_like(before.reflection_occlusion))
    diffuse_only = recompose(closed, environments, after.normals)
    mirrored_only = recompose(before, environments, after.normals, diffuse_factor=0)
    wanted, alone = truth.layer(""), plain.layer("")
    others = before.surfaces != surface
    return Edit(
        ours_db=psnr_db(ours[where], wanted[where]),
        alone_db=psnr_db(alone[where], wanted[where]),
        diffuse_only_db=psnr_db(diffuse_only[where], wanted[where]),
        noise_db=psnr_db(bumped.layer("")[where], wanted[where]),
        others_kept=bool(np.array_equal(ours[others], alone[others])),
        pictures=(alone, ours, wanted),
        reflections=(plain.layer(REFLECTION), mirrored_only, truth.layer(REFLECTION)),
        where=where,
        environment=environments[surface],
    )


TABLE_TOP = Scene(
    (
        Thing("sphere", "brass", place=(-0.78, -0.4, 0.75), size=0.5),
        Thing("teapot", "red", place=(-0.25, -0.3, -0.75), size=1.0, turn_deg=-15),
        Thing("vase", "white", place=(0.85, 0.0, 0.15), size=0.9),
    ),
    "windows",
    floor=-0.9,
    eye=(0.0, 1.6, 6.6),
    towards=(0.0, -0.15, 0.0),
)
"""Three things that mirror one another, as of figure 11."""


class Neighbours(NamedTuple):
    """How what the other things add to a thing's reflections comes out: correlations with what truly is added.

    Attributes
    ----------
    edited : in the edited picture
    alone : in the picture as rendered, which a picture that is not edited would have
    environment : in the environment, beside a small ball of the same material in the thing's place
    balls : of the environment and that ball, (S, S, 3) each
    """

    edited: float
    alone: float
    environment: float
    balls: tuple[F32, F32]


def neighbours(quality: Quality, scene: Scene, index: int, name: str) -> tuple[Edit, Neighbours]:
    """Edit one thing with the others there, and with the others away."""
    lone = replace(scene, things=(scene.things[index],))
    among, away = edit(quality, scene, index, name), edit(quality, lone, 0, f"{name}-lone")
    where = among.where & away.where
    added = [(one - other)[where] for one, other in zip(among.reflections, away.reflections, strict=True)]
    true_balls = [_ball_in_place(quality, one, i).layer(REFLECTION) for one, i in ((scene, index), (lone, 0))]
    side = quality.side_px
    our_balls = [lit_sphere(one.environment, side, "reflection")[0] for one in (among, away)]
    told = ball_normals(side)[1]
    environment = _correlation((our_balls[0] - our_balls[1])[told], (true_balls[0] - true_balls[1])[told])
    found = Neighbours(
        _correlation(added[1], added[2]), _correlation(added[0], added[2]), environment, (our_balls[0], true_balls[0])
    )
    return among, found


def _ball_in_place(quality: Quality, scene: Scene, index: int) -> Render:
    """Render a small ball in a thing's place, from close by, so that nothing is in between."""
    thing = scene.things[index]
    radius = 0.25 * thing.size
    back = np.array(scene.eye) - np.array(scene.towards)
    eye = np.array(thing.place) + 1.05 * radius * back / np.linalg.norm(back)
    things = list(scene.things)
    things[index] = Thing("sphere", thing.material, place=thing.place, size=radius)
    x, y, z = eye.tolist()
    return quality.render(replace(scene, things=tuple(things), eye=(x, y, z), towards=thing.place, half_width=radius))


def _correlation(one: F32, other: F32) -> float:
    return float(np.corrcoef(one.ravel(), other.ravel())[0, 1])


def relative_rmse(ours: NDArray[np.floating], truth: NDArray[np.floating]) -> float:
    return float(np.sqrt(np.mean((ours - truth) ** 2) / np.mean(truth**2)))


def _mirrored(normals: F64) -> F64:
    mirrored = 2 * normals[..., 2:] * normals - np.array([0.0, 0.0, 1.0])
    length = np.linalg.norm(mirrored, axis=-1, keepdims=True)
    return np.asarray(mirrored / np.where(length > 0, length, 1))


def _reached(seen: F32, normals: F64, within_deg: float = 4.0) -> Mask:
    """Tell to which normals (S, S, 3) one of those seen (N, 3) comes near."""
    from scipy.spatial import cKDTree

    away = cKDTree(seen).query(normals.reshape(-1, 3))[0].reshape(normals.shape[:2])
    return np.asarray(away < 2 * np.sin(np.radians(within_deg) / 2))
