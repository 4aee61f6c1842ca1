"""What the header of a `.matcap.exr` says, as JSON, beside the maps."""

from dataclasses import asdict
from typing import Annotated

from pydantic import BaseModel, Field

from litrig.base.table_normals import TableNormal
from litrig.base.version import litrig_version
from processing.matcap.disc import LARGEST_SIDE
from processing.matcap.lights.model import F32, Angle, Hung, Light, Picture
from processing.matcap.model import STILL, Component, DecomposedMatcap
from processing.matcap.silhouette import Silhouette

VERSION = 3
_NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Number = Annotated[float, Field(allow_inf_nan=False)]
_Turn = tuple[Angle, Angle, Angle]
_LARGEST_FILTER_SIZE = 1e6


class SilhouetteMeaning(BaseModel, frozen=True, extra="forbid"):
    start_deg: Annotated[float, Field(ge=0, lt=90, allow_inf_nan=False)] = 0.0
    rise: _Number = 0.0
    slope: _Number = 0.0


class ComponentMeaning(BaseModel, frozen=True, extra="forbid"):
    base_colour: tuple[_NotNegative, _NotNegative, _NotNegative]
    slope: Annotated[float, Field(ge=0, le=1)]
    filter_size: Annotated[float, Field(ge=0, le=_LARGEST_FILTER_SIZE)]
    silhouette: SilhouetteMeaning = SilhouetteMeaning()
    light_turn_deg: _Turn = STILL
    normal_turn_deg: _Turn = STILL
    lights: tuple[Annotated[Light, Field(discriminator="shape")], ...] = ()
    pictures: tuple[Picture, ...] = ()

    def component(self, front: F32, back: F32, texels: list[F32], remainder: F32 | None) -> Component:
        """Return what is meant, with its maps, the texels of its pictures, and what the maps lack."""
        silhouette = self.silhouette
        return Component(
            front=front,
            back=back,
            base_colour=self.base_colour,
            slope=self.slope,
            filter_size=self.filter_size,
            silhouette=Silhouette(silhouette.start_deg, silhouette.rise, silhouette.slope),
            light_turn_deg=self.light_turn_deg,
            normal_turn_deg=self.normal_turn_deg,
            lights=self.lights,
            pictures=tuple(Hung(*pair) for pair in zip(self.pictures, texels, strict=True)),
            remainder=remainder,
        )


class Meaning(BaseModel, frozen=True, extra="forbid"):
    """The JSON itself.

    Version 1, which does not say so, had the first three parameters of a component alone, and version 2 no remainders.
    """

    version: Annotated[int, Field(ge=1, le=VERSION)] = 1
    low: ComponentMeaning
    high: ComponentMeaning
    table_normal: TableNormal
    picture_size: Annotated[int, Field(ge=1, le=LARGEST_SIDE)] | None = None
    source: str = ""
    litrig: str

    @classmethod
    def of(cls, matcap: DecomposedMatcap) -> "Meaning":
        """Say what a MatCap is; a ValidationError names the parameter that is out of range."""
        return cls.model_validate(
            {
                "version": VERSION,
                "low": _told(matcap.low),
                "high": _told(matcap.high),
                "table_normal": matcap.table_normal,
                "picture_size": matcap.picture_size,
                "source": matcap.source,
                "litrig": litrig_version(),
            }
        )


def _told(component: Component) -> dict[str, object]:
    return {
        "base_colour": component.base_colour,
        "slope": component.slope,
        "filter_size": component.filter_size,
        "silhouette": asdict(component.silhouette),
        "light_turn_deg": component.light_turn_deg,
        "normal_turn_deg": component.normal_turn_deg,
        "lights": component.lights,
        "pictures": tuple(hung.picture for hung in component.pictures),
    }
