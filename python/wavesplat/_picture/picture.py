"""A rendered picture: float RGBA, and the files it can be written to."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from wavesplat._model.argument_types import takes_its_types
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Picture", "check_bits", "check_dpi"]

#: More than any printer has.
MOST_DPI = 10_000


@public
@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """What `render` and `slice` give; it shows itself in a notebook.

    `np.asarray(picture)`, `plt.imshow(picture)` and `PIL.Image.fromarray(np.asarray(picture))` take it as it is.

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

    @property
    def pixel(self) -> float | None:
        """Distance of neighbouring pixels, world units (in perspective: in the focal plane); None where unknown."""
        pixel = self.report.get("pixel")
        return None if pixel is None else float(pixel)

    @property
    def unit(self) -> str | None:
        """Of the world's lengths, such as "mm"; None where unknown."""
        return self.report.get("unit")

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
    def save(self, path: str | PathLike[str], *, bits: int = 8, dpi: float | None = None, quality: int = 95) -> None:
        """Write the picture to a file; the suffix chooses the format.

        Parameters
        ----------
        path : path
            `.png`: integers, colour not multiplied by opacity. `.tif`, `.tiff`, `.exr`: float32, associated, as in
            `rgba`; an `.exr` file also holds the depth, if there is one, as channel Z. `.jpg`, `.jpeg`, `.webp`: bytes,
            compressed; JPEG has no transparency, what is transparent lies on white there.
        bits : 8 or 16, default 8
            Bits per channel of a PNG file.
        dpi : float, optional
            Pixels per inch when printed, which is written to PNG, JPEG and TIFF files.
        quality : int, default 95
            Of JPEG and WebP files, 1 to 100; a WebP file of 100 loses nothing.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        ArgumentError
            If `bits` is neither 8 nor 16, or `dpi` or `quality` is out of range.

        Examples
        --------
        >>> import os, tempfile, wavesplat as ws
        >>> folder = tempfile.mkdtemp()
        >>> picture = ws.render(ws.examples.ripples(8), size=(16, 16))
        >>> picture.save(f"{folder}/ripples.png")
        >>> picture.save(f"{folder}/ripples.jpg", dpi=300)
        >>> sorted(os.listdir(folder))
        ['ripples.jpg', 'ripples.png']
        """
        from wavesplat._files import output
        from wavesplat._picture import picture_files

        suffix = output.check_output(path, "pictures")
        check_bits(bits)
        check_dpi(dpi)
        if not 1 <= quality <= 100:
            raise ArgumentError(f"quality is {quality}; give 1 to 100, 95 is good")

        def write(part: Path) -> None:
            if suffix == ".png":
                part.write_bytes(picture_files.png_bytes(self.rgba, bits, dpi))
            elif suffix == ".exr":
                picture_files.write_exr(self, part)
            elif suffix in (".tif", ".tiff"):
                picture_files.write_tiff(self, part, dpi=dpi)
            else:
                picture_files.write_bytes_of(self, part, dpi=dpi, quality=quality)

        output.write_atomically(path, write)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Bytes as pictures are shown, shape (height, width, 4): colour, not multiplied by opacity, and opacity.

        So `np.asarray(picture)` and `plt.imshow(picture)` work. The floats are in `rgba`.
        """
        from wavesplat._picture import picture_files

        if copy is False:
            raise ValueError("the bytes of a picture are made when asked for; leave out copy=False")
        return picture_files.straight_bytes(self.rgba).astype(np.uint8 if dtype is None else dtype, copy=False)

    def to_pil(self) -> Any:
        """The picture as a `PIL.Image.Image` of bytes, with transparency.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.render(ws.examples.ripples(8), size=(16, 12)).to_pil().size
        (16, 12)
        """
        from wavesplat._picture import picture_files

        return picture_files.image(self.rgba)

    def show(self) -> None:
        """Show the picture: in a notebook below the cell, else in the system's viewer of pictures.

        Raises
        ------
        LibraryError
            If the system has no viewer.
        """
        from wavesplat._picture import showing

        showing.show(self)

    def figure(self) -> Any:
        """A `matplotlib.figure.Figure` with the picture; its axes have world units where `pixel` is known.

        They are the world's own for slices along them, else they count from the middle of the picture. Save it with
        `savefig`, or draw into `figure().axes[0]` first.

        Raises
        ------
        LibraryError
            If matplotlib is not installed (`pip install ".[figure]"` in the checkout).

        Examples
        --------
        >>> import wavesplat as ws
        >>> figure = ws.slice(ws.examples.ct_pelvis(), "coronal").figure()
        >>> figure.axes[0].get_xlabel()
        'x (mm)'
        """
        from wavesplat._picture import showing

        return showing.figure(self)

    def __repr__(self) -> str:
        width, height = self.size
        of = f" of {self.pixel:.4g} {self.unit or 'world units'}" if self.pixel else ""
        also = [name for name in ("depth", "value") if getattr(self, name) is not None]
        return f"Picture({width} x {height} pixels{of}{''.join(f', with {name}' for name in also)})"

    def _repr_png_(self) -> bytes:
        from wavesplat._picture import picture_files

        return picture_files.png_bytes(self.rgba, 8)


def check_bits(bits: int) -> None:
    """An `ArgumentError` if a PNG file cannot have so many bits per channel."""
    if bits not in (8, 16):
        raise ArgumentError(f"bits is {bits!r}; a PNG file has 8 or 16 bits per channel")


def check_dpi(dpi: float | None) -> None:
    """An `ArgumentError` if nobody prints so."""
    if dpi is not None and not 1 <= dpi <= MOST_DPI:
        raise ArgumentError(f"dpi is {dpi:g}; give pixels per inch, 1 to {MOST_DPI}; journals ask for 300 or 600")
