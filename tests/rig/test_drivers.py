"""Which driver opens what: those that ship, and those of packages that are installed beside litrig."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest

from litrig.base.config import parse_toml
from litrig.base.errors import ConfigError
from rig import conformance
from rig.config import RigConfig
from rig.devices import Turntable
from rig.drivers import ARMS, CAMERAS, LIGHTS, TURNTABLES, Bench, Registry
from rig.fakes import FakeClock, FakeTurntable
from rig.rig import open_rig

MODULE = """
from typing import Literal

from rig.drivers import Driver
from rig.fakes import FakeTurntable
from rig.sections import LightsSection, TurntableSection


class SpinnerConfig(TurntableSection):
    kind: Literal["spinner"] = "spinner"
    slack_deg: float = 0.0


class Foreign(LightsSection):
    pass


DRIVER = Driver(SpinnerConfig, lambda config, bench: FakeTurntable(error_deg=config.slack_deg))
LAMPS = Driver(Foreign, lambda config, bench: None)
"""


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Put a package beside litrig, as pip would: a module, and a folder with its entry points."""
    (tmp_path / "spinner_of_tests.py").write_text(MODULE, "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "spinner_of_tests", raising=False)

    def add(distribution: str, entry: str) -> None:
        folder = tmp_path / f"{distribution}-1.0.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n", "utf-8")
        (folder / "entry_points.txt").write_text(entry, "utf-8")

    return add


SPINNER = "[litrig.turntables]\nspinner = spinner_of_tests:DRIVER\n"
RIG_TOML = "[turntable]\nkind = 'spinner'\nport = 'left'\nslack_deg = 0.1\n"


@pytest.mark.parametrize("registry", [TURNTABLES, ARMS, LIGHTS, CAMERAS], ids=lambda registry: registry.part)
def test_every_driver_that_ships_can_be_loaded_and_reads_its_own_kind(registry: Registry[Any, Any]) -> None:
    assert registry.built_in
    for kind in registry.built_in:
        annotation = registry.driver(kind).section.model_fields["kind"].annotation
        assert get_args(annotation) == (kind,)


def test_a_package_brings_a_driver_with_its_own_keys(install: Callable[[str, str], None]) -> None:
    install("spinner", SPINNER)
    config = parse_toml(RIG_TOML, RigConfig, "rig.toml")
    with open_rig(config, clock=FakeClock()) as rig:
        rig.home()
        assert rig.turn_to(30.0).angle_deg == 30.1
    assert config.model_dump()["turntable"]["slack_deg"] == 0.1
    assert parse_toml(RIG_TOML, RigConfig, "rig.toml") == config


@pytest.mark.parametrize("check", conformance.TURNTABLE, ids=lambda check: check.__name__)
def test_the_suite_runs_on_a_foreign_driver(
    install: Callable[[str, str], None], check: Callable[[Turntable], None]
) -> None:
    install("spinner", SPINNER)
    config = parse_toml(RIG_TOML, RigConfig, "rig.toml")
    assert config.turntable is not None
    check(TURNTABLES.open(config.turntable, Bench(config, FakeClock())))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param(RIG_TOML + "prot = 1", r"unknown key 'turntable\.prot'", id="misspelt key of the driver's own"),
        pytest.param("[turntable]\nkind = 'spinner'", r"key 'turntable\.port' is missing", id="key of every turntable"),
        pytest.param(
            "[turntable]\nkind = 'spiner'\nport = 'x'",
            r"no driver for kind 'spiner'; known are dynamixel, .*spinner.* 'litrig\.turntables'",
            id="unknown kind",
        ),
        pytest.param("[turntable]\nkind = 3\nport = 'x'", "no driver for kind '3'", id="kind is a number"),
        pytest.param(
            "[lights]\n", r"kind is missing; add it, one of always-on, ", id="kind left out where none is usual"
        ),
        pytest.param("turntable = 7", "turntable", id="no table"),
    ],
)
def test_what_a_driver_cannot_read_is_refused_with_its_key(
    install: Callable[[str, str], None], text: str, message: str
) -> None:
    install("spinner", SPINNER)
    with pytest.raises(ConfigError, match=message):
        parse_toml(text, RigConfig, "rig.toml")


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        pytest.param(
            "gone_of_tests:DRIVER", "of the package spinner, cannot be loaded .ModuleNotFoundError", id="gone"
        ),
        pytest.param("spinner_of_tests:MODULE", "cannot be loaded .AttributeError", id="no such object"),
        pytest.param("spinner_of_tests:SpinnerConfig", r"is no rig\.drivers\.Driver", id="no driver"),
        pytest.param("spinner_of_tests:LAMPS", "derived from TurntableSection", id="driver of another part"),
    ],
)
def test_a_broken_package_is_named(install: Callable[[str, str], None], entry: str, message: str) -> None:
    install("spinner", f"[litrig.turntables]\nspinner = {entry}\n")
    with pytest.raises(ConfigError, match=message):
        TURNTABLES.driver("spinner")


def test_two_packages_with_one_kind_are_refused(install: Callable[[str, str], None]) -> None:
    install("spinner", SPINNER)
    install("whirler", SPINNER)
    with pytest.raises(ConfigError, match=r"brought by several: .*package spinner; .*package whirler"):
        TURNTABLES.driver("spinner")


def test_nobody_may_take_a_kind_that_ships(install: Callable[[str, str], None]) -> None:
    install("spinner", "[litrig.turntables]\ndynamixel = spinner_of_tests:DRIVER\n")
    with pytest.raises(ConfigError, match=r"package litrig; .*package spinner"):
        TURNTABLES.driver("dynamixel")


class Wire:
    """A link that counts."""

    opened = closed = 0

    def __init__(self) -> None:
        Wire.opened += 1

    def close(self) -> None:
        Wire.closed += 1


def test_devices_on_one_port_share_its_link() -> None:
    bench = Bench(RigConfig(), FakeClock())
    first, second = (bench.link(Wire, "left", Wire) for _ in range(2))
    assert first is second
    assert bench.link(Wire, "right", Wire) is not first
    bench.close()
    assert (Wire.opened, Wire.closed) == (2, 2)


def test_a_part_that_is_not_used_is_not_opened(install: Callable[[str, str], None]) -> None:
    install("spinner", "[litrig.turntables]\nspinner = spinner_of_tests:DRIVER\n")
    config = parse_toml(RIG_TOML + "[camera]\ndevice = '/dev/video97'", RigConfig, "rig.toml")
    with open_rig(config, use=frozenset({"turntable"}), clock=FakeClock()) as rig:
        assert isinstance(rig.turntable, FakeTurntable)
