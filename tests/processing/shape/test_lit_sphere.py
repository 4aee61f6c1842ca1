import numpy as np

from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.lit_sphere import lit_sphere
from tests.processing.shape.scene import environments


def test_a_ball_shows_the_diffuse_light_at_its_normals_and_the_reflected_at_mirrored_ones() -> None:
    environment = environments(48)[2]
    picture, on_ball = lit_sphere(environment, 33)
    assert on_ball.sum() == np.sum(np.hypot(*np.meshgrid(*[np.linspace(-32 / 33, 32 / 33, 33)] * 2)) <= 1)
    assert not picture[~on_ball].any()
    along = np.linspace(-32 / 33, 32 / 33, 33)
    for row, column in ((16, 16), (5, 20), (30, 12), (16, 1)):
        x, y = along[column], -along[row]
        n = np.array([[x, y, np.sqrt(1 - x * x - y * y)]])
        mirrored = 2 * n[:, 2:] * n - np.array([0, 0, 1])
        expected = harmonics.evaluate(n) @ environment.diffuse + lookup(environment.front, environment.back, mirrored)
        np.testing.assert_allclose(picture[row, column], expected[0], atol=1e-5)


def test_each_part_can_be_shown_alone() -> None:
    environment = environments(16)[7]
    whole, diffuse, reflection = (lit_sphere(environment, 20, part)[0] for part in ("both", "diffuse", "reflection"))
    np.testing.assert_allclose(diffuse + reflection, whole, atol=1e-6)
    assert diffuse.any()
    assert reflection.any()
