"""What an AMC file says of its table: one JSON text, the same in every kind of file that holds one."""

from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, ValidationError

from litrig.base.errors import FormatError
from litrig.base.table_normals import TableNormal
from litrig.base.version import litrig_version
from processing.amc.model import Amc, TangentAngle


class Meaning(BaseModel, frozen=True, extra="forbid", use_attribute_docstrings=True):
    """The JSON itself."""

    invariance: Annotated[int, Field(ge=1, le=360)] | Literal["isotropic"]
    """R: the material looks the same turned by 360°/R."""
    table_normal: TableNormal
    """How a perspective picture's normal is brought to the table."""
    slice_angles_deg: tuple[Annotated[float, Field(allow_inf_nan=False)], ...] = ()
    """The tangent angle of every captured slice, as measured."""
    source: str = ""
    """Digest of the frames that the table was built from."""
    tangent_angle: TangentAngle = TangentAngle.PICTURE
    """What k counts: the angle of the tangent's picture (the paper's equation 3), or its angle in the surface, after
    the smallest rotation of the table normal to z."""
    litrig: str
    """Version that wrote the file."""

    @classmethod
    def of(cls, amc: Amc) -> Self:
        """Say what a table means, as this version of litrig writes it."""
        return cls(
            invariance=amc.invariance,
            table_normal=amc.table_normal,
            slice_angles_deg=amc.slice_angles_deg,
            source=amc.source,
            tangent_angle=amc.tangent_angle,
            litrig=litrig_version(),
        )

    def table(self, slices: NDArray[np.float32], valid: NDArray[np.bool_]) -> Amc:
        """Give slices (D, S, S, 3) and their validity (D, S, S) this meaning."""
        return Amc(
            slices=slices,
            valid=valid,
            invariance=self.invariance,
            table_normal=self.table_normal,
            slice_angles_deg=self.slice_angles_deg,
            source=self.source,
            tangent_angle=self.tangent_angle,
        )


def read_meaning(stored: str | bytes, depth: int, name: str) -> Meaning:
    """Read the JSON of a table of `depth` slices; `name` says in errors where it stood.

    Raises
    ------
    FormatError
        It is no such JSON, or contradicts the depth.
    """
    try:
        meaning = Meaning.model_validate_json(stored)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise FormatError(f"{name} {place}: {first['msg']}; build it again") from error
    if meaning.invariance == "isotropic" and depth != 1:
        raise FormatError(f"{name}: is called isotropic, yet has {depth} slices; build it again")
    return meaning
