from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.udmx.codec import SLOTS, Transfer, changes, slot_values

values = st.integers(0, 255)
few = st.lists(st.none() | values, min_size=20, max_size=20)
known_slots = few.map(lambda first: [*first, *[None] * (SLOTS - 20)])
wanted_slots = st.dictionaries(st.integers(0, 30) | st.just(SLOTS - 1), values, max_size=20)


@given(known_slots, wanted_slots)
def test_the_transfers_bring_every_slot_where_it_should_be_and_touch_no_other(
    known: Sequence[int | None], wanted: Mapping[int, int]
) -> None:
    after = list(known)
    for transfer in changes(known, wanted):
        for slot, value in zip(transfer.slots, transfer.values, strict=True):
            assert known[slot] != value
            after[slot] = value
    assert after == [wanted.get(slot, value) for slot, value in enumerate(known)]


@given(known_slots, wanted_slots)
def test_lamps_go_dark_before_others_are_lit(known: Sequence[int | None], wanted: Mapping[int, int]) -> None:
    lit = [any(transfer.values) for transfer in changes(known, wanted)]
    assert lit == sorted(lit)


@given(known_slots, wanted_slots)
def test_no_transfer_can_start_the_boot_loader(known: Sequence[int | None], wanted: Mapping[int, int]) -> None:
    for transfer in changes(known, wanted):
        assert transfer.request in (1, 2)
        assert transfer.request == 1 or len(transfer.content) == transfer.value >= 2


def test_neighbours_travel_together() -> None:
    wanted = {3: 0, 4: 255, 9: 7}
    transfers = changes([0] * SLOTS, wanted)
    assert [(t.request, t.value, t.first, t.content) for t in transfers] == [(1, 255, 4, b""), (1, 7, 9, b"")]
    transfers = changes([None] * SLOTS, wanted)
    assert [(t.request, t.value, t.first, t.content) for t in transfers] == [(2, 2, 3, b"\0\xff"), (1, 7, 9, b"")]


@pytest.mark.parametrize(
    ("content", "carried", "refusal"),
    [
        pytest.param(b"\7", 0, "", id="a single value has no data"),
        pytest.param(b"\7", 1, "answers with an error", id="and one byte is an error"),
        pytest.param(b"\7\7", 2, "", id="a range was taken"),
        pytest.param(b"\7\7", 1, "answers with an error", id="a range was refused"),
        pytest.param(bytes(9), 4, "took 4 of 9 bytes", id="a range was cut short"),
    ],
)
def test_a_refusal_is_one_byte_where_none_belongs(content: bytes, carried: int, refusal: str) -> None:
    assert Transfer(0, content).refusal(carried).startswith(refusal)
    assert bool(Transfer(0, content).refusal(carried)) == bool(refusal)


@given(st.floats(0, 1))
def test_sixteen_bits_are_coarse_then_fine(gain: float) -> None:
    coarse, fine = slot_values(gain, sixteen_bit=True)
    assert coarse * 256 + fine == round(gain * 65_535)
    assert slot_values(gain, sixteen_bit=False) == (round(gain * 255),)
