"""A rendered picture: float RGBA, and the files it can be written to."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.argument_types import takes_its_types
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Picture", "check_bits"]


@public
@dataclass(frozen=True, eq=False)
class Picture:
    """What `render` and `slice` give; it shows itself in a notebook.

    Attributes
    ----------
    rgba : float32 array, shape (height, width, 4)
        Red, green, blue associated with (multiplied by) opacity, and opacity, 0..1; row 0 is the top.
    depth : float32 array, shape (height, width), or None
        World units along the ray to where it is half absorbed; NaN where it never is.
    value : float32 array, shape (height, width), or None
        For projections and slices: the value, in sample units (sum: times world units); NaN outside the volume.
    report : dict
        How the picture was made: sheets, texels, threads; `notes`, a list of sentences, where it has one colour all
        over; of `render` also `seconds`, the times of its stages:
        `prepare` (bounds of bricks, spline coefficients; next to nothing after the first frame), `plan`, `draw` and
        `warp`.
    """

    rgba: NDArray[np.float32]
    depth: NDArray[np.float32] | None = None
    value: NDArray[np.float32] | None = None
    report: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width = self.rgba.shape[:2]
        return width, height

    @takes_its_types
    def over(self, below: Picture) -> Picture:
        """Lay this picture over another of the same size, as light is composited: details over the whole, say.

        Parameters
        ----------
        below : Picture
            What shows where this picture is transparent.

        Raises
        ------
        ArgumentError
            If the sizes differ.

        Examples
        --------
        >>> import wavesplat as ws
        >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
        >>> whole = ws.render(wavelets, size=(32, 32))
        >>> finest = ws.render(wavelets.bands([1, 0, 0, 0, 0]), size=(32, 32))
        >>> finest.over(whole).size
        (32, 32)
        """
        if self.size != below.size:
            raise ArgumentError(
                f"a picture of {self.size[0]} x {self.size[1]} pixels cannot lie over one of {below.size[0]} x "
                f"{below.size[1]}; draw both in one size"
            )
        return Picture(self.rgba + (1 - self.rgba[..., 3:]) * below.rgba, report={"over": self.report})

    @takes_its_types
    def save(self, path: str | PathLike[str], *, bits: int = 8) -> None:
        """Write the picture to a file; the suffix chooses the format.

        Parameters
        ----------
        path : path
            `.png`: integers, colour not multiplied by opacity. `.tif`, `.tiff`, `.exr`: float32, associated, as in
            `rgba`; an `.exr` file also holds the depth, if there is one, as channel Z.
        bits : 8 or 16, default 8
            Bits per channel of a PNG file.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        ArgumentError
            If `bits` is neither 8 nor 16.

        Examples
        --------
        >>> import os, tempfile, wavesplat as ws
        >>> folder = tempfile.mkdtemp()
        >>> picture = ws.render(ws.examples.ripples(8), size=(16, 16))
        >>> picture.save(f"{folder}/ripples.png")
        >>> os.listdir(folder)
        ['ripples.png']
        """
        from wavesplat._files import output

        suffix = output.check_output(path, "pictures")
        check_bits(bits)
        if suffix == ".png":
            content = self._png(bits)
            output.write_atomically(path, lambda part: part.write_bytes(content))
        elif suffix == ".exr":
            output.write_atomically(path, self._write_exr)
        else:
            output.write_atomically(path, self._write_tiff)

    def _repr_png_(self) -> bytes:
        return self._png(8)

    def _png(self, bits: int) -> bytes:
        return _native.encode_png(np.ascontiguousarray(self.rgba, dtype=np.float32), bits)

    def _write_tiff(self, path: Path) -> None:
        import tifffile

        tifffile.imwrite(
            path, self.rgba, photometric="rgb", extrasamples=["assocalpha"], compression="zlib", metadata=None
        )

    def _write_exr(self, path: Path) -> None:
        import OpenEXR

        channels: dict[str, NDArray[np.float32]] = {"RGBA": np.ascontiguousarray(self.rgba)}
        if self.depth is not None:
            channels["Z"] = np.ascontiguousarray(np.nan_to_num(self.depth, nan=np.inf))
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        try:
            with OpenEXR.File(header, channels) as file:
                file.write(str(path))
        except (RuntimeError, ValueError) as error:
            raise OSError(str(error)) from error


def check_bits(bits: int) -> None:
    """An `ArgumentError` if a PNG file cannot have so many bits per channel."""
    if bits not in (8, 16):
        raise ArgumentError(f"bits is {bits!r}; a PNG file has 8 or 16 bits per channel")
