"""Packets taken out of what came over the wire, however damaged."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.dynamixel.packets import ErrorCode, build_status
from rig.doctor.servo_wire import PING, READ, Status, build, parse

ANSWER = build_status(1, ErrorCode.NONE, b"\x24\x04\x2d")


def test_an_instruction_is_built_as_the_protocol_says() -> None:
    assert build(1, READ, b"\x84\x00\x04\x00").hex() == "fffffd00010700028400040" + "01d15"


def test_an_answer_is_read() -> None:
    assert parse(ANSWER).statuses == (Status(1, 0, b"\x24\x04\x2d"),)
    assert not parse(ANSWER).is_damaged


def test_stuffed_content_is_read_as_it_was_meant() -> None:
    content = b"\xff\xff\xfd\x01"
    assert parse(build_status(1, ErrorCode.NONE, content)).statuses[0].content == content


def test_the_echo_of_our_own_question_is_no_answer() -> None:
    heard = parse(build(1, PING) + ANSWER)
    assert (len(heard.statuses), heard.is_damaged) == (1, False)


@pytest.mark.parametrize("bit", range(8 * len(ANSWER)))
def test_no_flipped_bit_passes(bit: int) -> None:
    damaged = bytearray(ANSWER)
    damaged[bit // 8] ^= 1 << bit % 8
    heard = parse(bytes(damaged))
    assert not heard.statuses
    assert heard.is_damaged


@pytest.mark.parametrize("cut", range(1, len(ANSWER)))
def test_what_was_cut_off_is_damage_and_the_next_answer_is_found(cut: int) -> None:
    heard = parse(ANSWER[:cut] + ANSWER)
    assert heard.statuses == (Status(1, 0, b"\x24\x04\x2d"),)
    assert heard.is_damaged


@given(st.binary(max_size=60))
def test_noise_ends_and_is_damage(noise: bytes) -> None:
    assert parse(noise).is_damaged or not noise
