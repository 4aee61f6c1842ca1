"""Coefficients in a basis where the distance of two vectors is the distance of two reflectance functions.

In the coefficients of u², v², uv, u, v, 1 it is not: these functions are not orthogonal. The paper changes to Legendre
polynomials, orthonormal over the square [−1, 1]² of (u, v) (Synthesis and Rendering of 3D Textures, section VI). Lights
are on the unit disc alone, and a basis that is orthonormal there is offered too.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import Basis

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Domain = Literal["square", "disc", "hemisphere"]

DOMAINS: dict[str, tuple[Domain, ...]] = {"ptm": ("square", "disc"), "hsh": ("hemisphere", "disc")}
"""Over what the functions of a kind of basis can be compared, the usual first."""
_NODES = 4
_LEGENDRE_ORDER = {6: (5, 3, 4, 2, 0, 1), 3: (2, 0, 1)}
"""The paper's B is what Gram and Schmidt make of 1, u, v, uv, u², v², in this order."""


@dataclass(frozen=True)
class Orthonormal:
    """A change of basis.

    Attributes
    ----------
    matrix : (T, T), the paper's M: b = M·a
    inverse : (T, T), a = M⁻¹·b
    measure : the squared norm of the function that is 1 everywhere
    """

    matrix: F64
    inverse: F64
    measure: float

    def forward(self, coefficients: F32) -> F32:
        """Change coefficients (T, ...) to the orthonormal basis."""
        return np.tensordot(self.matrix.astype(np.float32), coefficients, axes=1)

    def back(self, coefficients: F32) -> F32:
        """Change coefficients (T, ...) back."""
        return np.tensordot(self.inverse.astype(np.float32), coefficients, axes=1)


def orthonormal(basis: Basis, domain: Domain) -> Orthonormal:
    """Make the change of basis.

    Parameters
    ----------
    domain : "square", integrals over [−1, 1]², as the paper has it; "disc", means over the unit disc of (u, v);
        "hemisphere", integrals over solid angle, where harmonics are orthonormal already

    Raises
    ------
    ValueError
        The functions of the basis are not compared over such a domain: harmonics do not reach the square's corners.
    """
    if domain not in DOMAINS[basis.kind]:
        raise ValueError(f"{basis} is compared over {' or '.join(DOMAINS[basis.kind])}, not {domain}")
    if domain == "hemisphere":
        identity = np.eye(basis.terms)
        return Orthonormal(identity, identity, 2 * np.pi)
    order = _LEGENDRE_ORDER[basis.terms] if basis.kind == "ptm" else tuple(range(basis.terms))
    gram = square_gram(basis) if domain == "square" else basis.gram
    # With G = L·Lᵀ the functions e = L⁻¹·f are orthonormal, and a·f = (Lᵀ·a)·e.
    matrix: F64 = np.linalg.cholesky(gram[np.ix_(order, order)]).T @ np.eye(basis.terms)[list(order)]
    return Orthonormal(matrix, np.asarray(np.linalg.inv(matrix), np.float64), 4.0 if domain == "square" else 1.0)


def check_domain(basis: Basis, wanted: Domain | None, name: str) -> Domain:
    """Return the domain that is wanted, or the usual one.

    Raises
    ------
    InputError
        The functions of the material's basis are not compared over it.
    """
    possible = DOMAINS[basis.kind]
    if wanted is not None and wanted not in possible:
        raise InputError(f"{name}: a {basis} is compared over {' or '.join(possible)}, not {wanted}; choose --over so")
    return wanted or possible[0]


def square_gram(basis: Basis) -> F64:
    """Integrate the products (T, T) of a polynomial basis's terms over [−1, 1]²."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    u, v = np.meshgrid(nodes, nodes)
    values = basis.evaluate(np.stack([u, v], axis=-1))
    return np.asarray(np.einsum("ij,ijs,ijt->st", np.outer(weights, weights), values, values), np.float64)
