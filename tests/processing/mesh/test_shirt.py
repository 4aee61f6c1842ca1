"""The shirt: one surface with four openings, whose grain breaks where sleeves are set in."""

import math
from collections import defaultdict

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from processing.mesh.model import Mesh
from processing.mesh.rows import unique_rows
from processing.mesh.shirt import ARM_DEG, ARMPIT, shirt


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return shirt()


def piece_of(mesh: Mesh) -> np.ndarray:
    """Front 0, back 1, right sleeve 2, left sleeve 3: each vertex by its quarter of the cloth."""
    return np.asarray(2 * (mesh.uvs[:, 0] > 0.5) + (mesh.uvs[:, 1] > 0.5))


def test_hem_neck_and_cuffs_are_its_only_edges(mesh: Mesh) -> None:
    places, numbers = unique_rows(mesh.positions)
    corners = numbers[mesh.triangles]
    edges, counts = np.unique(
        np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1),
        axis=0,
        return_counts=True,
    )
    assert set(counts) == {1, 2}
    rim = edges[counts == 1]
    links = coo_array((np.ones(len(rim)), rim.T), shape=(len(places), len(places)))
    _, loops = connected_components(links, directed=False)
    assert len(np.unique(loops[rim[:, 0]])) == 4
    assert np.all(np.bincount(rim.reshape(-1))[np.unique(rim)] == 2), "each of them a plain loop"


def test_outside_is_where_the_normals_are(mesh: Mesh) -> None:
    """Front and back look away from each other, and a triangle runs as its normals say."""
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.mean(np.sum(across * mesh.normals[mesh.triangles].sum(axis=1), axis=1) > 0) > 0.999
    piece = piece_of(mesh)
    assert np.mean(mesh.normals[piece == 0, 2] > 0) > 0.95
    assert np.mean(mesh.normals[piece == 1, 2] < 0) > 0.95


def test_the_grain_runs_up_the_body_and_up_the_sleeves(mesh: Mesh) -> None:
    piece, down = piece_of(mesh), math.radians(ARM_DEG)
    for number, upwards in enumerate(
        [[0, 1, 0], [0, 1, 0], [-math.cos(down), math.sin(down), 0], [math.cos(down), math.sin(down), 0]]
    ):
        assert np.median(mesh.tangents[piece == number] @ np.array(upwards)) > 0.95


def test_the_grain_jumps_where_sleeves_are_set_in_and_not_at_the_sides(mesh: Mesh) -> None:
    """At the shoulder front and back meet head to head: threads have no head, and are cut alike."""
    piece = piece_of(mesh)
    at = defaultdict(list)
    for vertex, place in enumerate(map(tuple, mesh.positions)):
        at[place].append(vertex)
    jumps = defaultdict(list)
    for vertices in at.values():
        if len(vertices) == 2:
            one, other = sorted(vertices, key=lambda vertex: piece[vertex])
            np.testing.assert_allclose(mesh.normals[one], mesh.normals[other], atol=1e-6)
            cosine = min(1.0, abs(float(mesh.tangents[one] @ mesh.tangents[other])))
            sleeves = int(piece[one] >= 2) + int(piece[other] >= 2)
            where = ("body", "armhole", "sleeve")[sleeves]
            jumps[where].append(math.degrees(math.acos(cosine)))
    assert len(jumps["armhole"]) > 4 * (1 - ARMPIT) * 96 * 0.9
    assert np.median(jumps["armhole"]) == pytest.approx(90 - ARM_DEG, abs=8)
    assert np.quantile(jumps["armhole"], 0.1) > 20
    assert np.median(jumps["body"]) < 1
    assert np.median(jumps["sleeve"]) < 1


def test_the_pattern_lies_within_the_cloth_and_is_not_mirrored(mesh: Mesh) -> None:
    assert mesh.uvs.min() > 0 and mesh.uvs.max() < 1
    corners = mesh.uvs.astype(np.float64)[mesh.triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    assert np.mean(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0) > 0.99
