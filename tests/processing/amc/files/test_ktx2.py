"""AMC files: every byte as the Khronos specification has it, and no lie in a head believed."""

import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.radiometry import decode_srgb, encode_srgb
from litrig.base.table_normals import TableNormal
from processing.amc.files.ktx2 import read_amc, read_header, read_levels, write_amc
from processing.amc.model import Amc, TangentAngle


def some_amc(size: int = 6, depth: int = 5, seed: int = 0, brightest: float = 1.0) -> Amc:
    random = np.random.default_rng(seed)
    slices = (random.random((depth, size, size, 3)) * brightest).astype(np.float32)
    valid = random.random((depth, size, size)) > 0.3
    return Amc(slices, valid, 2, TableNormal.VIEW, (0.0, 36.25, 72.5), "sha256:0a1b", TangentAngle.SURFACE)


def read_by_the_book(content: bytes) -> dict[str, Any]:
    """Read a KTX 2.0 file from the format's description alone."""
    assert content[:12] == bytes([0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A])
    names = ["vkFormat", "typeSize", "width", "height", "depth", "layers", "faces", "levels", "scheme"]
    head: dict[str, Any] = dict(zip(names, struct.unpack_from("<9I", content, 12), strict=True))
    dfd_at, dfd_length, kvd_at, kvd_length = struct.unpack_from("<4I", content, 48)
    head["sgd"] = struct.unpack_from("<2Q", content, 64)
    head["index"] = [struct.unpack_from("<3Q", content, 80 + 24 * level) for level in range(head["levels"])]
    assert dfd_at == 80 + 24 * head["levels"]
    assert kvd_at == dfd_at + dfd_length
    head["dfd"] = content[dfd_at : dfd_at + dfd_length]
    head["end_of_keys"] = kvd_at + kvd_length
    head["keys"] = []
    at = kvd_at
    while at < kvd_at + kvd_length:
        (length,) = struct.unpack_from("<I", content, at)
        key, _, value = content[at + 4 : at + 4 + length].partition(b"\0")
        head["keys"].append((key.decode(), value))
        at += 4 + (length + 3) // 4 * 4
    assert at == kvd_at + kvd_length
    head["data"] = []
    for offset, length, unpacked in head["index"]:
        stored = content[offset : offset + length]
        plain = zstandard.ZstdDecompressor().decompress(stored) if head["scheme"] == 2 else stored
        assert len(plain) == unpacked
        head["data"].append(plain)
    return head


def texels_by_the_book(head: dict[str, Any], level: int) -> NDArray[np.floating]:
    kind = np.dtype("<f2") if head["vkFormat"] == 97 else np.dtype("u1")
    shape = [max(1, head[side] >> level) for side in ("depth", "height", "width")]
    return np.frombuffer(head["data"][level], kind).reshape(*shape, 4).astype(np.float64)


@pytest.mark.parametrize("half_float", [False, True], ids=["8-bit", "half"])
@pytest.mark.parametrize("compress", [False, True], ids=["plain", "Zstandard"])
def test_an_independent_reader_finds_the_table(tmp_path: Path, half_float: bool, compress: bool) -> None:
    amc = some_amc()
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, amc, half_float=half_float, compress=compress)
    head = read_by_the_book(path.read_bytes())
    assert [head[name] for name in ("vkFormat", "typeSize")] == ([97, 2] if half_float else [43, 1])
    assert [head[name] for name in ("width", "height", "depth", "layers", "faces", "levels")] == [6, 6, 5, 0, 1, 3]
    assert head["scheme"] == (2 if compress else 0)
    assert head["sgd"] == (0, 0)
    texels = texels_by_the_book(head, 0)
    expected = amc.slices if half_float else encode_srgb(amc.slices) * 255
    np.testing.assert_allclose(texels[..., :3], expected, atol=2**-11 if half_float else 0.5001)
    np.testing.assert_array_equal(texels[..., 3] > 0, amc.valid)


def test_levels_lie_smallest_first_and_aligned(tmp_path: Path) -> None:
    write_amc(tmp_path / "x.amc.ktx2", some_amc(size=5, depth=3), half_float=True, compress=False)
    content = (tmp_path / "x.amc.ktx2").read_bytes()
    head = read_by_the_book(content)
    offsets = [offset for offset, _, _ in head["index"]]
    assert offsets == sorted(offsets, reverse=True)
    assert all(offset % 8 == 0 for offset in offsets), "a texel of four halves starts at a multiple of its size"
    assert 0 <= offsets[-1] - head["end_of_keys"] < 8
    assert sum(head["index"][0][:2]) == len(content)


def test_packed_levels_follow_without_a_gap(tmp_path: Path) -> None:
    write_amc(tmp_path / "x.amc.ktx2", some_amc())
    head = read_by_the_book((tmp_path / "x.amc.ktx2").read_bytes())
    at = head["end_of_keys"]
    for offset, length, _ in reversed(head["index"]):
        assert offset == at
        at += length


@pytest.mark.parametrize("half_float", [False, True], ids=["8-bit", "half"])
def test_the_data_format_descriptor_says_what_the_texels_are(tmp_path: Path, half_float: bool) -> None:
    write_amc(tmp_path / "x.amc.ktx2", some_amc(), half_float=half_float)
    dfd = read_by_the_book((tmp_path / "x.amc.ktx2").read_bytes())["dfd"]
    total, vendor_and_type, version, block_size = struct.unpack_from("<IIHH", dfd)
    assert (total, vendor_and_type, version, block_size) == (92, 0, 2, 88) and len(dfd) == 92
    model, primaries, transfer, flags = dfd[12:16]
    assert (model, primaries, flags) == (1, 1, 0), "RGBSDA, BT.709, straight alpha"
    assert transfer == (1 if half_float else 2), "linear halves, sRGB codes"
    assert dfd[16:20] == bytes(4), "texel blocks of one texel"
    assert dfd[20:28] == bytes([8 if half_float else 4, *[0] * 7])
    bits = 16 if half_float else 8
    for number, channel in enumerate((0, 1, 2, 15)):
        offset, length, kind, position, lower, upper = struct.unpack_from("<HBBIII", dfd, 28 + 16 * number)
        assert (offset, length, position) == (bits * number, bits - 1, 0)
        assert kind & 0x0F == channel
        if half_float:
            assert kind & 0xF0 == 0xC0, "signed float"
            assert struct.unpack("<2f", struct.pack("<2I", lower, upper)) == (-1.0, 1.0)
        else:
            assert kind & 0xF0 == (0x10 if channel == 15 else 0), "alpha alone is linear"
            assert (lower, upper) == (0, 255)


def test_the_keys_are_sorted_and_say_what_the_table_means(tmp_path: Path) -> None:
    write_amc(tmp_path / "x.amc.ktx2", some_amc())
    keys = read_by_the_book((tmp_path / "x.amc.ktx2").read_bytes())["keys"]
    assert [key for key, _ in keys] == ["KTXorientation", "KTXwriter", "litrig.amc"]
    values = dict(keys)
    assert values["KTXorientation"] == b"rdi\0"
    assert values["KTXwriter"].startswith(b"litrig ")
    meaning = json.loads(values["litrig.amc"].rstrip(b"\0"))
    assert meaning.pop("litrig")
    assert meaning == {
        "invariance": 2,
        "table_normal": "view",
        "slice_angles_deg": [0.0, 36.25, 72.5],
        "source": "sha256:0a1b",
        "tangent_angle": "surface",
    }


@given(
    size=st.integers(1, 9),
    depth=st.integers(1, 9),
    half_float=st.booleans(),
    mip_levels=st.booleans(),
    compress=st.booleans(),
    seed=st.integers(0, 99),
)
def test_what_was_written_is_read(
    tmp_path_factory: pytest.TempPathFactory,
    size: int,
    depth: int,
    half_float: bool,
    mip_levels: bool,
    compress: bool,
    seed: int,
) -> None:
    path = tmp_path_factory.mktemp("amc") / "x.amc.ktx2"
    amc = some_amc(size, depth, seed)
    write_amc(path, amc, half_float=half_float, mip_levels=mip_levels, compress=compress)
    back = read_amc(path)
    if half_float:
        np.testing.assert_array_equal(back.slices, amc.slices.astype(np.float16).astype(np.float32))
    else:
        assert np.abs(encode_srgb(back.slices) - encode_srgb(amc.slices)).max() * 255 < 0.501
    np.testing.assert_array_equal(back.valid, amc.valid)
    assert (back.invariance, back.table_normal) == (amc.invariance, amc.table_normal)
    assert (back.slice_angles_deg, back.source) == (amc.slice_angles_deg, amc.source)
    assert back.tangent_angle is read_header(path).tangent_angle is TangentAngle.SURFACE
    header = read_header(path)
    assert (header.size, header.depth, header.half_float, header.compressed) == (size, depth, half_float, compress)
    assert header.levels == (max(size, depth).bit_length() if mip_levels else 1)


def test_reading_and_writing_again_changes_nothing(tmp_path: Path) -> None:
    write_amc(tmp_path / "a.amc.ktx2", some_amc(), mip_levels=False)
    write_amc(tmp_path / "b.amc.ktx2", read_amc(tmp_path / "a.amc.ktx2"), mip_levels=False)
    assert (tmp_path / "a.amc.ktx2").read_bytes() == (tmp_path / "b.amc.ktx2").read_bytes()


def test_a_file_that_does_not_say_what_k_counts_means_the_picture(tmp_path: Path) -> None:
    """As all files before the key was there."""
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc())
    said = b',"tangent_angle":"surface"'
    content = path.read_bytes()
    assert said in content
    path.write_bytes(content.replace(said, b" " * len(said)))
    assert read_amc(path).tangent_angle is TangentAngle.PICTURE


def test_an_isotropic_table_keeps_its_name(tmp_path: Path) -> None:
    one = some_amc(depth=1)
    write_amc(tmp_path / "x.amc.ktx2", Amc(one.slices, one.valid, "isotropic"))
    assert read_header(tmp_path / "x.amc.ktx2").invariance == "isotropic"


def test_stored_levels_are_those_of_linear_light(tmp_path: Path) -> None:
    """Black and white checks shrink to half the light, not to half the code."""
    checks = np.indices((2, 4, 4)).sum(axis=0) % 2
    slices = np.repeat(checks[..., None], 3, axis=-1).astype(np.float32)
    write_amc(tmp_path / "x.amc.ktx2", Amc(slices, np.ones((2, 4, 4), bool), 1))
    _, levels = read_levels(tmp_path / "x.amc.ktx2")
    assert [level.colours.shape[:3] for level in levels] == [(2, 4, 4), (1, 2, 2), (1, 1, 1)]
    np.testing.assert_allclose(levels[1].colours, decode_srgb(np.array(188 / 255)), atol=1e-6)


@pytest.mark.parametrize("brightest", [1.0, 1.004], ids=["white", "white within half a code"])
def test_colours_that_fit_take_eight_bits(tmp_path: Path, brightest: float) -> None:
    amc = some_amc()
    amc.slices[0, 0, 0] = brightest
    write_amc(tmp_path / "x.amc.ktx2", amc)
    assert not read_header(tmp_path / "x.amc.ktx2").half_float


@pytest.mark.parametrize("outside", [1.2, 40.0, -0.1])
def test_colours_that_do_not_fit_are_not_cut_off(tmp_path: Path, outside: float) -> None:
    amc = some_amc()
    amc.slices[1, 2, 3, 0] = outside
    write_amc(tmp_path / "x.amc.ktx2", amc)
    assert read_amc(tmp_path / "x.amc.ktx2").slices[1, 2, 3, 0] == np.float32(np.float16(outside))
    with pytest.raises(InputError, match="store half floats"):
        write_amc(tmp_path / "y.amc.ktx2", amc, half_float=False)
    assert not (tmp_path / "y.amc.ktx2").exists()


@pytest.mark.parametrize(
    ("slices", "valid", "invariance", "reason"),
    [
        pytest.param((2, 4, 5, 3), (2, 4, 5), 1, "are no AMC", id="slices that are not square"),
        pytest.param((2, 4, 4, 3), (2, 4, 5), 1, "are no AMC", id="validity of another size"),
        pytest.param((0, 4, 4, 3), (0, 4, 4), 1, "are no AMC", id="no slice at all"),
        pytest.param((2, 4, 4, 3), (2, 4, 4), "isotropic", "one slice", id="isotropic with two slices"),
    ],
)
def test_arrays_that_make_no_amc_are_refused(
    tmp_path: Path, slices: tuple[int, ...], valid: tuple[int, ...], invariance: Any, reason: str
) -> None:
    amc = Amc(np.zeros(slices, np.float32), np.ones(valid, bool), invariance)
    with pytest.raises(InputError, match=reason):
        write_amc(tmp_path / "x.amc.ktx2", amc)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e6])
def test_no_numbers_and_too_bright_ones_are_refused(tmp_path: Path, value: float) -> None:
    amc = some_amc()
    amc.slices[0, 1, 1] = value
    with pytest.raises(InputError, match="half floats end at"):
        write_amc(tmp_path / "x.amc.ktx2", amc)


def change(content: bytes, at: int, form: str, *values: int) -> bytes:
    changed = bytearray(content)
    struct.pack_into(form, changed, at, *values)
    return bytes(changed)


@pytest.mark.parametrize(
    ("at", "form", "values", "reason"),
    [
        pytest.param(0, "<B", (0x89,), "not a KTX 2.0 file", id="another identifier"),
        pytest.param(12, "<I", (37,), "texel format 37", id="a texel format that no AMC has"),
        pytest.param(16, "<I", (4,), "type size 4", id="a type size that contradicts the format"),
        pytest.param(20, "<3I", (1 << 20, 1 << 20, 1 << 20), "1048576 × 1048576", id="an exabyte of texels"),
        pytest.param(20, "<3I", (2048, 2048, 2048), "its texels take", id="the largest volume in a few bytes"),
        pytest.param(20, "<2I", (6, 7), "square slices", id="slices that are not square"),
        pytest.param(20, "<3I", (0, 0, 5), "square slices", id="nothing"),
        pytest.param(28, "<I", (0,), "1 to 2048", id="a picture, not a volume"),
        pytest.param(32, "<I", (4,), "not one volume", id="an array of volumes"),
        pytest.param(36, "<I", (6,), "not one volume", id="a cube map"),
        pytest.param(40, "<I", (9,), "claims 9 mip levels", id="more levels than there can be"),
        pytest.param(40, "<I", (2**32 - 1,), "claims 4294967295 mip levels", id="levels without end"),
        pytest.param(44, "<I", (1,), "scheme 1", id="packed by another scheme"),
        pytest.param(56, "<2I", (2**32 - 8, 64), "key/value data ends", id="keys past the end"),
        pytest.param(60, "<I", (2**32 - 1,), "key/value data ends", id="keys without end"),
        pytest.param(64, "<2Q", (80, 16), "global data", id="global data that its scheme does not have"),
        pytest.param(80, "<Q", (2**63,), "cut short: level 0", id="a level past the end"),
        pytest.param(88, "<Q", (2**40,), "cut short: level 0", id="a level without end"),
        pytest.param(96, "<Q", (2**40,), "claims 1,099,511,627,776 bytes", id="a level that unpacks to a terabyte"),
        pytest.param(152 + 15, "<B", (1,), "multiplied by alpha", id="premultiplied colours"),
        pytest.param(152 + 92, "<I", (2**31,), "damaged", id="a key without end"),
    ],
)
def test_a_lying_head_is_refused(tmp_path: Path, at: int, form: str, values: tuple[int, ...], reason: str) -> None:
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc())
    path.write_bytes(change(path.read_bytes(), at, form, *values))
    for read in (read_header, read_amc):
        with pytest.raises(FormatError, match=reason) as caught:
            read(path)
        assert str(path) in str(caught.value)


@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(tmp_path_factory: pytest.TempPathFactory, share: float) -> None:
    path = tmp_path_factory.mktemp("amc") / "x.amc.ktx2"
    write_amc(path, some_amc())
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FormatError, match=r"cut short|not a KTX"):
        read_header(path)


@given(at=st.integers(0, 10_000), value=st.integers(0, 255))
def test_one_wrong_byte_is_an_error_or_a_table(tmp_path_factory: pytest.TempPathFactory, at: int, value: int) -> None:
    """Whatever a byte is changed to, the reader neither crashes nor asks for more than the file can hold."""
    path = tmp_path_factory.mktemp("amc") / "x.amc.ktx2"
    write_amc(path, some_amc())
    content = bytearray(path.read_bytes())
    content[at % len(content)] = value
    path.write_bytes(content)
    try:
        _, levels = read_levels(path)
    except FormatError:
        return
    assert sum(level.colours.nbytes for level in levels) < 1 << 20


def bomb(unpacked: int, *, honest_frame: bool) -> bytes:
    """Pack zeros, with or without their number in the frame's head."""
    packer = zstandard.ZstdCompressor(write_content_size=honest_frame)
    if honest_frame:
        return packer.compress(bytes(unpacked))
    stream = io.BytesIO()
    with packer.stream_writer(stream, closefd=False) as writer:
        writer.write(bytes(unpacked))
    return stream.getvalue()


@pytest.mark.parametrize("honest_frame", [True, False], ids=["size in the frame", "no size in the frame"])
@pytest.mark.parametrize("unpacked", [5 * 6 * 6 * 4 - 1, 5 * 6 * 6 * 4 + 1, 1 << 26], ids=["short", "long", "bomb"])
def test_a_level_of_another_size_than_promised_is_refused(tmp_path: Path, unpacked: int, honest_frame: bool) -> None:
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc(), mip_levels=False)
    content = path.read_bytes()
    (offset,) = struct.unpack_from("<Q", content, 80)
    packed = bomb(unpacked, honest_frame=honest_frame)
    path.write_bytes(change(content[:offset] + packed, 88, "<Q", len(packed)))
    with pytest.raises(FormatError, match=r"unpacks to|is damaged"):
        read_amc(path)


def test_an_honest_head_that_unpacks_too_well_is_refused(tmp_path: Path) -> None:
    """Half a gigabyte of black that packs into some kilobytes is a bomb, not a material."""
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc(), mip_levels=False)
    content = change(path.read_bytes(), 20, "<3I", 512, 512, 512)
    path.write_bytes(change(content, 96, "<Q", 512**3 * 4))
    with pytest.raises(FormatError, match="more than 200 to 1; refused"):
        read_header(path)


@pytest.mark.parametrize(
    ("meaning", "reason"),
    [
        pytest.param("{}", "invariance", id="nothing said"),
        pytest.param('{"invariance": 0, "table_normal": "view", "litrig": "1"}', "invariance", id="R of zero"),
        pytest.param('{"invariance": "both", "table_normal": "view", "litrig": "1"}', "invariance", id="R in words"),
        pytest.param('{"invariance": 1, "table_normal": "up", "litrig": "1"}', "table_normal", id="unknown normal"),
        pytest.param('{"invariance": 1, "table_normal": "view", "litrig": "1", "x": 1}', "x", id="unknown key"),
        pytest.param(
            '{"invariance": 1, "table_normal": "view", "litrig": "1", "tangent_angle": "eye"}',
            "tangent_angle",
            id="unknown kind of angle",
        ),
        pytest.param(
            '{"invariance": "isotropic", "table_normal": "view", "litrig": "1"}', "5 slices", id="contradiction"
        ),
        pytest.param("[" * 50_000, "litrig.amc", id="brackets without end"),
        pytest.param("\xff\xfe", "litrig.amc", id="no text"),
    ],
)
def test_a_damaged_meaning_is_refused(tmp_path: Path, meaning: str, reason: str) -> None:
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc(), mip_levels=False, compress=False)
    content = path.read_bytes()
    pair = b"litrig.amc\0" + meaning.encode("latin-1")
    keys = struct.pack("<I", len(pair)) + pair + bytes(-len(pair) % 4)
    kvd_at = 80 + 24 + 92
    moved = change(content[:kvd_at] + keys + bytes(5 * 6 * 6 * 4), 60, "<I", len(keys))
    path.write_bytes(change(moved, 80, "<Q", kvd_at + len(keys)))
    with pytest.raises(FormatError, match=reason):
        read_header(path)


def test_a_volume_without_meaning_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc())
    path.write_bytes(path.read_bytes().replace(b"litrig.amc\0", b"litrig.xyz\0"))
    with pytest.raises(FormatError, match=r"no key litrig\.amc"):
        read_header(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.amc\.ktx2: no such file"):
        read_amc(tmp_path / "no.amc.ktx2")


def test_halves_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.amc.ktx2"
    write_amc(path, some_amc(), half_float=True, compress=False)
    content = path.read_bytes()
    path.write_bytes(content[:-8] + b"\x00\x7e" + content[-6:])
    with pytest.raises(FormatError, match="no numbers"):
        read_amc(path)
