"""Numbers that carry their derivatives by two parameters, so that a surface's formula also yields its tangent plane.

This is forward-mode differentiation: each operation applies the chain rule to exact derivatives. No differences are
taken, and no derivative is written out by hand that could disagree with its formula.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Jet:
    """A value with its two first partial derivatives, arrays of one shape."""

    value: F64
    du: F64
    dv: F64

    def chain(self, value: F64, slope: F64) -> Self:
        """Return f(self) from f's value and slope there."""
        return type(self)(value, slope * self.du, slope * self.dv)

    def __add__(self, other: "Jet | float") -> "Jet":
        if isinstance(other, Jet):
            return Jet(self.value + other.value, self.du + other.du, self.dv + other.dv)
        return Jet(self.value + other, self.du, self.dv)

    def __mul__(self, other: "Jet | float") -> "Jet":
        if isinstance(other, Jet):
            return Jet(
                self.value * other.value,
                self.du * other.value + self.value * other.du,
                self.dv * other.value + self.value * other.dv,
            )
        return Jet(self.value * other, self.du * other, self.dv * other)

    def __neg__(self) -> "Jet":
        return self * -1.0

    def __sub__(self, other: "Jet | float") -> "Jet":
        return self + -other

    def __radd__(self, other: float) -> "Jet":
        return self + other

    def __rsub__(self, other: float) -> "Jet":
        return -self + other

    def __rmul__(self, other: float) -> "Jet":
        return self * other

    def __truediv__(self, other: "Jet | float") -> "Jet":
        return self * (other**-1.0 if isinstance(other, Jet) else 1 / other)

    def __pow__(self, exponent: float) -> "Jet":
        return self.chain(self.value**exponent, exponent * self.value ** (exponent - 1))


def parameters(u: F64, v: F64) -> tuple[Jet, Jet]:
    """Return the two parameters themselves, with derivatives (1, 0) and (0, 1)."""
    one, nought = np.ones_like(u), np.zeros_like(u)
    return Jet(u, one, nought), Jet(v, nought, one)


def sin(x: Jet) -> Jet:
    return x.chain(np.sin(x.value), np.cos(x.value))


def cos(x: Jet) -> Jet:
    return x.chain(np.cos(x.value), -np.sin(x.value))


def tanh(x: Jet) -> Jet:
    value = np.tanh(x.value)
    return x.chain(value, 1 - value**2)


def sqrt(x: Jet) -> Jet:
    """Square root; the argument must stay above 0, where its slope is finite."""
    return x**0.5


def angle(y: Jet, x: Jet) -> Jet:
    """Return atan2(y, x), the angle of a point away from the origin."""
    square = x.value**2 + y.value**2
    return Jet(
        np.arctan2(y.value, x.value),
        (x.value * y.du - y.value * x.du) / square,
        (x.value * y.dv - y.value * x.dv) / square,
    )


def function(x: Jet, value: Callable[[F64], F64], slope: Callable[[F64], F64]) -> Jet:
    """Apply any function whose slope is known."""
    return x.chain(value(x.value), slope(x.value))
