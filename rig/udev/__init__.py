"""Who may open a port: the udev rules that ship, and the one that a given port needs."""

import os
from pathlib import Path

SHIPPED = Path(__file__).with_name("70-litrig.rules")
INSTALLED = "/etc/udev/rules.d/70-litrig.rules"
RELOAD = "sudo udevadm control --reload && sudo udevadm trigger"
GRANT = 'MODE="0660", GROUP="dialout", TAG+="uaccess"'


def rule_for(port: str, sys_root: Path = Path("/sys")) -> str:
    """Write the udev rule that opens a serial port to its group: by the adapter's USB ids, else by the port's name.

    Parameters
    ----------
    port : device path, which may be a link
    sys_root : where the kernel's view of the devices is mounted
    """
    name = os.path.realpath(port).removeprefix("/dev/")
    ids = _usb_ids(sys_root / "class/tty" / name / "device")
    if ids is None:
        return f'SUBSYSTEM=="tty", KERNEL=="{name}", {GRANT}'
    return f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="{ids[0]}", ATTRS{{idProduct}}=="{ids[1]}", {GRANT}'


def is_shipped(rule: str) -> bool:
    """Tell whether the file that ships covers what a rule matches."""
    matches = [part for part in rule.split(", ") if part.startswith("ATTRS")]
    lines = [line.split(", ") for line in SHIPPED.read_text("utf-8").splitlines() if line.startswith("ATTRS")]
    return bool(matches) and any(all(part in matches for part in line if part.startswith("ATTRS{")) for line in lines)


def installing(rule: str) -> str:
    """Say how to put a rule where udev finds it."""
    how = f"sudo cp {SHIPPED} {INSTALLED}" if is_shipped(rule) else f"echo '{rule}' | sudo tee -a {INSTALLED}"
    return f"its udev rule is: {rule} (install it: {how} && {RELOAD}; and sudo usermod -aG dialout $USER)"


def _usb_ids(device: Path) -> tuple[str, str] | None:
    """Climb from a port to the USB device that it belongs to."""
    place = device.resolve()
    for folder in (place, *place.parents):
        try:
            return (folder / "idVendor").read_text().strip(), (folder / "idProduct").read_text().strip()
        except OSError:
            continue
    return None
