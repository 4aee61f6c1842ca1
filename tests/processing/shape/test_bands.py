import numpy as np
import pytest

from processing.shape.bands import in_bands


@pytest.mark.parametrize("height", [0, 1, 64, 127, 128, 1001])
def test_every_row_is_worked_on_once(height: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 3)
    times = np.zeros(height, int)

    def work(first: int, end: int) -> None:
        times[first:end] += 1

    in_bands(height, work)
    assert np.all(times == 1)


def test_what_goes_wrong_in_a_band_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 2)

    def work(first: int, end: int) -> None:
        if first:
            raise ValueError(f"{end}")

    with pytest.raises(ValueError, match="200"):
        in_bands(200, work)
