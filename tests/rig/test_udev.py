"""The udev rule that a port needs, and the file that ships."""

from pathlib import Path

import pytest

from rig.udev import INSTALLED, SHIPPED, installing, is_shipped, rule_for


def usb_port(root: Path, name: str, vendor: str, product: str) -> Path:
    """Lay out a USB serial port as the kernel does, and return the mounted root."""
    device = root / "devices/pci0/usb1/1-2"
    (device / "1-2:1.0" / name).mkdir(parents=True)
    (device / "idVendor").write_text(f"{vendor}\n")
    (device / "idProduct").write_text(f"{product}\n")
    (root / "class/tty" / name).mkdir(parents=True)
    (root / "class/tty" / name / "device").symlink_to(device / "1-2:1.0" / name)
    return root


def test_a_usb_adapter_is_matched_by_its_ids(tmp_path: Path) -> None:
    rule = rule_for("/dev/ttyUSB3", usb_port(tmp_path, "ttyUSB3", "0403", "6014"))
    assert rule == (
        'SUBSYSTEM=="tty", ATTRS{idVendor}=="0403", ATTRS{idProduct}=="6014", '
        'MODE="0660", GROUP="dialout", TAG+="uaccess"'
    )
    assert is_shipped(rule)
    assert f"sudo cp {SHIPPED} {INSTALLED}" in installing(rule)


def test_an_adapter_that_the_shipped_file_does_not_know_gets_a_line_of_its_own(tmp_path: Path) -> None:
    rule = rule_for("/dev/ttyACM0", usb_port(tmp_path, "ttyACM0", "dead", "beef"))
    assert not is_shipped(rule)
    assert f"echo '{rule}' | sudo tee -a {INSTALLED}" in installing(rule)


def test_a_port_without_usb_is_matched_by_its_name(tmp_path: Path) -> None:
    assert rule_for("/dev/ttyS0", tmp_path).startswith('SUBSYSTEM=="tty", KERNEL=="ttyS0", MODE="0660"')


def test_a_port_by_id_is_followed_to_its_name(tmp_path: Path) -> None:
    (tmp_path / "ttyUSB0").touch()
    (tmp_path / "by-id").symlink_to(tmp_path / "ttyUSB0")
    assert rule_for(str(tmp_path / "by-id"), tmp_path).split(", ")[1].endswith('ttyUSB0"')


@pytest.mark.parametrize("line", [line for line in SHIPPED.read_text().splitlines() if line.startswith("ATTRS")])
def test_every_adapter_of_the_shipped_file_is_opened_to_its_group_and_to_who_sits_there(line: str) -> None:
    assert 'MODE="0660", GROUP="dialout", TAG+="uaccess"' in line


def test_the_shipped_file_comes_before_the_tag_is_read_and_shortens_the_latency() -> None:
    assert int(SHIPPED.name.split("-")[0]) < 73
    assert 'SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"' in SHIPPED.read_text()
