"""A writer of packed `.ptm` files, from the description of the format alone."""

import struct
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

U8 = NDArray[np.uint8]
SCALES, BIASES = (0.5, 0.25, 1.0, 2.0, 1.0, 1.5), (128, 100, 7, 0, 255, 12)


def packed_ptm(
    planes: U8,
    *,
    quality: int = 90,
    order: Sequence[int] | None = None,
    references: Sequence[int] | None = None,
    transforms: Sequence[int] | None = None,
    changes: dict[int, str] | None = None,
) -> bytes:
    """Pack planes (9 or 18, H, W), the bottom row first, without loss: what the JPEGs lose stands in side information.

    Parameters
    ----------
    order : the place of each plane in the order in which a reader completes them
    references : the plane that each is predicted from, or -1
    transforms : 1 where the reference is turned over
    changes : lines of the header to be replaced, by their number
    """
    count, height, width = planes.shape
    order = range(count) if order is None else order
    references = [-1] * count if references is None else references
    transforms = [0] * count if transforms is None else transforms
    streams, mends = [], []
    for plane in range(count):
        predicted = np.full((height, width), 128)
        if references[plane] >= 0:
            reference = planes[references[plane]].astype(int)
            predicted = 255 - reference if transforms[plane] else reference
        difference = (planes[plane].astype(int) - predicted + 128) % 256
        good, encoded = cv2.imencode(".jpg", difference.astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, quality])
        assert good
        seen = cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE)
        assert seen is not None
        decoded = (seen.astype(int) + predicted - 128) % 256
        wrong = np.flatnonzero(decoded.ravel() != planes[plane].ravel())
        streams.append(encoded.tobytes())
        mends.append(b"".join(struct.pack(">IB", place, planes[plane].ravel()[place]) for place in wrong))
    zeros = [0] * count
    lists = [transforms, zeros, zeros, order, references, [len(s) for s in streams], [len(m) for m in mends]]
    kind = "PTM_FORMAT_JPEG_LRGB" if count == 9 else "PTM_FORMAT_JPEG_RGB"
    lines = ["PTM_1.2", kind, str(width), str(height), " ".join(map(str, SCALES)), " ".join(map(str, BIASES))]
    lines += [str(quality), *(" ".join(map(str, values)) for values in lists)]
    for number, line in (changes or {}).items():
        lines[number] = line
    header = "".join(line + "\n" for line in lines).encode()
    return header + b"".join(stream + mend for stream, mend in zip(streams, mends, strict=True))
