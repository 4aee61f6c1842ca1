"""Which driver opens a part of a `kind`: those that come with litrig, and those that other packages bring.

A package brings one by an entry point, whose name is the kind and whose object is a `Driver`:

    [project.entry-points."litrig.turntables"]      # or litrig.arms, litrig.lights, litrig.cameras
    my-table = "my_package.driver:DRIVER"

The driver's model reads the section of RIG.toml, its function opens the device, and the device fits the Protocol in
`rig.devices` and passes the suite in `rig.conformance`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from litrig.base.config import StrictModel
from litrig.base.errors import ConfigError
from rig.clock import Clock
from rig.devices import Camera, LightArm, Lights, Turntable
from rig.sections import ArmSection, CameraSection, LightsSection, TurntableSection

if TYPE_CHECKING:
    from rig.config import RigConfig


class Link(Protocol):
    """What several devices may share, such as the controller of arm and lamp."""

    def close(self) -> None:
        """Give the port back; closing again does nothing."""


SharedLink = TypeVar("SharedLink", bound=Link)
Section = TypeVar("Section", TurntableSection, ArmSection, LightsSection, CameraSection)
Device = TypeVar("Device", Turntable, LightArm, Lights, Camera)


@dataclass(frozen=True)
class Bench:
    """What a driver finds when it opens its device, beside its own section.

    Attributes
    ----------
    config : the whole RIG.toml
    clock : the time that the rig goes by
    environment : to add to that of processes that the driver starts
    """

    config: "RigConfig"
    clock: Clock
    environment: Mapping[str, str] = field(default_factory=dict)
    _links: dict[tuple[type, str], Link] = field(default_factory=dict)

    def link(self, kind: type[SharedLink], port: str, connect: Callable[[], SharedLink]) -> SharedLink:
        """Return the link of this kind to a port, opened by whoever asks first."""
        link = self._links.get((kind, port))
        if not isinstance(link, kind):
            link = self._links[kind, port] = connect()
        return link

    def close(self) -> None:
        """Close all links, after a part could not be opened."""
        for link in self._links.values():
            link.close()


@dataclass(frozen=True)
class Driver:
    """How a kind of device is described, and how it is opened.

    Attributes
    ----------
    section : the model of its section in RIG.toml; derives from one of `rig.sections`
    open : called with a section of that model and the bench; returns the device, or raises a `RigError` and leaves
        nothing open
    """

    section: type[StrictModel]
    open: Callable[[Any, Bench], Any]


@dataclass(frozen=True)
class Registry(Generic[Section, Device]):
    """The drivers of one part of the rig.

    Attributes
    ----------
    part : name of the section in RIG.toml
    group : of the entry points by which packages bring drivers
    base : what all sections of this part have in common
    built_in : kind, and where its driver lies; they are imported when they are needed
    default : kind of a section that names none
    """

    part: str
    group: str
    base: type[Section]
    built_in: Mapping[str, str]
    default: str | None = None

    def kinds(self) -> list[str]:
        """Return every kind that can be opened here."""
        return sorted({*self.built_in, *(entry.name for entry in entry_points(group=self.group))})

    def driver(self, kind: str) -> Driver:
        """Return the driver of a kind.

        Raises
        ------
        ConfigError
            There is none, there are several, or it cannot be loaded.
        """
        entry = self._entry(kind)
        try:
            driver = entry.load()
        except Exception as error:  # whatever a foreign module raises when it is imported
            raise ConfigError(
                f"[{self.part}] the driver of kind {kind!r}, {_origin(entry)}, cannot be loaded "
                f"({type(error).__name__}: {error}); install that package anew"
            ) from error
        if not isinstance(driver, Driver) or not issubclass(driver.section, self.base):
            raise ConfigError(
                f"[{self.part}] kind {kind!r}, {_origin(entry)}, is no rig.drivers.Driver with a section derived from "
                f"{self.base.__name__}; tell the makers of that package"
            )
        return driver

    def read(self, section: object) -> object:
        """Read a section of RIG.toml into its driver's model; what is no table is left for pydantic to refuse."""
        if not isinstance(section, dict):
            return section
        kind = section.get("kind", self.default)
        if kind is None:
            raise ValueError(f"kind is missing; add it, one of {', '.join(self.kinds())}")
        try:
            model = self.driver(str(kind)).section
        except ConfigError as error:
            raise ValueError(str(error)) from error
        return model.model_validate({**section, "kind": kind})

    def open(self, section: Section, bench: Bench) -> Device:
        """Open the device that a section describes.

        Raises
        ------
        RigError
            It is missing, taken, or not what the section says.
        """
        device: Device = self.driver(section.kind).open(section, bench)
        return device

    def _entry(self, kind: str) -> EntryPoint:
        found = [EntryPoint(kind, self.built_in[kind], self.group)] if kind in self.built_in else []
        found += entry_points(group=self.group, name=kind)
        if len(found) > 1:
            several = "; ".join(sorted(map(_origin, found)))
            raise ConfigError(f"[{self.part}] kind {kind!r} is brought by several: {several}; remove all but one")
        if not found:
            raise ConfigError(
                f"[{self.part}] no driver for kind {kind!r}; known are {', '.join(self.kinds())}. Mend its spelling, "
                f"or install the package that brings it by an entry point of the group {self.group!r}"
            )
        return found[0]


def _origin(entry: EntryPoint) -> str:
    return f"{entry.value} of the package {entry.dist.name if entry.dist else 'litrig'}"


TURNTABLES: Registry[TurntableSection, Turntable] = Registry(
    "turntable",
    "litrig.turntables",
    TurntableSection,
    {"dynamixel": "rig.dynamixel.driver:TURNTABLE", "grbl": "rig.grbl.driver:TURNTABLE"},
    "dynamixel",
)
ARMS: Registry[ArmSection, LightArm] = Registry(
    "arm", "litrig.arms", ArmSection, {"grbl": "rig.grbl.driver:ARM"}, "grbl"
)
LIGHTS: Registry[LightsSection, Lights] = Registry(
    "lights",
    "litrig.lights",
    LightsSection,
    {
        "grbl-spindle": "rig.grbl.driver:SPINDLE_LAMP",
        "always-on": "rig.always_on:DRIVER",
        "udmx": "rig.udmx.driver:LIGHTS",
    },
)
CAMERAS: Registry[CameraSection, Camera] = Registry(
    "camera", "litrig.cameras", CameraSection, {"v4l2": "rig.camera.driver:CAMERA"}, "v4l2"
)
