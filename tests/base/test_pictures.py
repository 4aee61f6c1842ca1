import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
import simplejpeg
import tifffile
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError, LitrigError
from litrig.base.pictures import read_codes, read_coverage, read_encoded, read_linear, write_codes, write_picture
from litrig.base.radiometry import decode_srgb, encode_srgb


@pytest.fixture
def codes() -> NDArray[np.uint8]:
    y, x = np.mgrid[0:40, 0:60]
    return np.stack([x * 4, y * 6, (x + y) * 2], -1).astype(np.uint8)


@pytest.mark.parametrize("ending", [".png", ".tif"])
def test_integers_survive_lossless_files(tmp_path: Path, codes: NDArray[np.uint8], ending: str) -> None:
    path = tmp_path / f"a{ending}"
    write_codes(path, codes)
    np.testing.assert_array_equal(read_codes(path), codes)


def test_sixteen_bits_stay_sixteen_bits(tmp_path: Path) -> None:
    wide = np.linspace(0, 65535, 300).astype(np.uint16).reshape(10, 10, 3)
    write_codes(tmp_path / "a.png", wide)
    assert read_codes(tmp_path / "a.png").dtype == np.uint16
    np.testing.assert_allclose(read_encoded(tmp_path / "a.png"), wide / 65535, atol=1e-7)


def test_light_survives_exr_bit_for_bit(tmp_path: Path) -> None:
    light = np.random.default_rng(1).normal(size=(7, 5, 3)).astype(np.float32)
    write_picture(tmp_path / "a.exr", light)
    np.testing.assert_array_equal(read_linear(tmp_path / "a.exr"), light)


def test_linear_and_display_values_are_each_others_inverse() -> None:
    values = np.linspace(0, 1, 1001, dtype=np.float32)
    np.testing.assert_allclose(encode_srgb(decode_srgb(values)), values, atol=2e-6)
    assert decode_srgb(np.array([0.5], np.float32)) == pytest.approx(0.21404, abs=1e-4)


def test_colours_keep_their_order_through_jpeg(tmp_path: Path) -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 0] = 200
    write_codes(tmp_path / "a.jpg", red)
    np.testing.assert_allclose(read_codes(tmp_path / "a.jpg").mean((0, 1)), (200, 0, 0), atol=3)


@pytest.mark.parametrize("ending", [".jpg", ".png", ".tif", ".exr"])
@pytest.mark.parametrize("kept", [0.05, 0.5, 0.95])
def test_a_picture_cut_short_is_an_error_with_its_name(
    tmp_path: Path, codes: NDArray[np.uint8], ending: str, kept: float
) -> None:
    path = tmp_path / f"cut{ending}"
    write_picture(path, codes.astype(np.float32) / 255)
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * kept)])
    with pytest.raises(LitrigError, match=f"cut{ending}"):
        read_linear(path)


def test_a_jpeg_without_its_last_byte_is_an_error(tmp_path: Path, codes: NDArray[np.uint8]) -> None:
    path = tmp_path / "a.jpg"
    path.write_bytes(simplejpeg.encode_jpeg(codes, 90)[:-1])
    with pytest.raises(FormatError, match=r"a\.jpg: damaged JPEG"):
        read_linear(path)


def test_unknown_endings_and_missing_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_bytes(b"1")
    with pytest.raises(InputError, match="unknown picture format"):
        read_linear(tmp_path / "a.xyz")
    with pytest.raises(InputError, match="no such file"):
        read_linear(tmp_path / "gone.png")


def test_a_raw_still_is_linear(tmp_path: Path) -> None:
    path = tmp_path / "a.dng"
    mosaic = np.full((64, 64), 512 + 6502, np.uint16)  # a tenth of the way from black to white
    write_dng(path, mosaic)
    picture = read_linear(path)
    np.testing.assert_allclose(picture[20:40, 20:40], 0.1, rtol=0.02)


def test_a_raw_still_with_highlights_is_not_stretched(tmp_path: Path) -> None:
    """Frames of one turn are compared, so that none may be scaled by what it happens to show."""
    mosaic = np.full((64, 64), 512 + 6502, np.uint16)
    mosaic[:, 40:] = 512 + 9 * 6502
    write_dng(tmp_path / "a.dng", mosaic)
    picture = read_linear(tmp_path / "a.dng")
    np.testing.assert_allclose(picture[20:40, 10:20], 0.1, rtol=0.001)
    np.testing.assert_allclose(picture[20:40, 50:60], 0.9, rtol=0.001)


def test_a_radiance_picture_is_linear_and_unbounded(tmp_path: Path) -> None:
    light = np.zeros((5, 7, 3), np.float32)
    light[..., 0], light[..., 1], light[..., 2] = 12.0, 0.5, 0.03125
    cv2.imwrite(str(tmp_path / "a.hdr"), light[..., ::-1])
    np.testing.assert_allclose(read_linear(tmp_path / "a.hdr"), light, atol=12 / 256)
    assert read_linear(tmp_path / "a.hdr").max() > 11


def test_a_damaged_radiance_picture_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.hdr").write_bytes(b"#?RADIANCE\n")
    with pytest.raises(FormatError, match=r"a\.hdr: damaged, or not a Radiance picture"):
        read_linear(tmp_path / "a.hdr")


@pytest.mark.parametrize("value", [np.nan, np.inf], ids=str)
def test_an_exr_with_values_that_are_no_numbers_is_refused(tmp_path: Path, value: float) -> None:
    light = np.full((4, 4, 3), 0.5, np.float32)
    light[1, 2, 0] = value
    write_picture(tmp_path / "a.exr", light)
    with pytest.raises(FormatError, match=r"a\.exr: 1 pixels hold no finite number"):
        read_linear(tmp_path / "a.exr")


def write_dng(path: Path, mosaic: NDArray[np.uint16]) -> None:
    identity = [1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1]
    tags = [
        (33421, "H", 2, (2, 2), True),
        (33422, "B", 4, bytes([0, 1, 1, 2]), True),
        (50706, "B", 4, bytes([1, 4, 0, 0]), True),
        (50707, "B", 4, bytes([1, 1, 0, 0]), True),
        (50708, "s", 0, "litrig test", True),
        (50714, "H", 1, 512, True),
        (50717, "I", 1, 65535, True),
        (50721, "2i", 9, identity, True),
        (50728, "2I", 3, [1, 1, 1, 1, 1, 1], True),
        (50778, "H", 1, 21, True),
        (271, "s", 0, "litrig", True),
        (272, "s", 0, "test", True),
        (274, "H", 1, 1, True),
    ]
    tifffile.imwrite(path, mosaic, photometric=32803, planarconfig=1, extratags=tags, metadata=None)


def test_a_raw_still_cut_short_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "cut.dng"
    write_dng(path, np.full((64, 64), 7000, np.uint16))
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(FormatError, match=r"cut\.dng"):
        read_linear(path)


def test_opencv_reads_what_is_written(tmp_path: Path, codes: NDArray[np.uint8]) -> None:
    write_codes(tmp_path / "a.png", codes)
    found = cv2.imread(str(tmp_path / "a.png"))
    assert found is not None
    np.testing.assert_array_equal(found[..., ::-1], codes)


def bomb_png() -> bytes:
    """Write a PNG whose header claims 60000 by 60000 pixels, and which is whole otherwise."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">L", len(content)) + kind + content + struct.pack(">L", zlib.crc32(kind + content))

    header = struct.pack(">2L5B", 60000, 60000, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        pytest.param("a.png", bomb_png(), "claims 60000 × 60000 pixels", id="a PNG of 3600 megapixels"),
        pytest.param("a.tif", bomb_png(), "damaged, too large", id="the same, called a TIFF"),
        pytest.param("a.png", b"GIF89a" + bomb_png(), "not a PNG", id="something else with a PNG's end"),
        pytest.param("a.png", bomb_png()[:8] + bomb_png()[-12:], "PNG cut short", id="a PNG without a header"),
        pytest.param("a.tif", b"", "damaged", id="nothing at all"),
    ],
)
def test_a_picture_is_refused_before_it_takes_the_memory(
    tmp_path: Path, name: str, content: bytes, reason: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FormatError, match=f"{name}: .*({reason})"):
        read_codes(tmp_path / name)


def test_an_exr_that_cannot_be_written_is_an_error_with_its_name() -> None:
    with pytest.raises(InputError, match=r"/proc/a\.exr: cannot be written"):
        write_picture(Path("/proc/a.exr"), np.zeros((2, 2, 3)))


def test_each_writer_names_the_endings_that_it_writes(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write \.exr; use \.png, \.jpg or \.tif$"):
        write_codes(tmp_path / "a.exr", np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(InputError, match=r"cannot write \.xyz; use \.png, \.jpg, \.tif or \.exr$"):
        write_picture(tmp_path / "a.xyz", np.zeros((2, 2, 3)))


@pytest.mark.parametrize("ending", [".png", ".tif"])
@pytest.mark.parametrize("bits", [8, 16])
def test_alpha_is_read_as_a_share(tmp_path: Path, ending: str, bits: int) -> None:
    largest = 2**bits - 1
    codes = np.full((2, 3, 4), largest, np.uint8 if bits == 8 else np.uint16)
    codes[0, :, 3] = (0, largest // 3, largest)
    cv2.imwrite(str(tmp_path / f"x{ending}"), codes)
    found = read_coverage(tmp_path / f"x{ending}")
    assert found is not None
    np.testing.assert_allclose(found, np.array([[0, 1 / 3, 1], [1, 1, 1]]), atol=1e-6)


def test_pictures_without_alpha_have_no_coverage(tmp_path: Path) -> None:
    for name in ("x.png", "x.jpg", "x.exr"):
        write_picture(tmp_path / name, np.full((4, 4, 3), 0.5, np.float32))
        assert read_coverage(tmp_path / name) is None


def test_the_alpha_of_a_damaged_picture_is_refused(tmp_path: Path) -> None:
    for name in ("x.png", "x.exr"):
        (tmp_path / name).write_bytes(b"no picture")
        with pytest.raises(FormatError, match=name):
            read_coverage(tmp_path / name)
