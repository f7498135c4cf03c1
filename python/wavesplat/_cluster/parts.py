"""Pictures of parts of a volume that lie in several processes, merged into the picture of the whole.

All processes plan the same frame: the same base planes, sheets, tables and light. Each composites the pieces of the
rays that run through its own box, which gives a state for every ray that meets it. Merging folds these states from the
front box to the back one, ray by ray, and then reads the pixels once. Colours of pixels are never laid over each other:
along a face that two boxes share both would cover a part of a pixel, and a seam would show.
"""

from __future__ import annotations

import hashlib
import json
import math
import pickle
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.lazy.read_ahead import ReadCounts
from wavesplat._model.volume.volume_parts import PartArray
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._public import public
from wavesplat._render.lazy_layers import FrameSpec
from wavesplat._render.streaming import Corners, Reading, draw_block
from wavesplat.errors import ArgumentError

# The order in which rays of an eye pass through boxes that do not overlap.
#
# A plane between two boxes shows which of them cannot hide the other: the one behind it, seen from the eye. With planes
# along several axes between them it may be both, and then no ray meets both. A picture of many boxes needs an order
# that is right for every pair. There is none where boxes lie around each other in a ring, which grids and trees of
# boxes never do.

BoxCorners = NDArray[np.float64]


def front_to_back(lows: BoxCorners, highs: BoxCorners, eye: Sequence[float], *, is_direction: bool) -> list[int]:
    """Numbers of the boxes, each before all boxes that it hides from the eye.

    A topological sort: a box is taken once every box that may hide it is taken, so the order is right for each pair. A
    round in which no box is free proves a ring.

    Parameters
    ----------
    lows, highs : arrays, shape (n, 3)
        Corners of the boxes, which may share faces, but must not overlap.
    eye : three numbers
        Place of the eye among the boxes or, where it `is_direction`, the direction of parallel rays, away from it.

    Raises
    ------
    ArgumentError
        If boxes lie around each other in a ring, so that each hides the next.
    """
    hides = _may_hide(lows, highs, eye, is_direction=is_direction)
    n_in_front = hides.sum(axis=0)
    left = np.ones(len(lows), bool)
    order: list[int] = []
    while left.any():
        free = np.flatnonzero(left & (n_in_front == 0))
        if not len(free):
            ring = ", ".join(str(k) for k in np.flatnonzero(left)[:6])
            raise ArgumentError(
                f"boxes lie around each other in a ring, so that each hides the next from this eye: numbers {ring}; "
                "cut the volume into a grid or a tree of boxes"
            )
        order += free.tolist()
        left[free] = False
        n_in_front -= hides[free].sum(axis=0)
    return order


def _may_hide(lows: BoxCorners, highs: BoxCorners, eye: Sequence[float], *, is_direction: bool) -> NDArray[np.bool_]:
    """Whether a ray may pass through box i, then through box j, [i, j]."""
    hides = ~np.eye(len(lows), dtype=bool)
    for axis in range(3):
        is_below = highs[:, None, axis] <= lows[None, :, axis]
        # Whether the eye is on the lower side of some plane between the two, or on the upper side.
        from_below, from_above = np.array(eye[axis] >= 0), np.array(eye[axis] <= 0)
        if not is_direction:
            from_below, from_above = eye[axis] <= lows[None, :, axis], eye[axis] >= highs[:, None, axis]
        hides &= ~(is_below & from_above)
        hides &= ~(is_below & from_below).T
    return hides


# Pictures of parts of a volume that lie in several processes, merged into the picture of the whole.

Box = tuple[tuple[int, int, int], tuple[int, int, int]]

#: A budget for streams of which nothing is read.
UNBOUNDED = 1 << 60
#: zlib's level for states of rays: rays that see nothing take hardly any bytes.
PACKING = 1
#: Fields of a picture's report that are about the process that drew it.
OF_PROCESS = ("notes", "lazy", "n_threads", "simd", "device", "n_texels", "n_skipped_slabs")


@public
@dataclass(frozen=True)
class PartialPicture:
    """The part of a picture that one process has drawn, by `render_part`: for `merge`, in this process or another.

    Attributes
    ----------
    picture : Picture
        The process's part of the picture alone.

    Examples
    --------
    >>> import wavesplat as ws
    >>> field = ws.examples.ripples(16).samples
    >>> part = ws.VolumePart(field, (0, 0, 0), ((0, 16), (0, 16), (0, 16)), field.shape)  # one that has all
    >>> whole = part.whole([part.overview()])
    >>> ws.render_part(whole, size=(24, 16))
    <PartialPicture 24 x 16 of the samples z 0 to 16, y 0 to 16, x 0 to 16>
    """

    picture: Picture
    #: First index and end, z, y, x, of the samples that it shows, and of the samples of every part.
    own: Box
    boxes: list[Box]
    #: By base plane: the state of its rays, packed.
    planes: dict[int, bytes]
    #: The base planes that were drawn, to notice if some are lost in transfer.
    drawn: tuple[int, ...] = field(repr=False)
    #: The frame with its surveys, in the process of the part that has the first sample.
    frame: bytes | None = field(repr=False)

    @property
    def identity(self) -> str:
        """Digest of all that pictures to be merged must share."""
        report = {key: value for key, value in self.picture.report.items() if key not in OF_PROCESS}
        text = json.dumps([report, sorted(self.boxes)], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()

    def __repr__(self) -> str:
        width, height = self.picture.size
        return f"<PartialPicture {width} x {height} of the samples {_text_of(self.own)}>"


class PartDrawing:
    """Draws the part of a frame that this process has, and keeps what `merge` needs."""

    def __init__(self) -> None:
        self.array: PartArray | None = None
        self._planes: dict[int, bytes] = {}
        self._frame: bytes | None = None

    def __call__(self, spec: FrameSpec) -> tuple[_native.Stream, ReadCounts]:
        """The stream of a frame, with the part put into it: see `DrawOptions.draw_frame`."""
        array = _only_part(spec)
        if self.array is not None:
            raise ArgumentError("parts of projections are drawn of one layer; draw each layer on its own")
        self.array = array
        (low, _), shape = array.own, array.shape
        stream = spec.stream(_corners(array.own, shape))
        reading = Reading([array.repeated() for _ in spec.arrays], spec.least, spec.layers.options.progress)
        planes: dict[int, _native.BlockState] = {}
        texels = [stream.n_texels(block) for block in range(stream.n_blocks)]
        whole, done = max(sum(texels), 1), 0
        for block, own in enumerate(texels):
            drawn = draw_block(stream, block, reading.part(done / whole, own / whole))
            plane, state = stream.plane_state(block, drawn)
            planes[plane] = stream.fold([planes[plane], state]) if plane in planes else state
            done += own
        for plane, state in planes.items():
            stream.put_plane(plane, state)
        self._planes = {plane: zlib.compress(state.to_bytes(), PACKING) for plane, state in planes.items()}
        if low == (0, 0, 0):
            self._frame = pickle.dumps(spec.with_surveys())
        return stream, reading.counts

    def partial(self, picture: Picture) -> PartialPicture:
        """The partial picture, given the picture of what was drawn."""
        if self.array is None:
            raise ArgumentError(
                "there is no part of a volume in this scene; give what VolumePart.whole returns, or draw the whole "
                "with ws.render"
            )
        return PartialPicture(
            picture, self.array.own, self.array.boxes, self._planes, tuple(sorted(self._planes)), self._frame
        )


@public
def merge(pictures: Iterable[PartialPicture | None]) -> Picture:
    """The picture of a whole volume, given what each process has drawn of its part.

    Parameters
    ----------
    pictures : iterable of PartialPicture or None
        By `render_part`, of all parts, in any order, with the same look, camera and options. None is left out: of a
        process without samples.

    Returns
    -------
    Picture
        The picture of the whole volume but for rounding, given enough ghost samples (`VolumePart`). Light on cut faces
        may differ within ten samples of them, where rays have entered the volume in another part.

    Raises
    ------
    ArgumentError
        If parts are missing, twice there, or drawn differently, or if they lie around each other in a ring.

    Examples
    --------
    `VolumePart` has one of two parts.

    >>> import wavesplat as ws
    >>> field = ws.examples.ripples(16).samples
    >>> part = ws.VolumePart(field, (0, 0, 0), ((0, 16), (0, 16), (0, 16)), field.shape)  # one that has all
    >>> whole = part.whole([part.overview()])
    >>> ws.merge([ws.render_part(whole, size=(24, 16))]).size
    (24, 16)
    """
    given = [partial for partial in pictures if partial is not None]
    for partial in given:
        if not isinstance(partial, PartialPicture):
            raise ArgumentError(f"merge takes partial pictures, by ws.render_part, not {type(partial).__name__}")
    _check_complete(given)
    spec = _frame_of(given)
    infinite = (-math.inf,) * 3, (math.inf,) * 3
    stream = replace(spec, memory=UNBOUNDED).stream(infinite)
    ordered = [given[k] for k in _front_to_back(spec, [partial.own for partial in given])]
    parts = [_states_of(partial, stream.n_planes) for partial in ordered]
    for plane in range(stream.n_planes):
        if states := [of_part[plane] for of_part in parts if plane in of_part]:
            stream.put_plane(plane, stream.fold(states))
    result = stream.picture()
    first = given[0].picture.report
    report = {**{key: value for key, value in first.items() if key not in OF_PROCESS}, **result["report"]}
    report["n_texels"] = sum(partial.picture.report["n_texels"] for partial in given)
    return Picture(result["rgba"], result["depth"], result["value"], Report(report))


def _frame_of(given: list[PartialPicture]) -> FrameSpec:
    """The frame that one of the partial pictures holds.

    It is unpickled, which runs what it says: ranks are trusted, as MPI's own way to send objects trusts them.
    """
    packed = next((partial.frame for partial in given if partial.frame is not None), None)
    if packed is None:
        raise ArgumentError("none of the pictures to merge holds the frame; give them as ws.render_part returns them")
    try:
        spec = pickle.loads(packed)  # noqa: S301
    except Exception as error:  # noqa: BLE001 - a damaged pickle raises anything
        raise ArgumentError(f"a picture to merge was damaged on its way: {type(error).__name__} in its frame") from None
    if not isinstance(spec, FrameSpec):
        raise ArgumentError(f"a picture to merge was damaged on its way: its frame is a {type(spec).__name__}")
    return spec


def _states_of(partial: PartialPicture, n_planes: int) -> dict[int, _native.BlockState]:
    """The states of the rays of a part, by base plane."""
    if tuple(sorted(partial.planes)) != partial.drawn or not set(partial.drawn) <= set(range(n_planes)):
        raise ArgumentError(
            f"the picture of the samples {_text_of(partial.own)} has lost base planes on its way: it was drawn on "
            f"{partial.drawn}, and holds {tuple(partial.planes)} of {n_planes}"
        )
    try:
        return {plane: _native.BlockState.from_bytes(zlib.decompress(state)) for plane, state in partial.planes.items()}
    except (zlib.error, TypeError, ValueError) as error:
        raise ArgumentError(
            f"the picture of the samples {_text_of(partial.own)} was damaged on its way: {error}"
        ) from None


def _check_complete(given: list[PartialPicture]) -> None:
    if not given:
        raise ArgumentError("there are no pictures to merge; give the pictures of all parts, by ws.render_part")
    owns = sorted(partial.own for partial in given)
    for own in owns:
        if owns.count(own) > 1:
            raise ArgumentError(f"the part of the samples {_text_of(own)} is twice among the pictures to merge")
    if len({partial.identity for partial in given}) > 1:
        raise ArgumentError(
            "the pictures to merge are not of one frame: draw all parts with the same look, camera and options, of the "
            "same overviews"
        )
    missing = sorted(set(given[0].boxes) - set(owns))
    if missing:
        raise ArgumentError(
            f"{len(missing)} of {len(given[0].boxes)} parts are missing among the pictures to merge, such as the "
            f"part with the samples {_text_of(missing[0])}"
        )


def _front_to_back(spec: FrameSpec, boxes: list[Box]) -> list[int]:
    lows, highs = (np.array([box[k][::-1] for box in boxes], np.float64) for k in (0, 1))
    index_from_world = np.linalg.inv(spec.layers.volumes[0].world_from_index)
    camera = spec.camera
    is_direction = camera.parallel_scale is not None
    place = np.array(camera.focal_point) - camera.position if is_direction else np.array(camera.position)
    eye = index_from_world @ [*place, 0.0 if is_direction else 1.0]
    return front_to_back(lows, highs, eye[:3].tolist(), is_direction=is_direction)


def _only_part(spec: FrameSpec) -> PartArray:
    """The array of all layers; an `ArgumentError` unless all have the same part."""
    arrays = spec.arrays
    for array in arrays:
        if not isinstance(array, PartArray):
            raise ArgumentError(f"volume {array.name!r} is no part of a larger one; give what VolumePart.whole returns")
    if len(arrays) > 1:
        raise ArgumentError(f"parts of {len(arrays)} layers are not drawn together; draw one volume")
    if spec.labels is not None:
        raise ArgumentError("labels lie on all samples, of which a process has a part; give a look without")
    only = arrays[0]
    assert isinstance(only, PartArray)
    return only


def _corners(own: Box, shape: tuple[int, int, int]) -> Corners:
    """Corners (x, y, z) of the box that a part draws; infinite on the border of the whole."""
    low = [float(a) if a > 0 else -math.inf for a in reversed(own[0])]
    high = [float(b) if b < n else math.inf for b, n in zip(reversed(own[1]), reversed(shape), strict=True)]
    return low, high


def _text_of(box: Box) -> str:
    return ", ".join(f"{axis} {a} to {b}" for axis, a, b in zip("zyx", *box, strict=True))
