"""What renderers call their layers."""

from dataclasses import dataclass

BUFFERS = (
    "picture",
    "coverage",
    "diffuse",
    "reflection",
    "normal",
    "position",
    "depth",
    "surface_id",
    "ambient_occlusion",
    "reflection_occlusion",
    "albedo",
    "reflection_albedo",
    "emission",
    "transparency",
)
"""What is looked for. Emission and transparency are parts of the picture that stay as they are."""


@dataclass(frozen=True)
class Recipe:
    """How a buffer comes about from layers: those of `terms` are added, then multiplied by `factor`.

    Attributes
    ----------
    terms : all of them must be there
    also : added too where they are there
    factor : the albedo, if the terms are light that it is still to be multiplied to
    """

    terms: tuple[str, ...]
    also: tuple[str, ...] = ()
    factor: str | None = None

    def __str__(self) -> str:
        """Write it as `--layer` takes it."""
        return " + ".join((*self.terms, *self.also)) + (f" * {self.factor}" if self.factor else "")


def _any_of(*names: str) -> tuple[Recipe, ...]:
    return tuple(Recipe((name,)) for name in names)


DIALECTS: dict[str, dict[str, tuple[Recipe, ...]]] = {
    "litrig": {
        **{name: _any_of(name) for name in BUFFERS if name not in ("picture", "coverage")},
        "picture": _any_of(""),
        "coverage": _any_of(""),
    },
    "Blender": {
        "picture": _any_of("Combined"),
        "coverage": _any_of("Combined"),
        "diffuse": (
            Recipe(("DiffDir", "DiffInd"), factor="DiffCol"),
            Recipe(("Diffuse Direct", "Diffuse Indirect"), factor="Diffuse Color"),
        ),
        "reflection": (
            Recipe(("GlossDir", "GlossInd"), factor="GlossCol"),
            Recipe(("Glossy Direct", "Glossy Indirect"), factor="Glossy Color"),
        ),
        "albedo": _any_of("DiffCol", "Diffuse Color"),
        "reflection_albedo": _any_of("GlossCol", "Glossy Color"),
        "surface_id": _any_of("IndexOB", "Object Index", "IndexMA", "Material Index", "CryptoObject00"),
        "ambient_occlusion": _any_of("AO", "Ambient Occlusion"),
        "emission": _any_of("Emit", "Emission"),
        "transparency": (Recipe(("TransDir", "TransInd"), factor="TransCol"),),
    },
    "Arnold": {
        "picture": _any_of("RGBA", "beauty"),
        "coverage": _any_of("RGBA", "beauty"),
        "diffuse": (Recipe(("diffuse_direct", "diffuse_indirect")),),
        "reflection": (
            Recipe(("specular",), also=("coat", "sheen")),
            Recipe(("specular_direct", "specular_indirect"), also=("coat", "sheen")),
        ),
        "normal": _any_of("N"),
        "position": _any_of("P"),
        "depth": _any_of("Z"),
        "surface_id": _any_of("ID", "object_id", "crypto_object00", "crypto_material00"),
        "ambient_occlusion": _any_of("AO"),
        "albedo": _any_of("diffuse_albedo"),
        "reflection_albedo": _any_of("specular_albedo"),
        "transparency": _any_of("transmission"),
    },
    "mitsuba": {
        "normal": _any_of("sh_normal", "geo_normal"),
        "surface_id": _any_of("shape_index"),
    },
    "Modo": {
        "picture": _any_of("Final Color", "Final Color Output"),
        "coverage": _any_of("Alpha", "Alpha Output"),
        "diffuse": (
            *_any_of("Diffuse Shading (Total)"),
            Recipe(("Diffuse Shading (Direct)", "Diffuse Shading (Indirect)")),
        ),
        "reflection": (Recipe(("Reflection Shading",), also=("Specular Shading",)),),
        "normal": _any_of("Shading Normal", "Geometric Normal"),
        "position": _any_of("World Coordinates"),
        "surface_id": _any_of("Surface ID"),
        "albedo": _any_of("Diffuse Color"),
        "emission": _any_of("Luminous Shading"),
        "transparency": _any_of("Transparent Shading"),
    },
}
"""By renderer. mitsuba's layers have the names that the scene gives them; these are those of its own kinds."""


def parse_recipe(text: str) -> Recipe:
    """Read `layer`, `layer + layer` or `layer + layer * albedo`.

    Raises
    ------
    ValueError
        There is no layer, or more than one factor.
    """
    sums, *factors = [part.strip() for part in text.split("*")]
    terms = tuple(term.strip() for term in sums.split("+"))
    if not all(terms) or len(factors) > 1 or not all(factors):
        raise ValueError(f"{text!r} is no layer, and no sum of layers times one")
    return Recipe(terms, factor=factors[0] if factors else None)
