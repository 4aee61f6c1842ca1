import os

import pytest

from litrig.base.quiet import quiet_library


def test_what_is_written_below_python_is_lost_and_the_streams_come_back(capfd: pytest.CaptureFixture[str]) -> None:
    os.write(1, b"before ")
    with quiet_library():
        os.write(1, b"lost")
        os.write(2, b"lost")
    os.write(1, b"after")
    assert capfd.readouterr() == ("before after", "")


def test_the_streams_come_back_after_an_error(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="x"), quiet_library():
        raise ValueError("x")
    os.write(2, b"heard")
    assert capfd.readouterr().err == "heard"
