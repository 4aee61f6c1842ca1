"""The lock on a rig: one holder, named, and none left over."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rig.config import RigConfig
from rig.errors import PortError
from rig.rig_lock import RigLock, lock_rig, ports_of

HOLD = "import sys; from pathlib import Path; from rig.rig_lock import RigLock;"
HOLD += "lock = RigLock(['/dev/ttyA'], Path(sys.argv[1])); print('held', flush=True); sys.stdin.read()"


def test_the_second_is_refused_and_told_who_is_first(tmp_path: Path) -> None:
    first = RigLock(["/dev/ttyA", "/dev/ttyB"], tmp_path)
    with pytest.raises(PortError, match=rf"rig on /dev/ttyB, /dev/ttyA: in use by litrig, process {os.getpid()};"):
        RigLock(["/dev/ttyB", "/dev/ttyA"], tmp_path)
    first.release()
    RigLock(["/dev/ttyB", "/dev/ttyA"], tmp_path).release()


def test_a_port_by_another_name_is_the_same_port(tmp_path: Path) -> None:
    (tmp_path / "by-id").symlink_to("/dev/null")
    lock = RigLock([str(tmp_path / "by-id")], tmp_path)
    with pytest.raises(PortError, match="in use"):
        RigLock(["/dev/null"], tmp_path)
    lock.release()


def test_other_ports_are_another_rig(tmp_path: Path) -> None:
    locks = [RigLock([port], tmp_path) for port in ("/dev/ttyA", "/dev/ttyB")]
    for lock in locks:
        lock.release()


def test_release_leaves_no_file_and_may_come_twice(tmp_path: Path) -> None:
    lock = RigLock(["/dev/ttyA"], tmp_path)
    lock.release()
    lock.release()
    assert not list(tmp_path.iterdir())


def test_a_holder_that_was_killed_holds_nothing(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        with pytest.raises(PortError, match=f"process {holder.pid}"):
            RigLock(["/dev/ttyA"], tmp_path)
        holder.send_signal(signal.SIGKILL)
        holder.wait()
    assert list(tmp_path.iterdir()), "what it left behind is what is tested"
    RigLock(["/dev/ttyA"], tmp_path).release()


def test_a_lock_that_cannot_be_made_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(PortError, match="the rig's lock cannot be made"):
        RigLock(["/dev/ttyA"], tmp_path / "missing" / "folder")


def test_a_rig_is_locked_by_all_its_ports_and_one_without_needs_no_lock() -> None:
    config = RigConfig.model_validate(
        {"turntable": {"port": "/dev/ttyA"}, "arm": {"port": "/dev/ttyB"}, "camera": {"device": "/dev/video7"}}
    )
    assert ports_of(config.model_dump()) == ["/dev/ttyA", "/dev/ttyB", "/dev/video7"]
    assert lock_rig(RigConfig()) is None
