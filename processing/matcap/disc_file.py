"""Pictures of discs, and their masks, in and out of files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import DISPLAY_ENDINGS, read_coverage, read_linear, write_codes, write_picture
from litrig.base.radiometry import U8, decode_srgb, decode_srgb_codes, encode_srgb, to_u8
from processing.matcap.disc import check_disc
from processing.matcap.matcap_exr import ENDING as MATCAP_ENDING
from processing.matcap.separation.blend import Blend, above

F32 = NDArray[np.float32]
Bools = NDArray[np.bool_]
_OPAQUE = _WHITE = 1 - 1 / 512


@dataclass(frozen=True)
class DiscPicture:
    """A MatCap as it was read.

    Attributes
    ----------
    colours : (S, S, 3) float32 linear light
    covered : (S, S) bool, what its alpha and a mask leave; None is all of it
    """

    colours: F32
    covered: Bools | None


def read_disc(path: Path, mask: Path | None = None) -> DiscPicture:
    """Read a MatCap; what is not opaque is no data, nor what is dark in the mask.

    Raises
    ------
    InputError, FormatError
        A file cannot be read, is no MatCap, or the mask is of another size.
    """
    if path.name.lower().endswith(MATCAP_ENDING):
        raise InputError(f"{path}: is decomposed already; give a picture, as litrig matcap edit draws it")
    colours = read_linear(path)
    check_disc(colours, str(path))
    covered = None
    coverage = read_coverage(path)
    if coverage is not None:
        covered = coverage >= _OPAQUE
    if mask is not None:
        bright = read_linear(mask).max(axis=2)
        if bright.shape != colours.shape[:2]:
            raise InputError(
                f"{mask}: {bright.shape[1]} × {bright.shape[0]}, but the MatCap is {colours.shape[1]} × "
                f"{colours.shape[0]}; give a mask of its size"
            )
        kept = bright > float(decode_srgb(np.array(0.5)))
        covered = kept if covered is None else covered & kept
    return DiscPicture(colours, covered)


def cut_off_at_white(path: Path, colours: F32) -> Bools:
    """Tell which pixels (S, S) of a picture may have been brighter than its file can hold: none of a linear one."""
    if path.suffix.lower() not in DISPLAY_ENDINGS:
        return np.zeros(colours.shape[:2], bool)
    return np.asarray(colours.max(axis=2) >= _WHITE)


def write_layers(low_path: Path, high_path: Path, low: NDArray[np.floating], whole: F32, blend: Blend) -> None:
    """Write a low layer (S, S, 3), and the high one that makes the whole out of it.

    In 8 bits the low one is rounded down, and the high one holds what it lost.

    Raises
    ------
    InputError
        A layer cannot be written, or the whole is too bright for the blend; then there is neither.
    """
    codes: U8 | None = None
    stored = np.minimum(low.astype(np.float32), whole)
    if low_path.suffix.lower() in DISPLAY_ENDINGS:
        codes = to_u8(encode_srgb(low))
        codes -= (decode_srgb_codes(codes) > low) & (codes > 0)
        stored = decode_srgb_codes(codes)
    try:
        high = above(whole, np.minimum(stored, whole), blend).astype(np.float32)
    except InputError as error:
        raise InputError(f"{high_path}: {error}") from error
    if codes is None:
        write_picture(low_path, stored)
    else:
        write_codes(low_path, codes)
    write_picture(high_path, high)
