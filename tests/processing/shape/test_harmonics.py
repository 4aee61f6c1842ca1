import numpy as np

from processing.shape.harmonics import TERMS, evaluate


def test_they_are_orthonormal_over_the_sphere() -> None:
    heights, weights = np.polynomial.legendre.leggauss(12)
    angles = 2 * np.pi * np.arange(24) / 24
    z = heights[:, None]
    flat = np.sqrt(1 - z * z)
    directions = np.stack([flat * np.cos(angles), flat * np.sin(angles), np.broadcast_to(z, (12, 24))], axis=-1)
    values = evaluate(directions)
    gram = np.einsum("h,has,hat->st", weights * 2 * np.pi / 24, values, values)
    np.testing.assert_allclose(gram, np.eye(TERMS), atol=1e-12)


def test_they_stand_in_the_order_of_degree_and_m() -> None:
    """Each is odd or even in x, y and z as its place says."""
    d = np.array([0.48, 0.6, 0.64])
    signs = [evaluate(d * np.array(mirror)) / evaluate(d) for mirror in ((-1, 1, 1), (1, -1, 1), (1, 1, -1))]
    np.testing.assert_allclose(signs[0], [1, 1, 1, -1, -1, 1, 1, -1, 1])
    np.testing.assert_allclose(signs[1], [1, -1, 1, 1, -1, -1, 1, 1, 1])
    np.testing.assert_allclose(signs[2], [1, 1, -1, 1, 1, -1, 1, -1, 1])
