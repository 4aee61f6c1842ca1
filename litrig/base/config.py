"""TOML files read by strict models, in which an unknown key is an error that names it; and JSON that others write."""

import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.alias_generators import to_camel

from litrig.base.errors import ConfigError, FormatError
from litrig.base.files import read_limited

LARGEST_TOML_BYTES = 4_000_000
_MISFITS_SHOWN, _SHOWN = 3, 80


class StrictModel(BaseModel):
    """The base of every model that a file is read into."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class ForeignModel(BaseModel):
    """The base of models for other programs' files, which may say more than litrig knows; their keys are camelCase."""

    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False, alias_generator=to_camel)


Model = TypeVar("Model", bound=BaseModel)


def parse_toml(text: str, model: type[Model], source: str) -> Model:
    """Read a model from TOML text; `source` names it in errors."""
    try:
        table = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ConfigError(f"{source}: not valid TOML ({error}); mend that place") from error
    try:
        return model.model_validate(table)
    except ValidationError as error:
        raise ConfigError(f"{source}: {_describe(error)}") from error


def read_toml(path: Path, model: type[Model]) -> Model:
    """Read a model from a TOML file.

    Raises
    ------
    InputError
        The file is missing, is no file, or cannot be read.
    ConfigError
        It is not TOML, or does not fit the model; every misfit is named by its key.
    """
    return parse_toml_bytes(read_limited(path, LARGEST_TOML_BYTES), model, str(path))


def parse_toml_bytes(content: bytes, model: type[Model], source: str) -> Model:
    """Read a model from the bytes of a TOML file; `source` names it in errors."""
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{source}: is not UTF-8 text; save it as UTF-8") from error
    return parse_toml(text, model, source)


def parse_json_bytes(content: bytes, model: type[Model], source: str) -> Model:
    """Read a model from the bytes of a JSON file; `source` names it in errors.

    Raises
    ------
    FormatError
        It is no JSON, is nested or written to exhaust a reader, or does not fit the model.
    """
    try:
        return model.model_validate_json(content)
    except ValidationError as error:
        raise FormatError(f"{source}: {_describe(error, most=_MISFITS_SHOWN)}") from error


def _describe(error: ValidationError, most: int | None = None) -> str:
    misfits = error.errors(include_url=False, include_context=False)
    more = f"; and {len(misfits) - most} more" if most and len(misfits) > most else ""
    return "; ".join(_describe_one(dict(item)) for item in misfits[:most]) + more


def _describe_one(item: dict[str, object]) -> str:
    place = item["loc"]
    key = ".".join(str(part) for part in place) if isinstance(place, tuple) else str(place)
    match item["type"]:
        case "extra_forbidden":
            return f"unknown key {key!r}; remove it or mend its spelling"
        case "missing":
            return f"key {key!r} is missing; add it"
        case _:
            message = str(item["msg"]).removeprefix("Value error, ")
            return f"{key}: {message} (found {repr(item['input'])[:_SHOWN]})" if key else message
