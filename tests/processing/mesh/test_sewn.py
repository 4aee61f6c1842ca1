"""The sewn skirt: the surface goes on over its seams, the grain does not."""

import math
from collections import defaultdict

import numpy as np
import pytest

from processing.mesh.model import Mesh
from processing.mesh.sewn import PANELS, YOKE, pattern, skirt


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return skirt(wide=24, tall=100)


def grain_between_deg(first: np.ndarray, second: np.ndarray) -> float:
    """A thread has no head: 0° to 90°."""
    return math.degrees(math.acos(min(1.0, abs(float(first @ second)))))


def test_the_grain_jumps_at_every_seam(mesh: Mesh) -> None:
    """By the pattern's angles where the cloth hangs nearly smooth, by about as much where folds bend it."""
    vertices = defaultdict(list)
    for number, place in enumerate(map(tuple, mesh.positions)):
        vertices[place].append(number)
    between_two = [two for two in vertices.values() if len(two) == 2]
    height = mesh.positions[:, 1]
    # The waist is at the top, and slant is linear in height but for what folds add.
    up = (height - height.min()) / (height.max() - height.min())
    jumps: dict[str, list[float]] = {"yoke": [], "panels": [], "round": []}
    for first, second in between_two:
        jump_deg = grain_between_deg(mesh.tangents[first], mesh.tangents[second])
        where = "yoke" if up[first] > YOKE + 0.03 else "panels" if up[first] < YOKE - 0.03 else "round"
        jumps[where].append(jump_deg)
    assert np.median(jumps["panels"]) == pytest.approx(60, abs=5)
    assert np.median(jumps["yoke"]) == pytest.approx(30, abs=2)
    assert np.median(jumps["round"]) == pytest.approx(45, abs=3)
    assert min(min(found) for found in jumps.values()) > 20, "no place of a seam is averaged over"


def test_where_four_pieces_meet_there_are_four_grains(mesh: Mesh) -> None:
    _, counts = np.unique(mesh.positions, axis=0, return_counts=True)
    assert np.count_nonzero(counts == 4) == PANELS
    assert counts.max() == 4


def test_the_surface_is_smooth_over_the_seams(mesh: Mesh) -> None:
    _, place = np.unique(mesh.positions, axis=0, return_inverse=True)
    order = np.argsort(place.reshape(-1), kind="stable")
    same = np.diff(place.reshape(-1)[order]) == 0
    np.testing.assert_allclose(mesh.normals[order[1:]][same], mesh.normals[order[:-1]][same], atol=1e-6)


def test_pieces_keep_their_lengths_when_they_are_sewn(mesh: Mesh) -> None:
    """Texture coordinates are a sewing pattern, but for what folds take."""
    ends = mesh.triangles[:, [0, 1]]
    sewn = np.linalg.norm(np.diff(mesh.positions[ends], axis=1)[:, 0], axis=1)
    flat = np.linalg.norm(np.diff(mesh.uvs[ends], axis=1)[:, 0], axis=1)
    scale = np.median(sewn / flat)
    assert np.quantile(np.abs(sewn / flat / scale - 1), 0.5) < 0.1


def test_the_pattern_lies_within_the_cloth(mesh: Mesh) -> None:
    assert mesh.uvs.min() > 0 and mesh.uvs.max() < 1


def test_the_pattern_covers_the_skirt_once() -> None:
    pieces = pattern()
    assert sum(piece.high - piece.low for piece in pieces) == pytest.approx(PANELS)
    assert {(piece.panel, piece.low) for piece in pieces} == {(n, low) for n in range(PANELS) for low in (0.0, YOKE)}
