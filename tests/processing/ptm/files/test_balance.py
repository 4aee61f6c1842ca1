import numpy as np
import pytest

from processing.ptm.basis import PTM
from processing.ptm.files.balance import Balance, choose_balance
from processing.ptm.model import Strip


def pixels(count: int = 2000, darkest: float = 0.002) -> Strip:
    """LRGB pixels from all but black to white."""
    random = np.random.default_rng(5)
    level = np.geomspace(darkest, 1, count)
    shape = random.uniform(-0.4, 0.4, (6, count))
    shape[5] = 0.6
    colour = random.uniform(0.1, 1, (1, count, 3))
    return Strip((shape * level)[:, None, :, None].astype(np.float32), colour.astype(np.float32))


def relative_error(balance: Balance, strip: Strip) -> float:
    stored = balance.decode(*balance.encode(strip))
    assert stored.colour is not None
    assert strip.colour is not None
    product = strip.coefficients * strip.colour
    return float(np.sqrt(np.mean((stored.coefficients * stored.colour - product) ** 2) / np.mean(product**2)))


def test_the_product_survives_eight_bits_of_each() -> None:
    strip = pixels()
    assert relative_error(choose_balance(strip, PTM.gram), strip) < 0.01


def test_colour_reaches_its_last_code_and_no_more() -> None:
    strip = pixels()
    _, colour = choose_balance(strip, PTM.gram).encode(strip)
    assert colour.max() == 255


def test_black_pixels_stay_black() -> None:
    strip = pixels(50)
    strip.coefficients[:, :, :9] = 0
    balance = choose_balance(strip, PTM.gram)
    stored = balance.decode(*balance.encode(strip))
    assert stored.coefficients[:, :, :9] == pytest.approx(0)
    assert np.isfinite(stored.coefficients).all()


def test_luminance_is_the_best_for_the_rounded_colour() -> None:
    """A dim colour has coarse codes; luminance that did not know them would be off by their error."""
    strip = pixels(400)
    balance = choose_balance(strip, PTM.gram)
    luminance, codes = balance.encode(strip)
    stored = balance.decode(luminance, codes)
    assert stored.colour is not None
    assert strip.colour is not None
    wanted = strip.coefficients * strip.colour
    lost = np.sum((stored.coefficients * stored.colour - wanted) ** 2, axis=(0, 1, 3))
    for change in (0.97, 1.03):
        other = np.sum((stored.coefficients * np.float32(change) * stored.colour - wanted) ** 2, axis=(0, 1, 3))
        assert other[200:].sum() > lost[200:].sum()
