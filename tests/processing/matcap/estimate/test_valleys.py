import numpy as np

from processing.matcap.estimate.valleys import between_valleys


def test_a_feature_ends_where_the_profile_is_lowest_before_it_rises_again() -> None:
    profile = np.array([[0.5, 0.1, 0.3, 1.0, 0.4, 0.2, 0.6, 0.0]])
    left, right = between_valleys(profile, np.array([3]))
    assert (left[0], right[0]) == (1, 5)


def test_without_another_feature_it_ends_with_the_profile() -> None:
    profile = np.array([[0.0, 0.2, 1.0, 0.3, 0.0]])
    left, right = between_valleys(profile, np.array([2]))
    assert (left[0], right[0]) == (0, 4)


def test_small_rises_are_noise() -> None:
    profile = np.array([[1.0, 0.5, 0.52, 0.2, 0.24, 0.0]])
    assert between_valleys(profile, np.array([0]))[1][0] == 5
