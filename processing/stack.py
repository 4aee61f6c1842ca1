"""Frames of one scene, read when they are asked for: a session of any length needs the memory of one picture."""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder.capture import Capture, Role
from litrig.base.errors import FormatError, InputError
from litrig.base.pictures import DISPLAY_ENDINGS, read_codes, read_encoded, read_linear
from litrig.base.radiometry import Codes, decode_srgb_codes, encode_srgb
from processing.composite import Composite, pictures_of

F32 = NDArray[np.float32]
Space = Literal["srgb", "linear"]
Window = tuple[slice, slice]
"""Rows and columns of a part of a picture."""
Picture = TypeVar("Picture", F32, Codes)
Result = TypeVar("Result")
_AT_ONCE = min(4, os.cpu_count() or 1)
Correction = Callable[[F32], F32]


class Stack:
    """Pictures of one size in their order.

    Parameters
    ----------
    pictures : the picture files, or what makes a picture of several
    correct : what is done to the linear light (H, W, 3) of each, such as taking out a lens's distortion
    """

    def __init__(self, pictures: Sequence[Path | Composite], correct: Correction | None = None) -> None:
        if not pictures:
            raise InputError("a stack of no pictures; name at least one")
        self._pictures = tuple(pictures)
        self.paths = tuple(picture.path if isinstance(picture, Composite) else picture for picture in pictures)
        self._correct = correct
        self._shape: tuple[int, int] | None = None

    @classmethod
    def of(cls, capture: Capture, role: Role = Role.FRAME, correct: Correction | None = None) -> "Stack":
        """Take the frames of one role from a capture folder.

        Raises
        ------
        InputError
            The folder has none.
        """
        frames = list(capture.having(role))
        if not frames:
            raise InputError(f"{capture.folder}: has no pictures of role {role}; capture it, or name the folder anew")
        return cls(pictures_of(capture, frames), correct)

    def __len__(self) -> int:
        return len(self.paths)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width that every picture must have: those of the first."""
        if self._shape is None:
            self.linear(0)
        assert self._shape is not None  # noqa: S101  # for the type checker: reading sets it
        return self._shape

    def each(self, window: Window, work: Callable[[int, F32], Result]) -> Iterator[Result]:
        """Read a part of every picture as linear light and work on it, a few at a time.

        Parameters
        ----------
        window : rows and columns, with start and stop
        work : what to do with a picture's index and part; called from several threads

        Yields
        ------
        results : in the order of the pictures

        Raises
        ------
        InputError, FormatError
            As `linear`.
        """
        with ThreadPoolExecutor(_AT_ONCE) as workers:
            coming: deque[Future[Result]] = deque()
            for index in range(len(self)):
                coming.append(workers.submit(lambda place: work(place, self._part(place, window)), index))
                if len(coming) > _AT_ONCE:
                    yield coming.popleft().result()
            while coming:
                yield coming.popleft().result()

    def _part(self, index: int, window: Window) -> F32:
        if not self._is_as_stored(index):
            return np.ascontiguousarray(self.linear(index)[window])
        # Codes are cut out before they become floats, which are four times as large.
        return decode_srgb_codes(self._checked(index, read_codes(self.paths[index]))[window])

    def linear(self, index: int) -> F32:
        """Read one picture as linear light, (H, W, 3) float32, row 0 on top.

        Raises
        ------
        InputError, FormatError
            The file is missing, damaged, or of another size than the first; the message names it.
        """
        picture = self._pictures[index]
        light = picture.linear() if isinstance(picture, Composite) else read_linear(picture)
        return self.corrected(self._checked(index, light))

    def stored(self, index: int, into: Codes | F32 | None = None) -> Codes | F32:
        """Read one picture as it is kept in its file: codes (H, W, 3) of 8 or 16 bits, or linear float32.

        Parameters
        ----------
        into : where the picture may be put if it is as large and of that kind; what is returned tells

        Raises
        ------
        InputError, FormatError
            As `linear`.
        """
        if not self._is_as_stored(index):
            return self.linear(index)
        path = self.paths[index]
        return self._checked(index, read_codes(path, into if into is not None and into.dtype == np.uint8 else None))

    def corrected(self, picture: F32) -> F32:
        """Do to any picture (H, W, 3) of linear light what is done to those of the stack."""
        return picture if self._correct is None else self._correct(picture)

    def encoded(self, index: int) -> F32:
        """Read one picture as display values (H, W, 3) float32 0..1; errors as for `linear`."""
        if self._correct is not None or isinstance(self._pictures[index], Composite):
            return encode_srgb(self.linear(index))
        return self._checked(index, read_encoded(self.paths[index]))

    def frame(self, index: int, space: Space) -> F32:
        """Read one picture in the space that is asked for."""
        return self.linear(index) if space == "linear" else self.encoded(index)

    def _is_as_stored(self, index: int) -> bool:
        """Tell whether a picture is what a file of display values holds, and nothing else."""
        is_file = not isinstance(self._pictures[index], Composite)
        return is_file and self._correct is None and self.paths[index].suffix.lower() in DISPLAY_ENDINGS

    def _checked(self, index: int, picture: Picture) -> Picture:
        height, width = picture.shape[:2]
        if self._shape is None:
            self._shape = (height, width)
        if (height, width) != self._shape:
            raise FormatError(
                f"{self.paths[index]}: is {width} × {height} pixels, the pictures before it are "
                f"{self._shape[1]} × {self._shape[0]}; shoot it again at that size, or take it out"
            )
        return picture
