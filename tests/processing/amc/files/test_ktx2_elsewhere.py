"""AMC files by somebody else's hands: ktx-parse and zstddec, which web pages and three.js read KTX 2.0 with."""

import base64
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import FormatError
from litrig.base.radiometry import decode_srgb, encode_srgb
from litrig.base.table_normals import TableNormal
from processing.amc.files.ktx2 import read_header, read_levels, write_amc
from processing.amc.mips import mip_chain
from processing.amc.model import Amc, TangentAngle

NPM = Path(__file__).parents[3] / "npm"
MEANING = {"invariance": 3, "table_normal": "camera", "litrig": "by hand"}
MISSING = [
    *([] if shutil.which("node") else ["node is not installed"]),
    *([] if (NPM / "node_modules" / "ktx-parse").is_dir() else ["ktx-parse is not: npm ci --prefix tests/npm"]),
]
pytestmark = pytest.mark.skipif(bool(MISSING), reason="; ".join(MISSING) or "nothing is missing")


def node(*words: str | Path) -> str:
    """Run the little program beside the libraries."""
    ran = subprocess.run(["node", NPM / "ktx2.mjs", *words], capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def read_elsewhere(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(node("read", path))
    return found


def some_amc(size: int = 6, depth: int = 5, brightest: float = 1.0) -> Amc:
    random = np.random.default_rng(3)
    slices = (random.random((depth, size, size, 3)) * brightest).astype(np.float32)
    valid = random.random((depth, size, size)) > 0.3
    return Amc(slices, valid, 2, TableNormal.VIEW, (0.0, 36.25, 72.5), "sha256:0a1b", TangentAngle.SURFACE)


def texels(amc: Amc, *, half_float: bool, levels: int) -> list[bytes]:
    """Encode a table's levels without any of the file's code."""
    stored = []
    for level in mip_chain(amc)[:levels]:
        colours = level.colours if half_float else encode_srgb(level.colours)
        values = np.concatenate([colours, level.coverage[..., None]], axis=-1)
        codes = values.astype("<f2") if half_float else np.rint(values * np.float32(255)).astype("u1")
        stored.append(codes.tobytes())
    return stored


@pytest.mark.parametrize("compress", [False, True], ids=["plain", "Zstandard"])
@pytest.mark.parametrize("half_float", [False, True], ids=["8-bit", "half"])
@pytest.mark.parametrize(
    ("size", "depth", "mip_levels", "levels"),
    [
        pytest.param(6, 5, True, 3, id="odd depth with all levels"),
        pytest.param(4, 16, True, 5, id="deeper than wide"),
        pytest.param(5, 3, False, 1, id="one level"),
    ],
)
def test_every_field_and_every_texel_is_what_we_wrote(
    tmp_path: Path, size: int, depth: int, mip_levels: bool, levels: int, half_float: bool, compress: bool
) -> None:
    amc = some_amc(size, depth)
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, amc, half_float=half_float, mip_levels=mip_levels, compress=compress)
    found = read_elsewhere(path)
    (descriptor,) = found.pop("dataFormatDescriptor")
    stored, keys = found.pop("levels"), found.pop("keyValue")
    assert found == {
        "vkFormat": 97 if half_float else 43,
        "typeSize": 2 if half_float else 1,
        "pixelWidth": size,
        "pixelHeight": size,
        "pixelDepth": depth,
        "layerCount": 0,
        "faceCount": 1,
        "levelCount": levels,
        "supercompressionScheme": 2 if compress else 0,
        "globalData": None,
    }
    assert descriptor == expected_descriptor(half_float)
    assert_keys(keys)
    assert [base64.b64decode(level) for level in stored] == texels(amc, half_float=half_float, levels=levels)


def expected_descriptor(half_float: bool) -> dict[str, Any]:
    """RGBSDA, BT.709, straight alpha; linear signed halves, or sRGB codes with linear alpha."""
    bits = 16 if half_float else 8
    # The bits of −1.0 and 1.0; a signed sample's ends come out as signed integers.
    low, high = (0xBF800000 - (1 << 32), 0x3F800000) if half_float else (0, 255)
    kinds = [0xC0, 0xC1, 0xC2, 0xCF] if half_float else [0, 1, 2, 0x1F]
    return {
        "vendorId": 0,
        "descriptorType": 0,
        "versionNumber": 2,
        "colorModel": 1,
        "colorPrimaries": 1,
        "transferFunction": 1 if half_float else 2,
        "flags": 0,
        "texelBlockDimension": [0, 0, 0, 0],
        "bytesPlane": [bits // 2, 0, 0, 0, 0, 0, 0, 0],
        "samples": [
            {
                "bitOffset": bits * number,
                "bitLength": bits - 1,
                "channelType": kind,
                "samplePosition": [0, 0, 0, 0],
                "sampleLower": low,
                "sampleUpper": high,
            }
            for number, kind in enumerate(kinds)
        ],
    }


def assert_keys(keys: dict[str, str]) -> None:
    assert sorted(keys) == ["KTXorientation", "KTXwriter", "litrig.amc"]
    assert keys["KTXorientation"] == "rdi"
    assert keys["KTXwriter"].startswith("litrig ")
    meaning = json.loads(keys["litrig.amc"].removesuffix("\0"))
    assert meaning.pop("litrig") == keys["KTXwriter"].removeprefix("litrig ")
    assert meaning == {
        "invariance": 2,
        "table_normal": "view",
        "slice_angles_deg": [0.0, 36.25, 72.5],
        "source": "sha256:0a1b",
        "tangent_angle": "surface",
    }


def write_elsewhere(folder: Path, levels: list[NDArray[Any]], keys: dict[str, str], *, half_float: bool) -> Path:
    depth, size = levels[0].shape[:2]
    description = {
        "size": size,
        "depth": depth,
        "isHalf": half_float,
        "levels": [base64.b64encode(level.tobytes()).decode() for level in levels],
        "keyValue": keys,
    }
    (folder / "description.json").write_text(json.dumps(description))
    node("write", folder / "description.json", folder / "theirs.ktx2")
    return folder / "theirs.ktx2"


@pytest.mark.parametrize("half_float", [False, True], ids=["8-bit", "half"])
def test_a_file_that_they_wrote_is_read(tmp_path: Path, half_float: bool) -> None:
    random = np.random.default_rng(8)
    shapes = [(5, 6, 6, 4), (2, 3, 3, 4), (1, 1, 1, 4)]
    kind = np.dtype("<f2") if half_float else np.dtype("u1")
    stored = [(random.random(shape) * (2 if half_float else 255)).astype(kind) for shape in shapes]
    path = write_elsewhere(tmp_path, stored, {"litrig.amc": json.dumps(MEANING)}, half_float=half_float)
    amc, levels = read_levels(path)
    assert (amc.invariance, amc.table_normal, amc.tangent_angle) == (3, TableNormal.CAMERA, TangentAngle.PICTURE)
    assert read_header(path).written_by == "by hand"
    assert read_header(path).half_float is half_float
    for level, texel in zip(levels, stored, strict=True):
        values = texel.astype(np.float32) / np.float32(1 if half_float else 255)
        colours = values[..., :3] if half_float else decode_srgb(values[..., :3])
        np.testing.assert_allclose(level.colours, colours, rtol=1e-6, atol=1e-7)
        np.testing.assert_allclose(level.coverage, values[..., 3], rtol=1e-6)


def test_their_file_without_our_key_is_named_as_what_it_lacks(tmp_path: Path) -> None:
    path = write_elsewhere(tmp_path, [np.zeros((2, 4, 4, 4), np.uint8)], {}, half_float=False)
    with pytest.raises(FormatError, match=r"theirs\.ktx2: has no key litrig\.amc"):
        read_header(path)
