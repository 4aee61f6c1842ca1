"""The libraries that a driver would use, on pseudo-terminals, against the process."""

import time

import dynamixel_sdk
import pytest
import serial

from firmware_sim.errors import SideChannelError
from firmware_sim.launch import RunningSim
from tests.firmware_sim.ports import arm_of, port_of, turntable_of

RX_TIMEOUT, RX_CORRUPT = -3001, -3002


def test_the_sdk_finds_the_servo(sphere: RunningSim) -> None:
    with turntable_of(sphere) as table:
        model, result, error = table.packets.ping(table.port, 1)
        assert (model, result, error) == (1060, 0, 0)
        found, result = table.packets.broadcastPing(table.port)
        assert (list(found), found[1][0], result) == ([1], 1060, 0)


def test_at_another_speed_the_servo_is_silent(sphere: RunningSim) -> None:
    with turntable_of(sphere, baud=115_200) as table:
        assert table.packets.ping(table.port, 1)[1] == RX_TIMEOUT
    with turntable_of(sphere) as table:
        assert table.packets.ping(table.port, 1)[1] == 0


def test_the_table_goes_below_zero(sphere: RunningSim) -> None:
    with turntable_of(sphere) as table:
        table.prepare(speed=260)
        table.go(-500)
        assert table.read4(132) == -500
        assert sphere.side_channel.status()["turntable_deg"] == pytest.approx(-500 * 360 / 4096)


def test_group_reads_work(sphere: RunningSim) -> None:
    with turntable_of(sphere) as table:
        sync = dynamixel_sdk.GroupSyncRead(table.port, table.packets, 132, 4)
        sync.addParam(1)
        expected = table.read4(132) % 2**32
        assert sync.txRxPacket() == 0
        assert sync.getData(1, 132, 4) == expected
        assert sync.fastSyncRead() == 0
        assert sync.getData(1, 132, 4) == expected
        bulk = dynamixel_sdk.GroupBulkRead(table.port, table.packets)
        bulk.addParam(1, 144, 2)
        assert bulk.txRxPacket() == 0
        assert bulk.getData(1, 144, 2) == 120
        assert bulk.fastBulkRead() == 0
        assert bulk.getData(1, 144, 2) == 120


def test_group_writes_work(sphere: RunningSim) -> None:
    with turntable_of(sphere) as table:
        group = dynamixel_sdk.GroupSyncWrite(table.port, table.packets, 65, 1)
        group.addParam(1, [1])
        assert group.txPacket() == 0
        assert table.packets.read1ByteTxRx(table.port, 1, 65)[0] == 1


def test_a_header_within_a_packet_goes_both_ways(sphere: RunningSim) -> None:
    with turntable_of(sphere) as table:
        table.write1(64, 0)
        table.write4(104, -1023)
        table.write4(20, -0x300 - 1 + 0x100)  # FF FD FF FF in the register, behind an FF of the packet
        assert table.read4(20) == -0x201
        table.write4(20, 0)


@pytest.mark.parametrize(
    ("fault", "parameters", "result"),
    [
        pytest.param("mute", {"replies": 1}, RX_TIMEOUT, id="a lost reply is silence"),
        pytest.param("flip_bit", {"bit": 77}, RX_CORRUPT, id="a flipped bit is a wrong checksum"),
        pytest.param("delay", {"seconds": 0.06}, RX_TIMEOUT, id="a late reply is silence at first"),
    ],
)
def test_the_sdk_sees_the_mishap_once(
    sphere: RunningSim, fault: str, parameters: dict[str, float], result: int
) -> None:
    with turntable_of(sphere) as table:
        sphere.side_channel.request(f"turntable.{fault}", **parameters)
        assert table.packets.read2ByteTxRx(table.port, 1, 144)[1] == result
        table.drain()
        assert table.packets.read2ByteTxRx(table.port, 1, 144)[:2] == (120, 0)


def test_the_arm_homes_and_moves(sphere: RunningSim) -> None:
    with arm_of(sphere) as arm:
        arm.home()
        assert arm.ask("G0 X-180 Y-45") == ["ok"]
        assert arm.ask("G4 P0") == ["ok"]
        status = sphere.side_channel.status()
        assert (status["azimuth_deg"], status["elevation_deg"]) == (180, 45)
        arm.port.write(b"?")
        assert arm.port.readline().startswith(b"<Idle|MPos:-180.000,-45.000,-1.000|")


def test_the_time_of_a_stop_on_the_wire_can_be_measured(sphere: RunningSim) -> None:
    with arm_of(sphere) as arm:
        arm.home()
        arm.ask("G1 X-100 F1000")
        sent_s = time.monotonic()
        arm.port.write(b"!")
        while not (heard_s := _times_of(sphere, "21")):
            assert time.monotonic() < sent_s + 5
        assert sent_s <= heard_s[-1] <= time.monotonic()
        arm.port.write(b"\x18")


def _times_of(sim: RunningSim, content: str) -> list[float]:
    recent = sim.side_channel.status()["wires"]["arm"]["recent"]
    return [time_s for time_s, direction, said in recent if direction == "in" and said == content]


def test_a_port_can_be_opened_once_if_one_asks_for_that(sphere: RunningSim) -> None:
    path = port_of(sphere, "arm")
    with serial.Serial(path, 115_200, exclusive=True), pytest.raises(serial.SerialException):
        serial.Serial(path, 115_200, exclusive=True)


@pytest.mark.parametrize(
    ("do", "parameters", "complaint"),
    [
        pytest.param("turntable.explode", {}, "known are .*turntable.mute", id="no such fault"),
        pytest.param("turntable.mute", {"replies": 0}, "replies: .*greater", id="out of range"),
        pytest.param("turntable.mute", {"reply": 1}, "reply: ", id="a misspelt parameter"),
        pytest.param("arm.switches", {"fault": "melted"}, "fault: .*stuck", id="not one of the choices"),
    ],
)
def test_the_side_channel_refuses_what_it_does_not_know(
    sphere: RunningSim, do: str, parameters: dict[str, object], complaint: str
) -> None:
    with pytest.raises(SideChannelError, match=complaint):
        sphere.side_channel.request(do, **parameters)
