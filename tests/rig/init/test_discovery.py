"""Who is asked, and in what order."""

from pathlib import Path

import pytest

from rig.fakes import FakeClock
from rig.init import discovery
from rig.init.discovery import FoundController, FoundServos, Silent, ask_port, camera_devices, discover
from tests.rig.doctor.far_ends import FarEnd, Silence, StatePort, bus, controller, servo


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock(100.0)


def plug_in(monkeypatch: pytest.MonkeyPatch, far_end: FarEnd) -> None:
    monkeypatch.setattr(discovery, "open_serial", lambda _, baud: StatePort(far_end, baud))


@pytest.mark.parametrize("baud", [57_600, 1_000_000, 9_600])
def test_servos_are_found_at_their_baud_rate(monkeypatch: pytest.MonkeyPatch, clock: FakeClock, baud: int) -> None:
    plug_in(monkeypatch, bus(clock, servo(clock, 12, baud), servo(clock, 5, baud)))
    assert ask_port("/dev/ttyA", clock) == FoundServos("/dev/ttyA", baud, {5: 1060, 12: 1060})


def test_a_controller_is_found_with_its_settings(monkeypatch: pytest.MonkeyPatch, clock: FakeClock) -> None:
    plug_in(monkeypatch, controller(clock))
    found = ask_port("/dev/ttyA", clock)
    assert isinstance(found, FoundController)
    assert found.settings[130] == 360


def test_a_port_without_anybody_is_told(monkeypatch: pytest.MonkeyPatch, clock: FakeClock) -> None:
    plug_in(monkeypatch, Silence())
    assert ask_port("/dev/ttyA", clock) == Silent(
        "/dev/ttyA", "opens, but neither a servo nor a GRBL controller answers"
    )


def test_paths_that_are_not_there_are_told() -> None:
    found = discover(["/dev/ttyNOWHERE"], ["/dev/video97"])
    assert [silent.path for silent in found.silent] == ["/dev/ttyNOWHERE", "/dev/video97"]
    assert found.silent[0].reason.startswith("no such port")
    assert found.silent[1].reason.startswith("cannot be opened as a camera")


def test_cameras_are_named_so_that_they_survive_replugging(tmp_path: Path) -> None:
    for name in ("video0", "video10", "video2", "vide"):
        (tmp_path / name).touch()
    (tmp_path / "v4l/by-id").mkdir(parents=True)
    (tmp_path / "v4l/by-id/usb-cam-video-index0").symlink_to(tmp_path / "video2")
    assert [Path(path).name for path in camera_devices(tmp_path)] == ["video0", "usb-cam-video-index0", "video10"]
