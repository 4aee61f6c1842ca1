from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import FormatError
from processing.ptm.files.ptm_file import describe_ptm, read_ptm
from tests.processing.ptm.files.jpeg_ptm import BIASES, SCALES, U8, packed_ptm

HEIGHT, WIDTH = 11, 19


def some_planes(count: int) -> U8:
    """Smooth planes with a few pixels of noise, so that prediction and side information have work."""
    random = np.random.default_rng(count)
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    planes = np.stack([128 + 90 * np.sin(x / 5 + plane) * np.cos(y / (4 + plane)) for plane in range(count)])
    planes[:, random.integers(0, HEIGHT, 9), random.integers(0, WIDTH, 9)] = random.uniform(0, 255, 9)
    codes: U8 = np.rint(planes).astype(np.uint8)
    return codes


def check(path: Path, planes: U8) -> None:
    ptm = read_ptm(path)
    steps = list(zip(SCALES, BIASES, strict=True))
    for channel in range(ptm.coefficients.shape[3]):
        for term, (scale, bias) in enumerate(steps):
            wanted = scale * (planes[6 * channel + term, ::-1].astype(float) - bias) / 255
            assert ptm.coefficients[term, ..., channel] == pytest.approx(wanted, abs=1e-5)
    if len(planes) == 9:
        assert ptm.colour is not None
        assert ptm.colour * 255 == pytest.approx(planes[6:, ::-1].transpose(1, 2, 0).astype(float), abs=1e-4)


@pytest.mark.parametrize("count", [9, 18], ids=["lrgb", "rgb"])
def test_planes_of_their_own_are_read(tmp_path: Path, count: int) -> None:
    planes = some_planes(count)
    (tmp_path / "x.ptm").write_bytes(packed_ptm(planes))
    check(tmp_path / "x.ptm", planes)


def test_predicted_planes_are_completed_in_their_order(tmp_path: Path) -> None:
    """Plane 0 is the last of a chain 5, 3, 0, so that the planes' own order would be wrong."""
    planes = some_planes(9)
    order, references = [5, 4, 3, 2, 6, 0, 1, 7, 8], [3, -1, -1, 5, 0, -1, 5, 6, 6]
    for transforms in ([0] * 9, [1, 0, 0, 1, 0, 0, 1, 1, 0]):
        (tmp_path / "x.ptm").write_bytes(packed_ptm(planes, order=order, references=references, transforms=transforms))
        check(tmp_path / "x.ptm", planes)


def test_an_order_from_one_and_a_byte_to_spare_are_read(tmp_path: Path) -> None:
    planes = some_planes(9)
    (tmp_path / "x.ptm").write_bytes(packed_ptm(planes, changes={10: "1 2 3 4 5 6 7 8 9"}) + b"\0")
    check(tmp_path / "x.ptm", planes)


def test_a_packed_file_is_described_as_a_plain_one(tmp_path: Path) -> None:
    (tmp_path / "x.ptm").write_bytes(packed_ptm(some_planes(9)))
    facts = describe_ptm(tmp_path / "x.ptm")
    assert (facts["width"], facts["height"], facts["colour"]) == (WIDTH, HEIGHT, "lrgb")
    assert facts["coefficients"]["u2"] == pytest.approx((-0.5 * 128 / 255, 0.5 * 127 / 255))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        pytest.param({7: "0 0 0"}, "numbers before its JPEGs are damaged", id="three transforms"),
        pytest.param({7: "2 0 0 0 0 0 0 0 0"}, "transform is unknown", id="a transform"),
        pytest.param({8: "1 0 0 0 0 0 0 0 0"}, "motion is compensated", id="motion"),
        pytest.param({10: "0 0 2 3 4 5 6 7 8"}, "order of its planes is none", id="one place twice"),
        pytest.param({11: "0 -1 -1 -1 -1 -1 -1 -1 -1"}, "plane 0 refers to plane 0", id="a plane by itself"),
        pytest.param({11: "1 -1 -1 -1 -1 -1 -1 -1 -1"}, "plane 0 refers to plane 1", id="a plane by a later one"),
        pytest.param({11: "-1 99 -1 -1 -1 -1 -1 -1 -1"}, "plane 1 refers to plane 99", id="by one that is none"),
        pytest.param({12: "-5 1 1 1 1 1 1 1 1"}, "less than no bytes", id="a negative size"),
        pytest.param({12: " ".join(["999999999"] * 9)}, "planes want .* it was cut short", id="gigabytes not there"),
        pytest.param({12: "3 1 1 1 1 1 1 1 1"}, "plane 0 is a damaged JPEG", id="a JPEG of three bytes"),
        pytest.param({2: "18"}, "plane 0 is 19 × 11 pixels, where 18 × 11", id="another width"),
        pytest.param({2: "20000", 3: "20000"}, "plane 0 is 19 × 11 pixels", id="a header of gigabytes"),
    ],
)
def test_a_lie_in_the_header_is_named(tmp_path: Path, changes: dict[int, str], reason: str) -> None:
    (tmp_path / "bad.ptm").write_bytes(packed_ptm(some_planes(9), changes=changes))
    with pytest.raises(FormatError, match=rf"bad\.ptm: .*{reason}"):
        read_ptm(tmp_path / "bad.ptm")


def test_a_file_cut_short_is_named(tmp_path: Path) -> None:
    (tmp_path / "bad.ptm").write_bytes(packed_ptm(some_planes(9))[:-1])
    with pytest.raises(FormatError, match=r"bad\.ptm: its planes want"):
        read_ptm(tmp_path / "bad.ptm")


def test_side_information_outside_the_picture_is_refused(tmp_path: Path) -> None:
    content = bytearray(packed_ptm(some_planes(9)))
    assert content[-5:-1] != b"\xff\xff\xff\xff"
    content[-5:-1] = b"\xff\xff\xff\xff"
    (tmp_path / "bad.ptm").write_bytes(content)
    with pytest.raises(FormatError, match=r"bad\.ptm: the side information of plane 8 mends pixels outside"):
        read_ptm(tmp_path / "bad.ptm")
