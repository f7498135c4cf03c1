"""A rendered picture: float RGBA, the files it can be written to, and how it is shown on the screen."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume import units
from wavesplat._picture.marks import Canvas, Mark
from wavesplat._picture.report import Report
from wavesplat._public import public
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, LibraryError

if TYPE_CHECKING:
    from wavesplat._model.camera.camera import Camera
    from wavesplat._picture.annotating import Corner, Orientation, Side

# A picture on the screen, and as a figure of matplotlib.

#: Pixels per inch of matplotlib's figures where a picture does not have its own.
DPI = 100.0


def show(picture: Picture) -> None:
    """Show a picture below the cell of a notebook, or in the system's viewer."""
    interactive = sys.modules.get("IPython")
    shell = interactive.get_ipython() if interactive else None
    if shell is not None and hasattr(shell, "kernel"):
        import_module("IPython.display").display(picture)
        return
    from PIL import ImageShow

    if not ImageShow.show(picture.to_pil(), title="wavesplat"):
        raise LibraryError('this system has no viewer of pictures; write a file with picture.save("picture.png")')


def figure(picture: Picture) -> Any:
    """A figure as large as the picture, with axes around it."""
    library("matplotlib", extra="figure")
    from matplotlib.figure import Figure

    width, height = picture.size
    made = Figure(figsize=(width / DPI + 1, height / DPI + 1), dpi=DPI, layout="constrained")
    axes = made.add_subplot()
    if picture.pixel is None:
        axes.imshow(picture)
        axes.set_axis_off()
        return made
    across, left, right = _axis(picture, "right", width)
    along, top, bottom = _axis(picture, "down", height)
    axes.imshow(picture, extent=(left, right, bottom, top))
    unit = f" ({units.written(picture.unit)})" if picture.unit else ""
    axes.set_xlabel(across + unit)
    axes.set_ylabel(along + unit)
    return made


def _axis(picture: Picture, way: str, n_px: int) -> tuple[str, float, float]:
    """The label of an axis of the picture, and the coordinates of its first and last edge."""
    report, pixel = picture.report, picture.pixel or 1.0
    direction, origin = report.get(way), report.get("origin")
    if direction is not None and origin is not None:
        for name, share, place in zip("xyz", direction, origin, strict=True):
            if abs(share) == 1:
                first = place - share * pixel / 2
                return name, first, first + share * n_px * pixel
    half = n_px * pixel / 2
    return ("right", -half, half) if way == "right" else ("up", half, -half)


# A rendered picture: float RGBA, and the files it can be written to.

#: Largest resolution, pixels per inch: more than any printer has.
MAX_DPI = 10_000


@public
@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """A picture that `render` or `slice` returns; it shows itself in a notebook.

    `np.asarray(picture)`, `plt.imshow(picture)` and `PIL.Image.fromarray(np.asarray(picture))` take it as it is.

    Attributes
    ----------
    rgba : float32 array, shape (height, width, 4)
        Red, green, blue associated with (multiplied by) opacity, and opacity, 0..1; row 0 is the top.
    depth : float32 array, shape (height, width), or None
        World units along the ray to where it is half absorbed, to the surface, or to the maximum or minimum; NaN where
        there is none, and of means, sums and x-rays.
    value : float32 array, shape (height, width), or None
        For projections and slices: the value, in sample units (sum: times world units); NaN outside the volume.
    report : Report
        How the picture was made, and what it shows.
    """

    rgba: NDArray[np.float32]
    depth: NDArray[np.float32] | None = None
    value: NDArray[np.float32] | None = None
    report: Report = field(default_factory=Report)
    #: Canvas that `annotated` drew: the rendering and the marks on it, for files that hold vectors.
    _canvas: Canvas | None = field(default=None, init=False)
    #: Canvas of the rendering with what is written beside things in space, which `rgba` has in its pixels.
    _in_space: Canvas | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        report: object = self.report
        if not isinstance(report, Report):
            object.__setattr__(self, "report", Report(report))  # type: ignore[call-overload]
        rgba: object = self.rgba
        if not isinstance(rgba, np.ndarray):
            raise ArgumentError(f"rgba of the picture is {described(rgba)}; give a float32 array (height, width, 4)")
        shape = rgba.shape
        if len(shape) != 3 or shape[2] != 4 or 0 in shape or rgba.dtype.kind != "f":
            raise ArgumentError(
                f"rgba of the picture is {rgba.dtype} of shape {shape}; give float32 of shape (height, width, 4), with "
                "at least one pixel"
            )
        for name in ("depth", "value"):
            beside = getattr(self, name)
            if beside is not None and np.shape(beside) != shape[:2]:
                raise ArgumentError(
                    f"{name} of the picture has shape {np.shape(beside)}; give one number for each pixel, {shape[:2]}"
                )

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
        """Unit of the world's lengths, such as "mm"; None where unknown."""
        return self.report.get("unit")

    @property
    def camera(self) -> Camera | None:
        """Camera of the picture; None where unknown, such as of a slice."""
        from wavesplat._model.camera.camera import Camera

        camera = self.report.get("camera")
        return None if camera is None else Camera.from_json(camera)

    def _with_marks(self, marks: tuple[Mark, ...]) -> Picture:
        """The picture with marks on it: in its pixels, and apart for files that hold vectors."""
        from wavesplat._picture import raster

        canvas = Canvas(*self.size, self.rgba, marks=marks)
        made = Picture(raster.drawn(canvas), self.depth, self.value, self.report)
        object.__setattr__(made, "_in_space", canvas)
        return made

    @takes_its_types
    def over(self, below: Picture) -> Picture:
        """Lay this picture over another of the same size, as light is composited: details over the whole, say.

        Parameters
        ----------
        below : Picture
            The picture that shows where this one is transparent.

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
        return Picture(self.rgba + (1 - self.rgba[..., 3:]) * below.rgba, report=Report(over=self.report))

    @takes_its_types
    def annotated(
        self,
        *,
        scale_bar: bool | float | str = False,
        orientation: Orientation | None = None,
        colorbar: bool | str | Sequence[str] = False,
        legend: bool | Iterable[str] = False,
        title: str | None = None,
        unit: str | None = None,
        values: str | None = None,
        dpi: float | None = None,
        font_size: float | None = None,
        color: str | Sequence[float] | None = None,
        font: str | PathLike[str] | None = None,
        scale_bar_at: Corner = "lower left",
        orientation_at: Corner = "lower right",
        colorbar_at: Side = "beside",
        legend_at: Side = "beside",
    ) -> Picture:
        """The picture as a figure: with a scale bar, its directions, the colours of its values, names and a title.

        All comes from `report`. Saved as `.svg` or `.pdf`, the rendering is embedded, and the rest is vectors and text.

        Parameters
        ----------
        scale_bar : bool, float or str
            A bar of a round length near a fifth of the width. Or of this length, world units; in this unit, such as
            "um"; or of a length with its unit, such as "50 um". In perspective it is right at the focal point, and says
            so. Without a unit it says "units".
        orientation : str, optional
            "letters": R, L, A, P, S, I at the edges, and the sum of these for oblique views, nearest first; only for
            the world of a patient. "cube": a small cube, its faces with these letters, else with x, y, z. "axes": the
            same as arrows.
        colorbar : bool, str or sequence of str
            The colours of the values that are shown, for all layers and what stands in space with values, or only
            where they have one of these names. Light and shadows are not in it, nor is opacity, but for projections.
        legend : bool or sequence of str
            Names and colours of the labels and, where there are several, of the layers, of more than 30 the first 30;
            or of these only. Slices name the labels in them; where there are none, all.
        title : str, optional
            Above the picture; it is broken into lines where it is longer. `{time}` in it is the time of the picture
            with its unit ("30 s"), or its number where the file names no times.
        unit : str, optional
            Unit of the world's lengths, where the file does not say it.
        values : str, optional
            What the values are called, above the colour bar; None is the name of the dataset with the unit of its
            values ("temperature (K)"), else the unit ("HU"), else the layer's name.
        dpi : float, optional
            Pixels per inch when printed, as for `save`; it is also how large an SVG or PDF file is (None: 96).
        font_size : float, optional
            Points where `dpi` is given, else pixels; None follows the picture's size.
        color : colour, optional
            Colour of what is written; None is black on light backgrounds and on transparent ones, else white.
        font : path, optional
            A .ttf or .otf file, for signs that ours, Liberation Sans, does not have; PDF files take .ttf.
        scale_bar_at, orientation_at : str
            "lower left", "lower right", "upper left" or "upper right".
        colorbar_at, legend_at : str
            "beside" makes the picture larger, so that nothing is hidden; or one of these corners.

        Returns
        -------
        Picture
            Larger than this one where there is something beside it; without `depth` and `value`. `report["scale_bar"]`
            has length (world units), pixels and text of the bar.

        Raises
        ------
        ArgumentError
            If the report lacks a fact that is needed (the message says which, and how to give it), or the picture has
            no room.

        Examples
        --------
        >>> import wavesplat as ws
        >>> picture = ws.slice(ws.examples.ct_pelvis(), "coronal", size=(400, 400), window="abdomen")
        >>> figure = picture.annotated(scale_bar=True, orientation="letters", colorbar=True, title="Pelvis")
        >>> figure.report["scale_bar"]["text"]
        '100 mm'
        >>> figure.save("pelvis.svg")
        """
        from wavesplat._model.volume.private_names import with_fields
        from wavesplat._picture import annotating, raster

        wanted = annotating.Figure(
            scale_bar=scale_bar,
            orientation=orientation,
            colorbar=colorbar,
            legend=legend,
            title=title,
            unit=unit,
            values=values,
            dpi=dpi,
            font_size=font_size,
            color=color,
            font=font,
            scale_bar_at=scale_bar_at,
            orientation_at=orientation_at,
            colorbar_at=colorbar_at,
            legend_at=legend_at,
        )
        under = self._in_space or Canvas(*self.size, self.rgba)
        canvas, entries = annotating.annotated(under.rgba, self.report, wanted, under.marks)
        if isinstance(self.report.get("scene"), dict):
            # So that the document of the picture has the figure too.
            entries = entries | {"scene": with_fields(self.report["scene"], figure=wanted.as_json())}
        made = Picture(raster.drawn(canvas), report=Report(self.report | entries))
        object.__setattr__(made, "_canvas", canvas)
        return made

    @takes_its_types
    def save(
        self,
        path: str | PathLike[str],
        *,
        bits: int = 8,
        dpi: float | None = None,
        quality: int = 95,
        scene: bool = True,
        embed_paths: bool = False,
    ) -> None:
        """Write the picture to a file; the suffix chooses the format.

        Parameters
        ----------
        path : path
            `.png`: integers, colour not multiplied by opacity. `.tif`, `.tiff`: the same, without opacity where nothing
            is transparent; unless there is a `dpi`, with `pixel` and `unit` as ImageJ and Fiji read them, but for
            perspective. `.exr`: float32, associated, as in `rgba`, and the depth, if there is one, as channel Z.
            `.jpg`, `.jpeg`, `.webp`: bytes, compressed; JPEG has no transparency, what is transparent lies on white
            there. `.svg`, `.pdf`: the picture embedded, and what `annotated` drew on it as vectors and text, on a
            transparent page where it is.
        bits : 8 or 16, default 8
            Bits per channel of a PNG or TIFF file.
        dpi : float, optional
            Pixels per inch when printed, which is written to PNG, JPEG, TIFF, SVG and PDF files; None is the
            resolution given to `annotated`.
        quality : int, default 95
            Quality of JPEG and WebP files, 1 to 100; a WebP file of 100 loses nothing.
        scene : bool
            Whether the scene is written into a PNG file, so that `Scene.load` reads it from there, and
            `wavesplat render --from` draws it again, beside the files or in their folder. It holds the names of files
            without their folders, and of scans of patients, whose files may have their names, the content alone.
        embed_paths : bool, default False
            Write whole paths of files into the scene, relative where they lie below the picture's folder or beside it.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        ArgumentError
            If `bits` is neither 8 nor 16, or `dpi` or `quality` is out of range.
        LibraryError
            If ReportLab is not installed, which writes PDF (`pip install "wavesplat[figure]"`).

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
        from wavesplat._picture import picture_files
        from wavesplat._storage import output

        suffix = output.check_output(path, "pictures")
        check_bits(bits)
        check_dpi(dpi)
        if not 1 <= quality <= 100:
            raise ArgumentError(f"quality is {quality}; give 1 to 100, 95 is good")

        canvas = self._canvas or self._in_space or Canvas(*self.size, self.rgba)
        canvas = canvas if dpi is None else replace(canvas, dpi=dpi)
        dpi = canvas.dpi

        def write(part: Path) -> None:
            if suffix == ".png":
                content = picture_files.png_bytes(self.rgba, bits, dpi)
                folder = Path(path).absolute().parent if embed_paths else None
                part.write_bytes(
                    picture_files.with_scene(content, self.report.get("scene"), folder) if scene else content
                )
            elif suffix == ".svg":
                from wavesplat._picture import vector_files

                part.write_text(vector_files.svg_written(canvas, bits), encoding="utf-8")
            elif suffix == ".pdf":
                from wavesplat._picture import vector_files as pdf

                part.write_bytes(pdf.pdf_written(canvas))
            elif suffix == ".exr":
                picture_files.write_exr(self, part)
            elif suffix in (".tif", ".tiff"):
                picture_files.write_tiff(self, part, bits=bits, dpi=dpi)
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
        show(self)

    def figure(self) -> Any:
        """A `matplotlib.figure.Figure` with the picture; its axes have world units where `pixel` is known.

        They are the world's own for slices along them, else they count from the middle of the picture. Save it with
        `savefig`, or draw into `figure().axes[0]` first.

        Raises
        ------
        LibraryError
            If matplotlib is not installed (`pip install "wavesplat[figure]"`).

        Examples
        --------
        >>> import wavesplat as ws
        >>> figure = ws.slice(ws.examples.ct_pelvis(), "coronal").figure()
        >>> figure.axes[0].get_xlabel()
        'x (mm)'
        """
        return figure(self)

    def __repr__(self) -> str:
        width, height = self.size
        of = f" of {self.pixel:.4g} {self.unit or 'world units'}" if self.pixel else ""
        also = [name for name in ("depth", "value") if getattr(self, name) is not None]
        return f"Picture({width} x {height} pixels{of}{''.join(f', with {name}' for name in also)})"

    def _repr_png_(self) -> bytes:
        from wavesplat._picture import picture_files

        return picture_files.png_bytes(self.rgba, 8)


def check_bits(bits: int) -> None:
    """Raise an `ArgumentError` unless a PNG file can have this number of bits per channel."""
    if bits not in (8, 16):
        raise ArgumentError(f"bits is {bits!r}; a PNG file has 8 or 16 bits per channel")


def check_dpi(dpi: float | None) -> None:
    """Raise an `ArgumentError` for a resolution that no printer has."""
    if dpi is not None and not 1 <= dpi <= MAX_DPI:
        raise ArgumentError(f"dpi is {dpi:g}; give pixels per inch, 1 to {MAX_DPI}; journals ask for 300 or 600")
