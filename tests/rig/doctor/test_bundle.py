"""The archive for a bug report has what is needed, and nothing private."""

import json
import tomllib
import zipfile
from pathlib import Path

import pytest

from litrig.base.errors import InputError
from rig.config import RigConfig, read_rig
from rig.doctor.bundle import write_bundle
from rig.doctor.privacy import HIDDEN, Mask

PRIVATE = ("annabel", "lovelace", "workshop-7", "FT4TFKGR", "9F8E7D6C", "hunter2hunter2", "s3cr3tvalue", "example.org")
ENVIRONMENT = {
    "HOME": "/home/annabel",
    "USER": "annabel",
    "HOSTNAME": "workshop-7",
    "FULLNAME": "Annabel Lovelace",
    "MY_TOKEN": "hunter2hunter2",
    "UPLOAD_API_KEY": "s3cr3tvalue",
}
PORT = "/dev/serial/by-id/usb-FTDI_USB__-__Serial_Converter_FT4TFKGR-if00-port0"
CAMERA = "/dev/v4l/by-id/usb-046d_HD_Pro_Webcam_C920_9F8E7D6C-video-index0"


def mask() -> Mask:
    return Mask.of_this_machine(ENVIRONMENT)


@pytest.mark.parametrize(
    ("text", "hidden"),
    [
        ("/home/annabel/rigs/rig.toml", "~/rigs/rig.toml"),
        ("/home/annabella/rig.toml", f"/home/{HIDDEN}/rig.toml"),
        ("cannot open /home/annabel: no", "cannot open ~: no"),
        ("/media/annabel/disk", f"/media/{HIDDEN}/disk"),
        ("/tmp/pytest-of-annabel/x", f"/tmp/pytest-of-{HIDDEN}/x"),
        ("Annabel's rig on WORKSHOP-7", f"{HIDDEN}'s rig on {HIDDEN}"),
        (PORT, f"/dev/serial/by-id/usb-FTDI_USB__-__Serial_Converter_{HIDDEN}-if00-port0"),
        (CAMERA, f"/dev/v4l/by-id/usb-046d_HD_Pro_Webcam_C920_{HIDDEN}-video-index0"),
        ("/dev/serial/by-id/usb-1a86_X_9F8E7D6C-if00: gone", f"/dev/serial/by-id/usb-1a86_X_{HIDDEN}-if00: gone"),
        ("serial number: 9F8E7D6C", f"serial number: {HIDDEN}"),
        ("password=abc", f"password={HIDDEN}"),
        ("Authorization: Bearer abcdefgh12345", f"Authorization: Bearer {HIDDEN}"),
        ("used hunter2hunter2 here", f"used {HIDDEN} here"),
        ("ftp://ada:pw@host/x", f"ftp://{HIDDEN}@host/x"),
        ("ada@example.org", HIDDEN),
        ("at 192.168.1.17 and 00:1a:2b:3c:4d:5e", f"at {HIDDEN} and {HIDDEN}"),
        ("[VER:1.1h.20190830:annas arm]", f"[VER:1.1h.20190830:{HIDDEN}]"),
        ("[MSG:Mode=STA:SSID=AnnasNet:IP=x]", f"[MSG:Mode=STA:SSID={HIDDEN}:IP={HIDDEN}]"),
    ],
)  # fmt: skip
def test_what_is_private_is_hidden(text: str, hidden: str) -> None:
    assert mask().text(text) == hidden


@pytest.mark.parametrize(
    "text",
    [
        "servo 1 at 57600 baud is a XL430-W250",
        "no servo answers on /dev/ttyUSB0 at 57600, 1000000 baud",
        "<Idle|MPos:-60.000,-35.000,0.000|Bf:15,128|WCO:0.000,0.000,0.000>",
        "GRBL 1.1h.20190830",
        "/dev/pts/3: held by another program (process 17, minicom)",
        "/usr/lib/python3",
        "homed at home",
    ],
)
def test_what_is_needed_stays(text: str) -> None:
    assert mask().text(text) == text


def test_names_that_everybody_has_are_no_secret() -> None:
    hide = Mask.of_this_machine({"USER": "root", "HOME": "/root"})
    assert hide.text("root cause") == "root cause"
    assert hide.text("/root/rig.toml") == "~/rig.toml"


def test_servo_bytes_pass_unchanged() -> None:
    content = bytes(range(256)) * 2
    assert mask().bytes(content) == content


def test_a_bundle_has_everything_and_nothing_private(tmp_path: Path) -> None:
    config = RigConfig.model_validate(
        {"rig": {"name": "Annabel Lovelace's"}, "turntable": {"port": PORT}, "camera": {"device": CAMERA}}
    )
    report = {"rig": "Annabel Lovelace's", "findings": [{"what": f"{PORT}: held by annabel on workshop-7"}]}
    wires = [
        {"t": 1.0, "port": PORT, "way": "open", "bytes": b"", "baud": 57600},
        {"t": 1.1, "port": PORT, "way": "out", "bytes": b"$I\n"},
        {"t": 1.2, "port": PORT, "way": "in", "bytes": b"[VER:1.1h.20190830:anna"},
        {"t": 1.3, "port": PORT, "way": "in", "bytes": b"bel]\r\nok\r\n"},
        {"t": 1.4, "port": PORT, "way": "out", "bytes": b"\xff\xff\xfd\x00\x01"},
    ]
    write_bundle(tmp_path / "b.zip", config, report, wires, wires, mask())
    with zipfile.ZipFile(tmp_path / "b.zip") as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    assert set(files) == {"README.txt", "versions.json", "rig.toml", "doctor.json", "wires.jsonl", "session.jsonl"}
    said = b"".join(bytes.fromhex(json.loads(line).get("bytes", "")) for line in files["wires.jsonl"].splitlines())
    for text in (*files.values(), said.decode("latin-1")):
        for private in PRIVATE:
            assert private.lower() not in text.lower()
    assert said == f"$I\n[VER:1.1h.20190830:{HIDDEN}]\r\nok\r\n".encode() + b"\xff\xff\xfd\x00\x01"
    assert {"litrig", "python", "kernel", "libraries"} <= set(json.loads(files["versions.json"]))
    assert "(" not in json.loads(files["versions.json"])["libraries"]["pyserial"]
    assert tomllib.loads(files["rig.toml"])["turntable"]["baud"] == 57600
    (tmp_path / "rig.toml").write_text(files["rig.toml"])
    assert read_rig(tmp_path / "rig.toml").camera is not None


def test_a_bundle_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        write_bundle(tmp_path / "no" / "b.zip", RigConfig(), {}, [])
    assert not list(tmp_path.iterdir())
