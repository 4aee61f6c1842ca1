from pathlib import Path

import pytest
from pydantic import Field

from litrig.base.config import StrictModel, parse_toml, read_toml
from litrig.base.errors import ConfigError, InputError


class Lamp(StrictModel):
    power: float = Field(gt=0)
    port: str = "x"


class Rig(StrictModel):
    lamp: Lamp


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param("[lamp]\npower = 1\nprot = 'a'", "unknown key 'lamp.prot'", id="misspelt key"),
        pytest.param("[lamp]", "key 'lamp.power' is missing", id="missing key"),
        pytest.param("[lamp]\npower = -1", "lamp.power: Input should be greater than 0 .found -1", id="out of range"),
        pytest.param("[lamp]\npower = nan", "lamp.power: Input should be a finite number", id="not a number"),
        pytest.param("[lamp", "not valid TOML", id="not TOML"),
    ],
)
def test_a_wrong_file_is_refused_with_its_name_and_the_key(text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=f"rig.toml: .*{message}"):
        parse_toml(text, Rig, "rig.toml")


def test_a_file_that_is_not_text_says_how_to_save_it(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_bytes(b"name = '\xe4'")
    with pytest.raises(ConfigError, match=r"rig\.toml: is not UTF-8 text; save it as UTF-8"):
        read_toml(tmp_path / "rig.toml", Rig)


@pytest.mark.parametrize(
    ("name", "reason"), [(".", "is a folder; name a file"), ("/dev/zero", "is a device or a pipe")]
)
def test_what_is_no_file_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read_toml(tmp_path / name, Rig)


def test_every_misfit_is_named_at_once() -> None:
    with pytest.raises(ConfigError, match=r"lamp.power.*unknown key 'table'"):
        parse_toml("[lamp]\npower = 0\n[table]", Rig, "rig.toml")


def test_deep_nesting_is_an_error_too() -> None:
    with pytest.raises(ConfigError, match=r"rig\.toml"):
        parse_toml("a = " + "[" * 3000 + "]" * 3000, Rig, "rig.toml")
