import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.dynamixel.packets import Instruction, PacketReader, build, crc16, stuff, unstuff

READ_POSITION = bytes.fromhex("FF FF FD 00 01 07 00 02 84 00 04 00 1D 15")


def test_the_crc_is_that_of_the_published_example() -> None:
    assert crc16(READ_POSITION[:-2]) == 0x151D


def test_an_instruction_is_built_as_published() -> None:
    assert build(1, Instruction.READ, bytes.fromhex("84 00 04 00")) == READ_POSITION


def test_a_header_in_the_parameters_is_stuffed() -> None:
    packet = build(1, Instruction.WRITE, bytes.fromhex("74 00 FF FF FD FF"))
    assert bytes.fromhex("FF FF FD FD FF") in packet
    assert packet[5:7] == bytes.fromhex("0A 00")
    (read,) = PacketReader().feed(packet)
    assert read.parameters == bytes.fromhex("74 00 FF FF FD FF")


@given(st.binary(max_size=60))
def test_stuffing_comes_undone(content: bytes) -> None:
    assert unstuff(stuff(content)) == content
    assert b"\xff\xff\xfd\x00" not in stuff(content)


@given(st.lists(st.binary(min_size=1, max_size=12), min_size=1, max_size=4), st.data())
def test_packets_survive_any_portions_of_the_stream(contents: list[bytes], data: st.DataObject) -> None:
    stream = b"".join(build(1, Instruction.WRITE, content) for content in contents)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=5)))
    reader = PacketReader()
    found = [
        packet
        for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True)
        for packet in reader.feed(stream[start:end])
    ]
    assert [packet.parameters for packet in found] == contents
    assert all(packet.intact for packet in found)


@given(st.integers(0, 8 * len(READ_POSITION) - 1))
def test_no_flipped_bit_goes_unnoticed(bit: int) -> None:
    damaged = bytearray(READ_POSITION)
    damaged[bit // 8] ^= 1 << bit % 8
    assert not any(packet.intact for packet in PacketReader().feed(bytes(damaged)))


@pytest.mark.parametrize(
    "noise",
    [
        pytest.param(b"\x00\x12\xff", id="bytes from nowhere"),
        pytest.param(b"\xff\xff\xff", id="a header that begins too early"),
        pytest.param(b"\xff\xff\xfd\x00\x01\xff\xff\x03", id="a header with an impossible length"),
    ],
)
def test_noise_before_a_packet_is_passed_over(noise: bytes) -> None:
    (packet,) = PacketReader().feed(noise + READ_POSITION)
    assert packet.intact
