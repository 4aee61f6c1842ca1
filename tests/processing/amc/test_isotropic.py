import numpy as np
import pytest

from processing.amc.isotropic import isotropic_matcap
from processing.amc.model import Amc


def test_the_isotropic_matcap_is_the_mean_of_the_slices_in_light() -> None:
    slices = np.zeros((4, 2, 2, 3), np.float32)
    slices[:, 0, 1] = np.array([0.0, 0.1, 0.3, 0.8])[:, None]
    matcap = isotropic_matcap(Amc(slices, np.ones((4, 2, 2), bool), 1))
    assert matcap.shape == (2, 2, 3)
    assert matcap[0, 1] == pytest.approx(0.3)
    assert matcap[1, 0] == pytest.approx(0)
