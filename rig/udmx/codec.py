"""What goes over USB to a uDMX: two vendor requests, and the fewest of them that bring the slots where they should be.

A *slot* is a DMX channel counted from 0, as the wire has it. A request that starts the boot loader exists too; nothing
here can make one.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

SLOTS = 512
FULL, FULL_16 = 255, 65_535
VENDOR_OUT = 0x40
"""bmRequestType: vendor, to the device."""
REFUSALS = {1: "bad channel", 2: "bad value"}


class Request(IntEnum):
    """bRequest."""

    SET_SINGLE = 1
    SET_RANGE = 2


@dataclass(frozen=True)
class Transfer:
    """One control transfer: the values of some consecutive slots.

    Attributes
    ----------
    first : slot of the first value
    values : 0..255 each
    """

    first: int
    values: bytes

    @property
    def slots(self) -> range:
        """The slots that it sets."""
        return range(self.first, self.first + len(self.values))

    @property
    def request(self) -> Request:
        """A single value goes without a data stage."""
        return Request.SET_SINGLE if len(self.values) == 1 else Request.SET_RANGE

    @property
    def value(self) -> int:
        """wValue: the value itself, or how many there are."""
        return self.values[0] if self.request is Request.SET_SINGLE else len(self.values)

    @property
    def content(self) -> bytes:
        """The data stage."""
        return b"" if self.request is Request.SET_SINGLE else self.values

    def refusal(self, carried: int) -> str:
        """Say what is wrong if the device carried another number of bytes than it should; empty if nothing is.

        A refusal is one byte where none belongs; a range has two bytes at least, and cannot be taken for one.
        """
        if carried == len(self.content):
            return ""
        known = " or ".join(REFUSALS.values())
        return f"answers with an error ({known})" if carried == 1 else f"took {carried} of {len(self.content)} bytes"


def changes(known: Sequence[int | None], wanted: Mapping[int, int]) -> list[Transfer]:
    """Return the transfers that bring what is known to what is wanted; lamps go dark before others are lit.

    Parameters
    ----------
    known : value of each slot, None where nobody knows
    wanted : slot and value; other slots are not ours
    """
    transfers = [Transfer(run[0], bytes(wanted[slot] for slot in run)) for run in _runs(known, wanted)]
    return sorted(transfers, key=lambda transfer: any(transfer.values))


def slot_values(gain: float, *, sixteen_bit: bool) -> tuple[int, ...]:
    """Return the slots' values, coarse before fine, for a share of full power, 0..1."""
    if not sixteen_bit:
        return (round(gain * FULL),)
    return tuple(divmod(round(gain * FULL_16), 256))


def _runs(known: Sequence[int | None], wanted: Mapping[int, int]) -> Iterator[list[int]]:
    run: list[int] = []
    for slot in sorted(wanted):
        if known[slot] == wanted[slot]:
            continue
        if run and slot != run[-1] + 1:
            yield run
            run = []
        run.append(slot)
    if run:
        yield run
