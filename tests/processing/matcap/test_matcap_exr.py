import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from litrig.base.errors import FormatError, InputError
from litrig.base.table_normals import TableNormal
from processing.matcap.lights.model import Edge, Hung, Picture, Spot
from processing.matcap.matcap_exr import KEY, KIND, read_matcap, write_matcap
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.silhouette import Silhouette
from tests.processing.matcap.maps import analytic

GOOD = analytic(8, TableNormal.CAMERA)


def test_what_is_written_is_read_bit_by_bit(tmp_path: Path) -> None:
    write_matcap(tmp_path / "x.matcap.exr", GOOD)
    found = read_matcap(tmp_path / "x.matcap.exr")
    for name in ("low", "high"):
        wanted, got = dataclasses.asdict(getattr(GOOD, name)), dataclasses.asdict(getattr(found, name))
        for field, value in wanted.items():
            np.testing.assert_array_equal(got[field], value)
    assert (found.table_normal, found.source) == (TableNormal.CAMERA, "analytic")


def test_another_reader_finds_the_parts_and_the_parameters(tmp_path: Path) -> None:
    write_matcap(tmp_path / "x.matcap.exr", GOOD)
    with OpenEXR.File(str(tmp_path / "x.matcap.exr")) as exr:
        assert [part.name() for part in exr.parts] == ["low.front", "low.back", "high.front", "high.back"]
        np.testing.assert_array_equal(exr.parts[3].channels["RGB"].pixels, GOOD.high.back)
        assert all(part.header["litrig.kind"] == KIND for part in exr.parts)
        told = json.loads(exr.parts[0].header[KEY])
    assert {name: told["high"][name] for name in ("base_colour", "slope", "filter_size")} == {
        "base_colour": [0.6, 0.6, 0.7],
        "slope": 0.9,
        "filter_size": 0.02,
    }
    assert told["version"] == 3 and told["litrig"]


def parameters(component: Component) -> dict[str, Any]:
    arrays = ("front", "back", "pictures")
    names = [field.name for field in dataclasses.fields(component) if field.name not in arrays]
    return {name: getattr(component, name) for name in names}


def test_what_was_edited_is_read_bit_by_bit(tmp_path: Path) -> None:
    texels = np.random.default_rng(1).random((3, 5, 4), np.float32)
    picture = Picture(colour=(1, 1, 1), direction=(0, 0.6, 0.8), size_deg=20, name="flame")
    high = dataclasses.replace(
        GOOD.high,
        silhouette=Silhouette(30, 0.5, -0.25),
        light_turn_deg=(0, 30, 1),
        normal_turn_deg=(5, 0, 0),
        lights=(Edge(colour=(1, 2, 3), pole=(0, 1, 0)), Spot(colour=(1, 1, 0), direction=(0, 0, 1), size_deg=3)),
        pictures=(Hung(picture, texels),),
    )
    write_matcap(tmp_path / "x.matcap.exr", dataclasses.replace(GOOD, high=high, picture_size=77))
    found = read_matcap(tmp_path / "x.matcap.exr")
    assert found.picture_size == 77
    assert parameters(found.high) == parameters(high)
    assert found.high.pictures[0].picture == picture
    np.testing.assert_array_equal(found.high.pictures[0].texels, texels)


def test_a_file_of_the_first_version_is_read(tmp_path: Path) -> None:
    def older(heads: list[dict[str, Any]], _: list[np.ndarray]) -> None:
        kept = ("base_colour", "slope", "filter_size")
        for head in heads:
            meaning = json.loads(head[KEY])
            for which in ("low", "high"):
                meaning[which] = {name: meaning[which][name] for name in kept}
            del meaning["version"], meaning["picture_size"]
            head[KEY] = json.dumps(meaning)

    rewritten(tmp_path / "x.matcap.exr", older)
    found = read_matcap(tmp_path / "x.matcap.exr")
    assert parameters(found.low) == parameters(GOOD.low)
    assert found.picture_size is None


def test_what_the_maps_lack_is_read_bit_by_bit_and_may_be_of_another_size(tmp_path: Path) -> None:
    lacking = np.random.default_rng(1).normal(size=(5, 5, 3)).astype(np.float32)
    high = dataclasses.replace(GOOD.high, remainder=lacking)
    write_matcap(tmp_path / "x.matcap.exr", dataclasses.replace(GOOD, high=high))
    found = read_matcap(tmp_path / "x.matcap.exr")
    assert found.low.remainder is None and found.high.remainder is not None
    np.testing.assert_array_equal(found.high.remainder, lacking)


def test_what_half_floats_hold_is_written_so(tmp_path: Path) -> None:
    back = GOOD.low.back.astype(np.float16).astype(np.float32)
    write_matcap(tmp_path / "x.matcap.exr", changed(back=back, front=back * 1e6))
    with OpenEXR.File(str(tmp_path / "x.matcap.exr")) as exr:
        kinds = {part.name(): part.channels["RGB"].pixels.dtype for part in exr.parts}
    assert (kinds["low.front"], kinds["low.back"]) == (np.float32, np.float16)
    found = read_matcap(tmp_path / "x.matcap.exr")
    np.testing.assert_array_equal(found.low.front, back * 1e6)
    np.testing.assert_array_equal(found.low.back, back)


def test_large_maps_of_even_light_are_no_bomb(tmp_path: Path) -> None:
    even = np.ones((1200, 1200, 3), np.float32)
    dark = dataclasses.replace(GOOD.high, front=0 * even, back=0 * even)
    write_matcap(tmp_path / "x.matcap.exr", dataclasses.replace(changed(front=even, back=even), high=dark))
    assert read_matcap(tmp_path / "x.matcap.exr").low.front.all()


def test_a_remainder_that_is_not_square_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\(4, 5, 3\) is no low\.remainder"):
        write_matcap(tmp_path / "x.matcap.exr", changed(remainder=np.ones((4, 5, 3), np.float32)))

    def oblong(heads: list[dict[str, Any]], pixels: list[np.ndarray]) -> None:
        heads.append({**heads[0], "name": "low.remainder"})
        pixels.append(np.ones((4, 5, 3), np.float32))

    rewritten(tmp_path / "x.matcap.exr", oblong)
    with pytest.raises(FormatError, match=r"low\.remainder is 5 × 4, and not square"):
        read_matcap(tmp_path / "x.matcap.exr")


def changed(**low: Any) -> DecomposedMatcap:
    return dataclasses.replace(GOOD, low=dataclasses.replace(GOOD.low, **low))


@pytest.mark.parametrize(
    ("name", "matcap", "reason"),
    [
        pytest.param("x.exr", GOOD, "end the name in .matcap.exr", id="an ending"),
        pytest.param("x.matcap.exr", changed(front=GOOD.low.front[:4]), "give four of", id="no square"),
        pytest.param("x.matcap.exr", changed(back=analytic(4).low.back), "give four of", id="two sizes"),
        pytest.param("x.matcap.exr", changed(front=GOOD.low.front * np.nan), "what is no number", id="NaN"),
        pytest.param("x.matcap.exr", changed(slope=1.5), r"low\.slope: Input should be less", id="slope"),
        pytest.param("x.matcap.exr", changed(filter_size=np.inf), r"low\.filter_size", id="filter size"),
        pytest.param("x.matcap.exr", changed(base_colour=(1, -1, 1)), r"low\.base_colour\.1", id="colour"),
    ],
)
def test_what_is_no_decomposed_matcap_is_not_written(
    tmp_path: Path, name: str, matcap: DecomposedMatcap, reason: str
) -> None:
    with pytest.raises(InputError, match=reason):
        write_matcap(tmp_path / name, matcap)
    assert not any(tmp_path.iterdir())


def rewritten(path: Path, change: Callable[[list[dict[str, Any]], list[np.ndarray]], None]) -> None:
    """Write a good file whose heads and pixels were changed."""
    write_matcap(path, GOOD)
    with OpenEXR.File(str(path)) as exr:
        heads = [
            {k: v for k, v in part.header.items() if k in ("type", "name", "displayWindow", "litrig.kind", KEY)}
            for part in exr.parts
        ]
        pixels = [part.channels["RGB"].pixels for part in exr.parts]
    change(heads, pixels)
    parts = [OpenEXR.Part(head, {"RGB": texels}) for head, texels in zip(heads, pixels, strict=True)]
    OpenEXR.File(parts).write(str(path))


def told(**changes: Any) -> Callable[[list[dict[str, Any]], list[np.ndarray]], None]:
    def change(heads: list[dict[str, Any]], _: list[np.ndarray]) -> None:
        for head in heads:
            head[KEY] = json.dumps({**json.loads(head[KEY]), **changes})

    return change


def hanging_nothing() -> dict[str, Any]:
    picture = {"shape": "picture", "colour": [1, 1, 1], "direction": [0, 0, 1], "size_deg": 9}
    return {"base_colour": [1, 1, 1], "slope": 1, "filter_size": 0, "pictures": [picture]}


PLAIN_HIGH: dict[str, Any] = {"base_colour": [1, 1, 1], "slope": 1, "filter_size": 0}


def turned_by(degrees: float) -> dict[str, Any]:
    return {**PLAIN_HIGH, "light_turn_deg": [degrees, 0, 0]}


def lit_from(*direction: float) -> dict[str, Any]:
    return {**PLAIN_HIGH, "lights": [{"shape": "spot", "colour": [1, 1, 1], "direction": direction, "size_deg": 5}]}


def other_kind(heads: list[dict[str, Any]], _: list[np.ndarray]) -> None:
    heads[2]["litrig.kind"] = "picture"


def part_missing(heads: list[dict[str, Any]], pixels: list[np.ndarray]) -> None:
    del heads[1], pixels[1]


def not_square(_: list[dict[str, Any]], pixels: list[np.ndarray]) -> None:
    pixels[0] = pixels[0][:5].copy()


def of_another_size(_: list[dict[str, Any]], pixels: list[np.ndarray]) -> None:
    pixels[3] = np.zeros((6, 6, 3), np.float32)


def not_a_number(_: list[dict[str, Any]], pixels: list[np.ndarray]) -> None:
    pixels[2] = np.full_like(pixels[2], np.nan)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        pytest.param(other_kind, "is of kind matcap-decomposed, picture, not", id="kind"),
        pytest.param(part_missing, "has parts low.front, high.front", id="part"),
        pytest.param(not_square, "claims maps of 8 × 5; they are square", id="square"),
        pytest.param(of_another_size, "part high.back is not 8 × 8", id="size"),
        pytest.param(not_a_number, "part high.front holds values that are no numbers", id="NaN"),
        pytest.param(told(table_normal="sideways"), "table_normal", id="table normal"),
        pytest.param(told(extra=1), "extra", id="an unknown key"),
        pytest.param(told(version=4), "version", id="a later version"),
        pytest.param(told(picture_size=10**9), "picture_size", id="a picture larger than memory"),
        pytest.param(told(high=turned_by(1e300)), "high.light_turn_deg", id="more turns than floats hold"),
        pytest.param(told(high={**PLAIN_HIGH, "filter_size": 1e300}), "high.filter_size", id="filter size"),
        pytest.param(told(high=lit_from(0, 0, 0)), "high.lights.0.*direction", id="a light from nowhere"),
        pytest.param(
            told(low=hanging_nothing()), r"has parts .* not .* low\.picture\.0", id="a picture that is not there"
        ),
        pytest.param(told(low={"base_colour": [1, 1, 1], "slope": 2, "filter_size": 0}), r"low\.slope", id="slope"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(
    tmp_path: Path, change: Callable[[list[dict[str, Any]], list[np.ndarray]], None], reason: str
) -> None:
    rewritten(tmp_path / "x.matcap.exr", change)
    with pytest.raises(FormatError, match=reason) as caught:
        read_matcap(tmp_path / "x.matcap.exr")
    assert "x.matcap.exr" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("share", [0.0, 0.02, 0.3, 0.7, 0.95])
def test_a_file_cut_short_is_refused(tmp_path: Path, share: float) -> None:
    write_matcap(tmp_path / "x.matcap.exr", GOOD)
    content = (tmp_path / "x.matcap.exr").read_bytes()
    (tmp_path / "x.matcap.exr").write_bytes(content[: int(share * len(content))])
    with pytest.raises(FormatError, match=r"x\.matcap\.exr"):
        read_matcap(tmp_path / "x.matcap.exr")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_matcap(tmp_path / "x.matcap.exr")
