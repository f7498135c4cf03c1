"""Labels: a segmentation beside the scan, with a name and a look for every label.

Label numbers are never interpolated: what is reconstructed is how much of a place each label covers. It lies where its
affine says (`label_grids`); the renderer takes labels on the scan's samples.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import InitVar, dataclass, field, fields
from functools import partial
from os import PathLike, fspath
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.labels import label_grids, label_names
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.interchange.convert_from import converted
from wavesplat._model.volume import affine
from wavesplat._model.volume.cutting import Boxes, taken_out
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.sources import Source, then
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat._storage.paths import matching_files
from wavesplat._system.values import described, share
from wavesplat.errors import ArgumentError

_Place: TypeAlias = tuple[tuple[int, int, int], bytes]


@dataclass(frozen=True)
class _Placing:
    """A sentence on how labels came to the samples that they lie on, and whether some may be lost."""

    note: str | None = None
    is_resampled: bool = False


#: Largest number of labels: data with more values is a scan.
MAX_LABELS = 65_535
#: Labels that `repr` lists.
SHOWN = 6
#: Largest difference of affines of the same grid, in spacings: they are rounded in files.
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
        object.__setattr__(self, "opacity", share(opacity, f"label {name!r}: opacity"))
        left = (0.0 if self.opacity > 0 else 1.0) if scan is None else scan
        object.__setattr__(self, "scan", share(left, f"label {name!r}: scan"))
        object.__setattr__(self, "tint", share(tint, f"label {name!r}: tint"))


@public
@dataclass(frozen=True, init=False, eq=False)
class Labels:
    """A segmentation and the looks of its labels.

    Parameters
    ----------
    segmentation : Volume, array [z, y, x], or what else `Volume` takes
        Whole numbers; every number is a label, 0 is none. It lies where its affine says, on any grid that touches the
        scan. Axes that are flipped or exchanged are put in order, and a part of the scan's grid is copied, both without
        loss; other grids are resampled by nearest neighbour, with a note in the picture's report. An array, which has
        no place, is taken to lie on the scan's samples, and must have its shape.
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

    segmentation: InitVar[Any]
    labels: dict[int, Label]
    smooth: bool
    shape: tuple[int, int, int] = field(init=False)
    world_from_index: NDArray[np.float64] | None = field(init=False)
    numbers: tuple[int, ...] = field(init=False)
    _codes: NDArray[Any] = field(init=False, repr=False)
    #: Source of the segmentation, None if unknown (`_model.volume.sources`).
    _source: Source | None = field(init=False, repr=False)
    #: Sentences on samples that were lost when it was read.
    _notes: tuple[str, ...] = field(init=False, repr=False)
    #: Facts of its file, such as the unit of its lengths.
    _facts: Facts = field(init=False, repr=False)
    #: Whether it says where it lies: an array does not.
    _has_place: bool = field(init=False, repr=False)
    #: How the labels came to the samples that they lie on, where that is worth a note.
    _placing: _Placing = field(init=False, repr=False)
    #: The labels for the compiled module, on the samples of the last scan, and without the last boxes.
    _cores: dict[_Place, _native.Labels] = field(init=False, repr=False)
    _on_scans: dict[_Place, Labels] = field(init=False, repr=False)
    _cuts: dict[Boxes, Labels] = field(init=False, repr=False)
    #: Numbers and codes on the last scan, which copies with other looks share.
    _codes_on_scans: dict[_Place, tuple[tuple[int, ...], NDArray[Any], _Placing]] = field(init=False, repr=False)

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
        self._set(
            labels=looks,
            smooth=bool(smooth),
            shape=(n_z, n_y, n_x),
            world_from_index=matrix,
            numbers=numbers,
            _codes=codes,
            _source=source,
            _notes=(),
            _facts=found.facts,
            _has_place=matrix is not None and _has_place_of(matrix, found.facts),
            _placing=_Placing(),
            _cores={},
            _on_scans={},
            _cuts={},
            _codes_on_scans={},
        )

    # Annotated above as an argument, so that `dataclasses.replace` passes what this returns to the new object.
    @property
    def segmentation(self) -> Any:
        """The segmentation as given: a `Volume`, or an array [z, y, x] where it has no place; numbers are int64."""
        return _segmentation_of(self)

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

        They are in DICOM segmentations (SEG), in the segments of 3D Slicer (.seg.nrrd), in the label tables of NIfTI
        files as TotalSegmentator and Connectome Workbench write them, and in `image-label` of OME-Zarr. Labels without
        a colour get one of their own.
        The regions of a structure set of radiotherapy (RTSTRUCT), which are closed lines, are filled on the samples of
        `scan`: voxels whose centre is inside an odd number of lines.

        Parameters
        ----------
        path : path
            The segmentation; or a pattern such as "organs/*.nii.gz" for masks in a file each, which become one
            segmentation with the files' names. Where masks overlap the later file counts, in the order of their names.
            Or the name of labels of `scan`, an OME-Zarr image, such as "nuclei", where no file has that name.
        table : path, optional
            Names and colours instead of the file's: label descriptions of ITK-SNAP, a colour table of FreeSurfer or 3D
            Slicer (.ctbl), a label list of Connectome Workbench, or a .tsv with index, name and color (BIDS).
        segments : sequence of str or int, optional
            The labels that are shown, by name, by a pattern of names such as "rib*", or by number; all if not given.
            Of a structure set all but the outline of the patient (EXTERNAL).
        scan : Volume, optional
            The volume whose samples the regions of a structure set are filled on, or that has labels of this name; all
            other files have their own.
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
        from wavesplat._looks.labels.label_files import name_of, opened_segmentation

        chosen = None if segments is None else [segments] if isinstance(segments, str) else list(segments)
        files = matching_files(fspath(path))
        if files is not None and len(files) > 1:
            if table is not None:
                raise ArgumentError(f"masks have the names of their files; leave out the table: {table}")
            return cls._of_masks(files, smooth=smooth)._only(chosen, path)
        path = path if files is None else files[0]
        # The table first: it is small, and may be the wrong file.
        given = None if table is None else label_names.in_table(table)
        segmentation, of_file = opened_segmentation(path, chosen, scan)
        named = of_file if given is None else given
        try:
            labels = cls(segmentation, smooth=smooth)
        except ArgumentError as error:
            raise ArgumentError(f"{error}: {path}") from None
        if files is not None and not named and len(labels.labels) == 1:  # a mask, found by a pattern
            named = {number: (name_of(path), None) for number in labels.labels}
        return labels._with_names(named)._only(chosen, path)

    def _with_names(self, named: Mapping[int, label_names.Named]) -> Labels:
        """The labels with names, and with colours where these are known."""
        looks = dict(self.labels)
        for number, (name, color) in named.items():
            if number in looks:
                looks[number] = Label(color or looks[number].color, name=name)
        return self.with_looks(looks)

    def _only(self, chosen: Sequence[str | int] | None, path: str | PathLike[str]) -> Labels:
        """The labels of these names, numbers or patterns; all where none is given. `path`: for messages."""
        if chosen is None:
            return self
        names = {number: look.name for number, look in self.labels.items()}
        return self.with_looks({n: self.labels[n] for n in label_names.chosen_numbers(chosen, names, path)})

    @classmethod
    def _of_masks(cls, files: list[str], *, smooth: bool) -> Labels:
        from wavesplat._looks.labels.label_files import merged

        volume, names, notes = merged(files)
        labels = cls(volume, smooth=smooth)
        looks = {number: Label(look.color, name=names[number]) for number, look in labels.labels.items()}
        return labels.with_looks(looks)._changed(_source=None, _notes=notes)

    def moved(self, matrix: ArrayLike) -> Labels:
        """The labels at another place, as by `Volume.moved`.

        Parameters
        ----------
        matrix : array, shape (4, 4)
            Affine from the segmentation's world to the new one, world units.

        Raises
        ------
        ArgumentError
            If it is no affine map, or has no inverse, or the segmentation has no place.
        """
        world_from_world = affine.checked_map(matrix, "labels: the matrix to move them by")
        if self.world_from_index is None:
            raise ArgumentError("labels: the segmentation has no place, so it cannot be moved; give it as a Volume")
        return self._changed(
            world_from_index=world_from_world @ self.world_from_index,
            _has_place=True,
            _placing=_Placing(),
            _source=then(self._source, "moved", matrix=world_from_world.tolist()),
            _codes_on_scans={},
        )

    def on_samples_of(self, scan: Grid) -> Labels:
        """The labels on the samples of a scan; itself where it lies on them. Kept until another scan is asked for.

        Raises
        ------
        ArgumentError
            If the segmentation does not touch the scan, has lengths in another unit, or no place and another shape.
        """
        label_grids.check_unit(self._facts.unit, scan)
        if self._lies_on(scan):
            return self
        key = _place_of(scan)
        if key not in self._on_scans:
            self._on_scans.clear()
            if key not in self._codes_on_scans:
                self._codes_on_scans.clear()
                self._codes_on_scans[key] = self._placed(scan)
            numbers, codes, placing = self._codes_on_scans[key]
            self._on_scans[key] = self._changed(
                shape=scan.shape,
                world_from_index=np.array(scan.world_from_index),
                numbers=numbers,
                _codes=codes,
                _has_place=True,
                _placing=placing,
                _codes_on_scans={},
            )
        return self._on_scans[key]

    def for_slices_of(self, scan: Grid) -> Labels:
        """The labels on the samples of a scan or, where resampling would lose some, on their own, in its axes' order.

        Raises
        ------
        ArgumentError
            As `on_samples_of`.
        """
        placed = self.on_samples_of(scan)
        own_place = self.world_from_index
        if own_place is None or not (placed._placing.is_resampled and label_grids.is_finer(own_place, scan)):
            return placed
        # In one order of axes, places half way between samples do not depend on the file's.
        codes, matrix = label_grids.along_axes_of(scan, self._codes, own_place)
        own, theirs = (label_grids.spacing_text(each) for each in (matrix, scan.world_from_index))
        note = f"labels drawn by nearest neighbour from their own samples, {own}, finer than the scan's, {theirs}"
        return self._changed(
            shape=codes.shape, world_from_index=matrix, _codes=codes, _placing=_Placing(note), _codes_on_scans={}
        )

    def for_lines_over(self, scan: Grid) -> Labels:
        """The labels on their own samples, whose outlines lie where they are; on the scan's where they have no place.

        Raises
        ------
        ArgumentError
            As `on_samples_of`.
        """
        placed = self.on_samples_of(scan)
        return self if self._has_place else placed

    @property
    def notes(self) -> list[str]:
        """Sentences on samples that were lost when they were read, and on how they came to those that they lie on."""
        return [*self._notes, *([] if self._placing.note is None else [self._placing.note])]

    def beside(self, scan: Grid) -> _native.Labels:
        """The labels as the compiled module takes them, on the samples of a scan."""
        placed = self.on_samples_of(scan)
        key = _place_of(scan)
        if key not in placed._cores:
            none = ("", (0.0, 0.0, 0.0), 0.0, 1.0, 0.0)
            looks = [
                (look.name or str(number), look.color, look.opacity, look.scan, look.tint)
                if (look := placed.labels.get(number)) is not None
                else none
                for number in placed.numbers
            ]
            placed._cores.clear()
            placed._cores[key] = _native.Labels(placed._codes, looks, np.array(scan.world_from_index), self.smooth)
        return placed._cores[key]

    def without(self, boxes: Boxes, scan: Grid) -> Labels:
        """The labels with none in the boxes, so that they end in surfaces there; kept until other boxes are asked for.

        Raises
        ------
        ArgumentError
            As `on_samples_of`.
        """
        if not boxes:
            return self
        placed = self.on_samples_of(scan)
        if boxes not in placed._cuts:
            placed._cuts.clear()
            numbers, outside = _with_none(placed.numbers)
            codes = placed._codes.astype(_dtype_of(len(numbers)))
            codes[taken_out(scan, boxes)] = outside
            placed._cuts[boxes] = placed._changed(numbers=numbers, _codes=codes, _source=None, _codes_on_scans={})
        return placed._cuts[boxes]

    def _lies_on(self, scan: Grid) -> bool:
        if self.world_from_index is None or self.shape != scan.shape:
            return False
        apart = np.abs(self.world_from_index - scan.world_from_index).max()
        return bool(apart <= TOLERANCE * min(scan.spacing))

    def _lacks_origin(self, scan: Grid) -> bool:
        """Whether it has the scan's distances and begins at (0, 0, 0): programs that segment forget the stage."""
        matrix = self.world_from_index
        if matrix is None or self._facts.is_anatomical or scan.is_anatomical or matrix[:3, 3].any():
            return False
        apart = np.abs(matrix[:3, :3] - scan.world_from_index[:3, :3]).max()
        return bool(apart <= TOLERANCE * min(scan.spacing))

    def _placed(self, scan: Grid) -> tuple[tuple[int, ...], NDArray[Any], _Placing]:
        """Numbers and codes on the samples of a scan, and how they came there."""
        matrix = self.world_from_index
        if self.shape == scan.shape and (not self._has_place or self._lacks_origin(scan)):
            guess = "guess: the segmentation says nothing of its place, and is taken to lie on the scan's samples"
            return self.numbers, self._codes, _Placing(None if matrix is None else guess)
        if matrix is None or not (self._has_place or np.array_equal(scan.world_from_index, np.eye(4))):
            raise ArgumentError(
                f"labels: the segmentation is {self.shape} (z, y, x), the scan {scan.shape}, and nothing says where it "
                "lies; give it as a wavesplat.Volume with world_from_index, or on the scan's samples"
            )
        numbers, outside = _with_none(self.numbers)
        codes = self._codes.astype(_dtype_of(len(numbers)), copy=False)
        placed = label_grids.placed(codes, matrix, outside, scan)
        notes = []
        if placed.is_resampled:
            own, theirs = (label_grids.spacing_text(each) for each in (matrix, scan.world_from_index))
            notes.append(f"labels resampled by nearest neighbour from their samples, {own}, to the scan's, {theirs}")
        if (placed.codes == outside).all():
            notes.append("none of the labels lies in the scan")
        elif placed.share_outside > 0:
            notes.append(f"{100 * placed.share_outside:.2g} % of the labelled samples lie outside of the scan")
        note = "; ".join(notes) or None
        return numbers, placed.codes, _Placing(note, is_resampled=placed.is_resampled)

    def _changed(self, **changes: Any) -> Labels:
        """A copy with other fields; the copy does not share what was kept of scans and boxes."""
        changed = object.__new__(Labels)
        own = {each.name: getattr(self, each.name) for each in fields(self)}
        changed._set(**{**own, "_cores": {}, "_on_scans": {}, "_cuts": {}, **changes})
        return changed

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

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
        return self._changed(
            labels=_checked_looks(labels, self.numbers), smooth=self.smooth if smooth is None else bool(smooth)
        )

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
        return partial(type(self), smooth=self.smooth), (_segmentation_of(self), self.labels)


def _segmentation_of(labels: Labels) -> Volume | NDArray[np.int64]:
    samples: NDArray[np.int64] = np.asarray(labels.numbers, dtype=np.int64)[labels._codes]
    if labels.world_from_index is None:
        return samples
    volume = Volume(samples, world_from_index=labels.world_from_index, name="labels", facts=labels._facts)
    volume._source = labels._source
    return volume


def _has_place_of(world_from_index: NDArray[np.float64], facts: Facts) -> bool:
    """Whether an affine was given; volumes whose file says nothing of their place have the identity and no unit."""
    return facts.unit is not None or facts.is_anatomical or not np.array_equal(world_from_index, np.eye(4))


def _place_of(scan: Grid) -> _Place:
    return scan.shape, scan.world_from_index.tobytes()


def _with_none(numbers: tuple[int, ...]) -> tuple[tuple[int, ...], int]:
    """The numbers with 0, which is no label, and its code."""
    with_none = numbers if 0 in numbers else (*numbers, 0)
    return with_none, with_none.index(0)


def _dtype_of(n_codes: int) -> type[np.unsignedinteger[Any]]:
    return np.uint8 if n_codes <= 256 else np.uint16


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
        return tuple(numbers.tolist()), np.ascontiguousarray(table.astype(_dtype_of(len(numbers)))[place])
    unique, inverse = np.unique(samples, return_inverse=True)
    if len(unique) > MAX_LABELS:
        raise ArgumentError(f"labels: the segmentation holds {len(unique)} different numbers; it looks like a scan")
    codes = inverse.reshape(samples.shape).astype(_dtype_of(len(unique)))
    return tuple(unique.tolist()), np.ascontiguousarray(codes)


def _default_looks(numbers: tuple[int, ...]) -> dict[int, Label]:
    """A colour for every label but 0."""
    shown = [number for number in numbers if number != 0]
    return {number: Label(_native.label_color(place), name=str(number)) for place, number in enumerate(shown)}


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
