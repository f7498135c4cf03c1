"""Labels: a segmentation beside the scan, with a name and a look for every label.

Label numbers are never interpolated: what is reconstructed is how much of a place each label covers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks import colors, label_names
from wavesplat._looks.default_colors import label_color
from wavesplat._looks.label_files import opened_segmentation
from wavesplat._model.argument_types import described, takes_its_types
from wavesplat._model.convert_from import converted
from wavesplat._model.cutting import Boxes, taken_out
from wavesplat._model.grid import Grid
from wavesplat._model.sources import Source
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Label", "Labels"]

#: Largest number of labels: data with more values is a scan.
MAX_LABELS = 65_535
#: Labels that `repr` lists.
SHOWN = 6
#: Largest distance, in spacings, between a segmentation's samples and those of the scan.
TOLERANCE = 1e-3


@public
@dataclass(frozen=True, init=False)
class Label:
    """How a label looks.

    Parameters
    ----------
    color : colour
        (r, g, b), "#rrggbb" or a name.
    opacity : float, default 0.8
        0..1, of the label's own medium over a thickness of `opacity_unit` of the transfer function. 0: it has none.
    name : str, optional
        Such as "liver".
    scan : float, optional
        How much of the scan's extinction is left inside, 0..1; 0 hides the scan there.
        None: 0 for labels with an opacity, else 1.
    tint : float, default 0
        How much of the scan's colour inside is replaced by the label's, 0..1.

    Raises
    ------
    ArgumentError
        If one of them cannot be.

    Examples
    --------
    A solid red organ; a table that is not to be seen; bones of the scan, coloured:

    >>> import wavesplat as ws
    >>> organ = ws.Label("#c03020", name="spleen")
    >>> table = ws.Label("grey", opacity=0, scan=0)
    >>> bones = ws.Label("#ffe0a0", opacity=0, tint=0.7)
    >>> organ.scan, table.scan, bones.scan
    (0.0, 0.0, 1.0)
    """

    color: tuple[float, float, float]
    opacity: float
    name: str
    scan: float
    tint: float

    @takes_its_types
    def __init__(
        self,
        color: str | Iterable[float],
        opacity: float = 0.8,
        *,
        name: str = "",
        scan: float | None = None,
        tint: float = 0.0,
    ) -> None:
        rgba = colors.parse(color)
        if rgba is None:
            raise ArgumentError(f"label {name!r}: the colour is {described(color)}; give (r, g, b), #rrggbb or a name")
        object.__setattr__(self, "color", rgba[:3])
        object.__setattr__(self, "name", str(name))
        object.__setattr__(self, "opacity", _share(opacity, name, "opacity"))
        left = (0.0 if self.opacity > 0 else 1.0) if scan is None else scan
        object.__setattr__(self, "scan", _share(left, name, "scan"))
        object.__setattr__(self, "tint", _share(tint, name, "tint"))


@public
@dataclass(frozen=True, init=False, eq=False)
class Labels:
    """A segmentation and the looks of its labels.

    Parameters
    ----------
    segmentation : Volume, array [z, y, x], or what else `Volume` takes
        Whole numbers; every number is a label, 0 is none. It must lie on the scan's samples (same shape and affine); an
        array, which has no place, is taken to.
    labels : mapping of int to Label, optional
        Looks by number; numbers without a look show the scan as it is.
        None gives every number but 0 a colour of its own and the usual opacity.
    smooth : bool, default True
        Smooth the staircase of samples that a segmentation is, by a blurring kernel about a sample wide.
        False: the trilinear share of every label.

    Raises
    ------
    ArgumentError
        If the samples are no whole numbers, or a label is in none of them.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> scan = ws.examples.ct_pelvis()
    >>> bones = (scan.samples > 200).astype(np.uint8)
    >>> labels = ws.Labels(bones, {1: ws.Label("#ffe8c0", name="bone")})
    >>> picture = ws.render(scan, "ct-soft-tissue", labels=labels, size=(32, 32))
    """

    labels: dict[int, Label]
    smooth: bool
    shape: tuple[int, int, int]
    world_from_index: NDArray[np.float64] | None
    numbers: tuple[int, ...]
    _codes: NDArray[Any] = field(repr=False)
    _cores: dict[bytes, _native.Labels] = field(repr=False)
    _cuts: dict[tuple[bytes, Boxes], Labels] = field(repr=False)
    #: Source of the segmentation, None if unknown (`_model.sources`).
    _source: Source | None = field(repr=False)

    @takes_its_types
    def __init__(
        self,
        segmentation: object,
        labels: Mapping[int, Label] | None = None,
        *,
        smooth: bool = True,
    ) -> None:
        found = converted(segmentation, "labels")
        samples, matrix = found.samples, found.world_from_index
        if samples.ndim != 3:
            raise ArgumentError(f"labels: the segmentation has shape {samples.shape}; give [z, y, x]")
        numbers, codes = _codes(samples)
        looks = _default_looks(numbers) if labels is None else _checked_looks(labels, numbers)
        n_z, n_y, n_x = samples.shape
        source = segmentation._source if isinstance(segmentation, Volume) else None
        parts: tuple[Any, ...] = (looks, bool(smooth), (n_z, n_y, n_x), matrix, numbers, codes, {}, {}, source)
        for name, value in zip(self.__dataclass_fields__, parts, strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def open(
        cls,
        path: str | PathLike[str],
        *,
        table: str | PathLike[str] | None = None,
        segments: Iterable[str | int] | None = None,
        scan: Volume | WaveletVolume | None = None,
        smooth: bool = True,
    ) -> Labels:
        """A segmentation from a file that `wavesplat.open` reads, with names and colours where there are any.

        They are in DICOM segmentations (SEG), in the segments of 3D Slicer (.seg.nrrd) and in the label tables of NIfTI
        files as TotalSegmentator writes them. Labels without a colour get one of their own.
        The regions of a structure set of radiotherapy (RTSTRUCT), which are closed lines, are filled on the samples of
        `scan`: voxels whose centre is inside an odd number of lines.

        Parameters
        ----------
        path : path
            The segmentation.
        table : path, optional
            Names and colours instead of the file's: label descriptions of ITK-SNAP, a colour table of 3D Slicer
            (.ctbl), or a .tsv with the columns index, name and color (BIDS).
        segments : sequence of str or int, optional
            The labels that are shown, by name, by a pattern of names such as "rib*", or by number; all if not given.
            Of a structure set all but the outline of the patient (EXTERNAL).
        scan : Volume, optional
            The volume whose samples the regions of a structure set are filled on; all other files have their own.
        smooth : bool, default True
            See `Labels`.

        Raises
        ------
        FileError
            If a file cannot be read.
        ArgumentError
            If the samples are no labels, or a segment is not there.

        Warns
        -----
        FileWarning
            If segments of a DICOM segmentation overlap: every voxel is of the last of them in the file; of a structure
            set it is of the smallest. Those that `segments` leaves out hide none.
        """
        # The table first: it is small, and may be the wrong file.
        given = None if table is None else label_names.in_table(table)
        chosen = None if segments is None else [segments] if isinstance(segments, str) else list(segments)
        segmentation, of_file = opened_segmentation(path, chosen, scan)
        named = of_file if given is None else given
        try:
            labels = cls(segmentation, smooth=smooth)
        except ArgumentError as error:
            raise ArgumentError(f"{error}: {path}") from None
        looks = dict(labels.labels)
        for number, (name, color) in named.items():
            if number in looks:
                looks[number] = Label(color or looks[number].color, name=name)
        if chosen is not None:
            names = {number: look.name for number, look in looks.items()}
            looks = {number: looks[number] for number in label_names.chosen_numbers(chosen, names, path)}
        return cls(segmentation, looks, smooth=smooth)

    def check_beside(self, scan: Grid) -> None:
        """Refuse a scan whose samples are not those of the segmentation.

        Raises
        ------
        ArgumentError
            If shape or affine differ.
        """
        if self.shape != scan.shape:
            raise ArgumentError(
                f"labels: the segmentation is {self.shape} (z, y, x), the scan {scan.shape}; "
                "resample it to the scan's samples (nearest neighbour), or open the scan that it was made from"
            )
        if self.world_from_index is not None:
            apart = np.abs(self.world_from_index - scan.world_from_index).max()
            if apart > TOLERANCE * min(scan.spacing):
                raise ArgumentError(
                    f"labels: the segmentation lies {apart:.4g} world units beside the scan (their affines differ); "
                    "give the segmentation of this scan, or its array alone if you know that they belong together"
                )

    def beside(self, scan: Grid) -> _native.Labels:
        """The labels as the compiled module takes them, on the samples of a scan."""
        self.check_beside(scan)
        key = scan.world_from_index.tobytes()
        if key not in self._cores:
            none = ("", (0.0, 0.0, 0.0), 0.0, 1.0, 0.0)
            looks = [
                (look.name or str(number), look.color, look.opacity, look.scan, look.tint)
                if (look := self.labels.get(number)) is not None
                else none
                for number in self.numbers
            ]
            self._cores[key] = _native.Labels(self._codes, looks, np.array(scan.world_from_index), self.smooth)
        return self._cores[key]

    def without(self, boxes: Boxes, scan: Grid) -> Labels:
        """The labels with none in the boxes, so that they end in surfaces there; kept until other boxes are asked for.

        Raises
        ------
        ArgumentError
            If shape or affine are not the scan's.
        """
        if not boxes:
            return self
        self.check_beside(scan)
        key = scan.world_from_index.tobytes(), boxes
        if key not in self._cuts:
            self._cuts.clear()
            numbers = self.numbers if 0 in self.numbers else (*self.numbers, 0)
            codes = self._codes.astype(np.uint8 if len(numbers) <= 256 else np.uint16)
            codes[taken_out(scan, boxes)] = numbers.index(0)
            cut = object.__new__(Labels)
            parts: tuple[Any, ...] = (
                self.labels,
                self.smooth,
                self.shape,
                self.world_from_index,
                numbers,
                codes,
                {},
                {},
                None,
            )
            for name, value in zip(self.__dataclass_fields__, parts, strict=True):
                object.__setattr__(cut, name, value)
            self._cuts[key] = cut
        return self._cuts[key]

    def with_looks(self, labels: Mapping[int, Label], *, smooth: bool | None = None) -> Labels:
        """A copy with other looks of the same segmentation.

        Raises
        ------
        ArgumentError
            If a label is in no sample.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> labels = ws.Labels(np.eye(4, dtype=np.uint8).reshape(1, 4, 4))
        >>> labels.with_looks({1: ws.Label("red")}).labels[1].color
        (1.0, 0.0, 0.0)
        """
        changed = object.__new__(Labels)
        for name in self.__dataclass_fields__:
            object.__setattr__(changed, name, getattr(self, name))
        object.__setattr__(changed, "labels", _checked_looks(labels, self.numbers))
        object.__setattr__(changed, "smooth", self.smooth if smooth is None else bool(smooth))
        object.__setattr__(changed, "_cores", {})
        object.__setattr__(changed, "_cuts", {})
        return changed

    def __repr__(self) -> str:
        n_z, n_y, n_x = self.shape
        named = [
            f"{number} {self.labels[number].name!r}" if number in self.labels else str(number)
            for number in self.numbers
            if number != 0
        ]
        listed = ", ".join(named[:SHOWN]) + (", ..." if len(named) > SHOWN else "")
        return f"<Labels: z {n_z}, y {n_y}, x {n_x}, {len(named)} labels: {listed or 'none'}>"

    def __reduce__(self) -> tuple[Any, ...]:
        samples = np.asarray(self.numbers, dtype=np.int64)[self._codes]
        whole: Any = samples
        if self.world_from_index is not None:
            whole = Volume(samples, world_from_index=self.world_from_index, name="labels")
        return partial(type(self), smooth=self.smooth), (whole, self.labels)


def _share(number: float, name: str, what: str) -> float:
    try:
        share = float(number)
    except (TypeError, ValueError, OverflowError):
        share = float("nan")
    if not 0 <= share <= 1:
        raise ArgumentError(f"label {name!r}: {what} is {described(number)}; give a number 0..1")
    return share


def _codes(samples: NDArray[Any]) -> tuple[tuple[int, ...], NDArray[Any]]:
    """The numbers that occur, and for every sample the index of its number among them."""
    if samples.dtype.kind == "b":
        samples = samples.view(np.uint8)
    if samples.dtype.kind == "f":
        if not (np.isfinite(samples).all() and (samples == np.rint(samples)).all()):
            raise ArgumentError("labels: some samples are no whole numbers; labels are 0, 1, 2, ...")
        samples = samples.astype(np.int64)
    if samples.dtype.kind not in "iu":
        raise ArgumentError(f"labels: samples of the segmentation are {samples.dtype}; labels are whole numbers")
    lowest, highest = (int(samples.min()), int(samples.max())) if samples.size else (0, 0)
    if highest - lowest <= MAX_LABELS:
        # A table is much faster than sorting.
        place = (samples.astype(np.int64) - lowest) if lowest < 0 or samples.dtype.kind == "i" else samples - lowest
        occurs = np.bincount(place.ravel(), minlength=highest - lowest + 1) > 0
        numbers = np.flatnonzero(occurs) + lowest
        table = np.cumsum(occurs) - 1
        dtype = np.uint8 if len(numbers) <= 256 else np.uint16
        return tuple(numbers.tolist()), np.ascontiguousarray(table.astype(dtype)[place])
    unique, inverse = np.unique(samples, return_inverse=True)
    if len(unique) > MAX_LABELS:
        raise ArgumentError(f"labels: the segmentation holds {len(unique)} different numbers; it looks like a scan")
    dtype = np.uint8 if len(unique) <= 256 else np.uint16
    return tuple(unique.tolist()), np.ascontiguousarray(inverse.reshape(samples.shape).astype(dtype))


def _default_looks(numbers: tuple[int, ...]) -> dict[int, Label]:
    """A colour for every label but 0."""
    shown = [number for number in numbers if number != 0]
    return {number: Label(label_color(place), name=str(number)) for place, number in enumerate(shown)}


def _checked_looks(labels: Mapping[int, Label], numbers: tuple[int, ...]) -> dict[int, Label]:
    if not isinstance(labels, Mapping):
        raise ArgumentError("labels: the looks are no mapping; give {number: wavesplat.Label(...)}")
    for number, look in labels.items():
        if not isinstance(look, Label):
            raise ArgumentError(
                f"labels: the look of {described(number)} is a {type(look).__name__}; give a wavesplat.Label"
            )
        if number not in numbers:
            known = ", ".join(str(known) for known in numbers[:20]) + (", ..." if len(numbers) > 20 else "")
            raise ArgumentError(
                f"labels: no sample of the segmentation is {described(number)}; those that occur are {known}"
            )
    return {int(number): look for number, look in labels.items()}
