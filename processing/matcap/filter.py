"""What a material's filter size says about its slope (the MatCap paper, section 3.1)."""

MATT_FILTER_SIZE = 0.467401
"""π²/4 − 2: the variance, in radians squared, of a clamped cosine, which is how a matt material blurs light."""


def slope_of(filter_size: float) -> float:
    """Return the slope μ(ν) = 1 − 0.3 ν − 1.1 ν² that goes with a filter size, held within 0 and 1.

    Beyond ν = 0.827 the polynomial is negative, which no material is.

    Parameters
    ----------
    filter_size : ν in radians squared, not negative
    """
    return min(max(1 - 0.3 * filter_size - 1.1 * filter_size**2, 0.0), 1.0)
