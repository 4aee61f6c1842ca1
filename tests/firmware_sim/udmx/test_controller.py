"""The firmware's answers, and what the dimmers hear."""

import itertools

import pytest
import usb.core
import usb.util
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.udmx.controller import Controller, Setup
from firmware_sim.udmx.dimmers import FRAME_S, Dimmers
from tests.rig.udmx.bench import LampBench

OUT, IN = 0x40, 0xC0


@pytest.mark.parametrize("direction", [OUT, IN], ids=["out", "in: the firmware ignores it"])
@pytest.mark.parametrize(
    ("request_", "value", "index", "content", "answer"),
    [
        pytest.param(1, 255, 511, b"", b"", id="last channel, full"),
        pytest.param(1, 256, 0, b"", b"\2", id="a value beyond eight bits"),
        pytest.param(1, 0, 512, b"", b"\1", id="a channel beyond the last"),
        pytest.param(2, 512, 0, bytes(512), b"", id="all of them"),
        pytest.param(2, 512, 1, bytes(512), b"\2", id="a range that leaves the universe"),
        pytest.param(2, 0, 0, b"", b"\2", id="none"),
        pytest.param(2, 3, 512, bytes(3), b"\1", id="a range that begins outside"),
        pytest.param(2, 3, 0, bytes(2), b"\2", id="less data than channels"),
        pytest.param(2, 2, 0, bytes(9), b"", id="more data than channels"),
        pytest.param(77, 2, 0, b"", b"", id="a request that it does not know"),
    ],
)
def test_the_firmware_answers_with_one_byte_where_it_refuses(
    direction: int, request_: int, value: int, index: int, content: bytes, answer: bytes
) -> None:
    controller = Controller(lambda: 0.0)
    assert controller.control(Setup(direction, request_, value, index, len(content)), content, 0.0) == answer


@pytest.mark.parametrize("request_", [0xF8, 0x32])
def test_two_requests_start_the_boot_loader_and_it_is_no_udmx_any_more(request_: int) -> None:
    bench = LampBench()
    lamps = bench.bus.lamps
    bench.bus.control(lamps.address, Setup(OUT, request_, 0, 0, 0), b"", 1.0)
    assert lamps.controller.in_bootloader
    assert lamps.as_status()["product"] == "USBasp"


@given(st.lists(st.tuples(st.integers(0, 511), st.binary(min_size=1, max_size=20), st.floats(0.0, 0.5)), max_size=12))
def test_the_dimmers_have_every_value_two_frames_later(changes: list[tuple[int, bytes, float]]) -> None:
    now_s, wanted = 0.0, bytearray(512)
    dimmers = Dimmers(now_s)
    for first, values, pause_s in changes:
        values = values[: 512 - first]
        now_s += pause_s
        dimmers.set(first, values, now_s)
        wanted[first : first + len(values)] = values
        assert dimmers.slots == wanted
    assert dimmers.slots_at(now_s + 2 * FRAME_S) == wanted


def test_the_dimmers_hear_of_a_change_when_its_frame_has_come_by_and_remember_what_was() -> None:
    dimmers = Dimmers(0.0)
    dimmers.set(511, b"\5", 1.0)
    seen = [dimmers.slots_at(1.0 + part * FRAME_S)[511] for part in (0.0, 2.0)]
    assert seen == [0, 5]
    dimmers.darken(3.0)
    assert [dimmers.slots_at(time_s)[511] for time_s in (2.9, 3.0)] == [5, 0]


def test_the_real_pyusb_reads_descriptors_strings_and_configuration() -> None:
    bench = LampBench()
    found = list(usb.core.find(find_all=True, backend=bench.backend()))
    assert [device.product for device in found] == ["uDMX", "Thermometer"]
    lamps = found[0]
    assert (lamps.manufacturer, lamps.serial_number, lamps.bMaxPacketSize0) == ("www.anyma.ch", None, 8)
    assert (lamps.bus, lamps.port_numbers) == (1, (1,))
    lamps.set_configuration()
    configuration = lamps.get_active_configuration()
    assert (configuration.bConfigurationValue, configuration.bNumInterfaces) == (1, 1)
    assert [interface.bNumEndpoints for interface in configuration] == [0]
    assert list(lamps.ctrl_transfer(IN, 1, 300, 0, 8)) == [2]
    assert lamps.ctrl_transfer(OUT, 1, 300, 0) == 1
    for device in found:
        usb.util.dispose_resources(device)


def test_a_transfer_that_takes_longer_than_the_host_waits_is_a_timeout() -> None:
    bench = LampBench()
    device = usb.core.find(backend=bench.backend(), idVendor=0x16C0)
    with pytest.raises(usb.core.USBTimeoutError) as caught:
        device.ctrl_transfer(OUT, 2, 512, 0, bytes(512), 20)
    assert caught.value.errno == 110
    assert device.ctrl_transfer(OUT, 2, 512, 0, bytes(512), 40) == 512
    usb.util.dispose_resources(device)


@pytest.mark.parametrize(("fault", "errno"), [("drop_out", 19), ("stall", 32), ("unplug", 19)])
def test_what_befalls_the_device_is_what_libusb_would_say(fault: str, errno: int) -> None:
    bench = LampBench()
    device = usb.core.find(backend=bench.backend(), idVendor=0x16C0)
    device.ctrl_transfer(OUT, 1, 9, 0)
    bench.faults[f"lights.{fault}"]()
    with pytest.raises(usb.core.USBError) as caught:
        device.ctrl_transfer(OUT, 1, 9, 0)
    assert caught.value.errno == errno
    usb.util.dispose_resources(device)


def test_a_dome_from_sim_toml_drops_out_and_stalls_by_itself() -> None:
    config = LampBench().config.model_copy(update={"drop_out_every": 5, "stall_every": 3})
    bench = LampBench(config)
    link = bench.link()
    for lamp in itertools.islice(itertools.cycle(range(24)), 50):
        link.show({slot: 255 * (slot == lamp) for slot in range(24)})
        assert bench.slots()[:24] == bytes(255 * (slot == lamp) for slot in range(24))
