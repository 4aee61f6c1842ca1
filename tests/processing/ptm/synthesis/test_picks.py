"""Whatever the search, the blocks are those of brute force; `make oracle` asks more often."""

import pytest

from tests.processing.ptm.synthesis.picks import CASES, Case, agreement


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("case", CASES, ids=str)
def test_both_searches_choose_what_brute_force_chooses(case: Case, seed: int) -> None:
    found = agreement(case, ("fft", "svd"), seed)
    assert {search: one.different for search, one in found.items()} == {"fft": 0, "svd": 0}
    assert found["fft"].blocks >= 9
