"""The driver's link on the simulated bus: what is sent, what is not, and what happens when the device is not there."""

from pathlib import Path

import pytest
import usb.core

from firmware_sim.udmx.config import DomeSim
from litrig.base.errors import ConfigError
from rig.errors import DeviceError, LinkTimeoutError, PortError
from rig.udmx.backend import load_backend
from rig.udmx.codec import SLOTS
from rig.wire_record import read_record, recording
from tests.rig.udmx.bench import LampBench

DARK = dict.fromkeys(range(24), 0)


@pytest.fixture
def bench() -> LampBench:
    return LampBench()


def test_only_what_changed_is_sent(bench: LampBench) -> None:
    link = bench.link()
    link.show({**DARK, 5: 200})
    assert bench.slots()[:24] == bytes(5) + b"\xc8" + bytes(18)
    link.show({**DARK, 5: 200})
    link.show({**DARK, 9: 100})
    link.show(DARK)
    assert bench.heard() == [
        (2, 24, 0, (bytes(5) + b"\xc8" + bytes(18)).hex()),
        (1, 0, 5, ""),
        (1, 100, 9, ""),
        (1, 0, 9, ""),
    ]


def test_a_wire_record_has_what_is_sent(bench: LampBench, tmp_path: Path) -> None:
    with recording(tmp_path / "wires.jsonl"):
        link = bench.link()
        link.show({0: 0, 1: 7})
        link.show({0: 0, 1: 255})
    sent = [entry["bytes"] for entry in read_record(tmp_path / "wires.jsonl") if entry["way"] == "out"]
    assert sent == [b"\x40\x02\x02\0\0\0\x02\0\0\x07", b"\x40\x01\xff\0\x01\0\0\0"]


def test_512_slots_take_35_ms_and_one_takes_one(bench: LampBench) -> None:
    link = bench.link()
    before_s = bench.clock.now_s()
    link.show(dict.fromkeys(range(SLOTS), 1))
    assert bench.clock.now_s() - before_s == pytest.approx(0.035)
    link.show({**dict.fromkeys(range(SLOTS), 1), 100: 2})
    assert bench.clock.now_s() - before_s == pytest.approx(0.036)


@pytest.mark.parametrize("forgets", [True, False], ids=["dark when it is back", "half lit when it is back"])
@pytest.mark.parametrize("after", [0, 1, 2])
def test_a_device_that_drops_off_the_bus_is_waited_for_and_told_everything_again(
    bench: LampBench, after: int, forgets: bool
) -> None:
    link = bench.link()
    link.show({**DARK, 3: 255, 11: 9})
    bench.faults["lights.drop_out"](seconds=1.0, after=after, forgets=forgets)
    link.show({**DARK, 4: 255, 20: 7})
    link.show({**DARK, 7: 255})
    assert bench.slots()[:24] == bytes(7) + b"\xff" + bytes(16)


def test_drop_outs_in_a_row_are_given_up_after_three_tries(bench: LampBench) -> None:
    link = bench.link()
    bench.faults["lights.drop_out"](seconds=0.2, transfers=3)
    with pytest.raises(LinkTimeoutError, match=r"took no values in 3 tries .*check its cable"):
        link.show(DARK)
    link.show({**DARK, 1: 1})
    assert bench.slots()[:3] == b"\0\1\0"


def test_a_device_that_stays_away_is_an_error_after_a_while(bench: LampBench) -> None:
    link = bench.link()
    bench.faults["lights.unplug"]()
    assert usb.core.find(backend=bench.backend(), idVendor=0x16C0, custom_match=lambda d: d.product == "uDMX") is None
    before_s = bench.clock.now_s()
    with pytest.raises(PortError, match=r"not on the USB bus, only 'Thermometer' on 1-2; .* waited for 5 s"):
        link.show(DARK)
    assert 4.9 < bench.clock.now_s() - before_s < 6
    bench.faults["lights.unplug"](on=False)
    link.show({**DARK, 2: 5})
    assert bench.slots()[2] == 5


def test_a_stall_is_tried_again_on_the_same_device(bench: LampBench) -> None:
    link = bench.link()
    bench.faults["lights.stall"](transfers=2)
    link.show({**DARK, 2: 5})
    assert bench.slots()[2] == 5
    bench.faults["lights.stall"](transfers=3)
    with pytest.raises(LinkTimeoutError, match="3 tries"):
        link.show({**DARK, 3: 5})


@pytest.mark.parametrize("code", [1, 2])
@pytest.mark.parametrize("first", [DARK, {3: 255}], ids=["a range", "a single value"])
def test_an_error_byte_is_an_error_and_the_slots_are_sent_again_next_time(
    bench: LampBench, code: int, first: dict[int, int]
) -> None:
    link = bench.link()
    bench.faults["lights.refuse"](code=code)
    with pytest.raises(DeviceError, match=r"answers with an error .*channels "):
        link.show(first)
    link.show(first)
    assert bench.slots()[3] == first.get(3)


def test_the_product_string_tells_it_from_others_with_the_same_numbers() -> None:
    with pytest.raises(PortError, match="not on the USB bus, only 'Blinker' on 1-1; 'Thermometer' on 1-2"):
        LampBench(DomeSim(product="Blinker")).link()
    bench = LampBench(DomeSim(product="Blinker", neighbour="udmx"))
    bench.link(None).show({0: 9})
    assert not any(bench.slots())
    assert bench.bus.devices[1].controller.dimmers.slots[0] == 9


def test_of_two_the_one_that_rig_toml_names_is_used() -> None:
    bench = LampBench(DomeSim(neighbour="udmx"))
    with pytest.raises(PortError, match="2 are plugged in, on 1-1, 1-2; name one by port"):
        bench.link(None)
    bench.link("1-1").show({0: 9})
    assert bench.slots()[0] == 9
    with pytest.raises(PortError, match="on USB socket 1-4: not on the USB bus, only 'uDMX' on 1-1"):
        bench.link("1-4")


def test_a_second_program_cannot_open_it_before_the_first_has_ended(bench: LampBench) -> None:
    first = bench.link()
    with pytest.raises(PortError, match="held by another program; end it"):
        bench.link()
    first.close()
    first.close()
    bench.link()


def test_a_device_that_may_not_be_asked_is_told_with_the_udev_rule(
    bench: LampBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    backend = bench.backend()

    def refuse(*_: object) -> int:
        raise usb.core.USBError("Access denied", None, 13)

    monkeypatch.setattr(backend, "open_device", refuse)
    monkeypatch.setattr(bench, "backend", lambda: backend)
    with pytest.raises(PortError, match=r"permission denied; a udev rule .*16c0.*05dc"):
        bench.link()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        pytest.param("nowhere_at_all:connect", "cannot be loaded .No module named", id="no module"),
        pytest.param("firmware_sim.udmx.backend:disconnect", "cannot be loaded", id="no function"),
        pytest.param("pathlib:Path", "gives no backend of pyusb", id="something else"),
    ],
)
def test_a_backend_that_is_none_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        load_backend(name, "x")
    assert load_backend(None, "") is None
