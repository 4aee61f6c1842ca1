"""Where the nodes of a GLB scene put their meshes.

Done here, for trimesh multiplies the matrices above each node anew, in a time that grows with the cube of their number.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from litrig.base.errors import FormatError

F64 = NDArray[np.float64]
Json = dict[str, Any]

MOST_NODES = 20_000


def flat_nodes(path: Path, nodes: list[Json], roots: list[int]) -> list[Json]:
    """Return a node without children for every mesh that hangs below the roots, with the whole way to it as matrix.

    Raises
    ------
    FormatError
        There are too many nodes, or they are no tree.
    ValueError, TypeError, KeyError, IndexError
        A value is no such thing; for `reduce_header` to tell.
    """
    if len(nodes) > MOST_NODES:
        raise FormatError(f"{path}: has {len(nodes):,} nodes, {MOST_NODES:,} are the most; join them")
    named = [as_index(child) for node in nodes for child in node.get("children", [])] + [as_index(r) for r in roots]
    if len(set(named)) != len(named):
        raise FormatError(f"{path}: its nodes are no tree, one hangs at two places; export it again")
    if any(number >= len(nodes) for number in named):
        raise FormatError(f"{path}: a node names one that is not among its {len(nodes)}; export it again")
    found = []
    # Every node hangs at one place, so that each is met once; a ring hangs at no root.
    open_nodes = [(root, np.eye(4)) for root in roots]
    while open_nodes:
        number, above = open_nodes.pop()
        node = nodes[number]
        with np.errstate(over="ignore", invalid="ignore"):
            placement = above @ _placement(node)
        if not np.all(np.isfinite(placement)):
            raise ValueError(f"node {number} lies nowhere")
        if "mesh" in node:
            found.append({"mesh": as_index(node["mesh"]), "matrix": placement.T.reshape(-1).tolist()})
        open_nodes += [(child, placement) for child in node.get("children", [])]
    return found


def as_index(value: Any) -> int:
    """Return a number that counts something, or raise ValueError."""
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ValueError(f"{str(value)[:20]!r} where a number of something should be")
    return value


def _placement(node: Json) -> F64:
    """Return a node's own matrix, (4, 4), for columns: glTF stores it by columns, or as shift, turn and scale."""
    if "matrix" in node:
        placement = np.array(node["matrix"], np.float64).reshape(4, 4).T
    else:
        placement = np.eye(4)
        turn = Rotation.from_quat(_vector(node, "rotation", [0.0, 0, 0, 1])).as_matrix()
        placement[:3, :3] = turn * _vector(node, "scale", [1.0, 1, 1])
        placement[:3, 3] = _vector(node, "translation", [0.0, 0, 0])
    return placement


def _vector(node: Json, name: str, default: list[float]) -> F64:
    return np.array(node.get(name, default), np.float64).reshape(len(default))
