"""Whether a picture may show a face that can be recognised: the head of a patient, with its skin, seen from the front.

It is decided by simple facts, on a thinned copy of the samples, and errs towards a note:

1. The volume is a patient's MR or CT (or of unknown kind) in millimetres, no larger across than a scan of a head.
2. Its tissue is as large as a head, no wider (a pelvis is), and the profile in the middle comes as far forward at nose
   and mouth, 95 to 140 mm below the vertex, as at the forehead: in a defaced scan it does not. Nor does it in a brain
   without its head, of which nothing but the stem is left at the mouth; and a head is solid in its middle, unlike
   lungs and skulls.
3. The skin of the face lies in the scan: most rays from the front meet tissue behind the scan's wall, where a pelvis
   that fills its field of view is cut.
4. What is drawn is opaque within 12 mm of the surface, along most rays from the front that meet the face.
5. The eye is not behind the head, and the clips leave the face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds.histogram import otsu, robust_range_of
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield
from wavesplat._model.arguments.clips import Clipping
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

NOTE = (
    "a head is drawn with its skin: the picture may show a face that can be recognised; before you publish it, deface "
    "the scan (pydeface, mri_deface), or cut the face off (--cut-out, --clip)"
)

Floats = NDArray[np.float64]

#: Distance of the samples that are looked at, mm.
STEP_MM = 4.0
#: Largest field of view of a head's scan, across (x, y) and along z, with the neck: mm.
MAX_ACROSS_MM, MAX_ALONG_MM = 330.0, 420.0
#: Least extent of a head: to the left and right, and from the back to the front; a brain has 140 and 175. mm.
MIN_WIDTH_MM, MIN_LENGTH_MM = 120.0, 165.0
#: Largest width from the vertex to the mouth, with ears and a head rest, mm.
MAX_WIDTH_MM = 260.0
#: Least share of the rays from the front that meet tissue behind the wall of the scan.
MIN_UNCUT = 0.5
#: Heights below the vertex of the forehead, and of nose and mouth; how far the latter may lie behind. mm.
FOREHEAD_MM, FACE_MM, MAX_BEHIND_MM = (30.0, 70.0), (95.0, 140.0), 15.0
#: Heights below the vertex of the mouth, and how far it may lie behind the forehead: heads 24 at most, brains in the
#: space of MNI, which are large, 60 at least. mm.
MOUTH_MM, MAX_MOUTH_BEHIND_MM = (130.0, 145.0), 40.0
#: Least share of tissue in the middle of the forehead's slices, from back to front: heads 0.87 to 0.96; a skull 0.29.
MIN_SOLID = 0.4
#: Half widths of the profile and of the face, mm.
PROFILE_MM, FACE_HALF_MM = 15.0, 45.0
#: Depth within which skin is opaque, mm, the least opacity, and the least share of rays.
SKIN_MM, MIN_OPACITY, MIN_SHARE = 12.0, 0.5, 0.5
#: Least share of a slice that is tissue where the head is, so that noise does not count.
MIN_FILLED = 0.03
#: Value between air and skin, Hounsfield units.
AIR_HU = -400.0
#: Cosine of the angle between the eye and the front from which on no face is seen.
FROM_BEHIND = -0.35


def shows_face(
    volume: Volume | WaveletVolume,
    curves: TransferFunction | TransferFunction2D,
    clipping: Clipping,
    *,
    iso_value: float | None = None,
) -> bool:
    """Whether a head with its face is drawn with opaque skin. `iso_value`: of a surface, instead of the curves."""
    if not (volume.is_anatomical and volume.unit == "mm" and volume.modality in (None, "MR", "CT")):
        return False
    extent = np.abs(volume.world_from_index[:3, :3]) @ np.array(volume.shape[::-1])
    if max(extent[:2]) > MAX_ACROSS_MM or extent[2] > MAX_ALONG_MM or min(extent) < FACE_MM[0]:
        return False
    head = _Head.of(volume)
    face = None if head is None else head.face()
    if head is None or face is None:
        return False
    if iso_value is not None:
        opacity = (head.values > iso_value).astype(np.float64)
    elif isinstance(curves, TransferFunction2D):
        flat = head.values.ravel()
        opacity = curves(flat, np.full(flat.shape, curves.magnitudes[-1]))[:, 3].reshape(head.values.shape)
    else:
        opacity = curves(head.values)[:, 3].reshape(head.values.shape)
    opacity[~head.kept(clipping.in_world(volume))] = 0.0
    unit = curves.opacity_unit or float(np.prod(volume.spacing)) ** (1 / 3)
    return head.is_opaque(opacity, unit, face)


def is_from_behind(camera: Camera) -> bool:
    """Whether the eye is behind the patient."""
    towards_eye = np.subtract(camera.position, camera.focal_point)
    return bool(towards_eye[1] < FROM_BEHIND * np.linalg.norm(towards_eye))


@dataclass(frozen=True)
class _Head:
    """Thinned samples with axes along the patient's: [from left to right, back to front, feet to head]."""

    values: Floats
    is_tissue: NDArray[np.bool_]
    #: Distances of samples along these axes, mm.
    steps: Floats
    #: Affine from the thinned index to the world.
    world_from_thinned: Floats

    @classmethod
    def of(cls, volume: Volume | WaveletVolume) -> _Head | None:
        """The thinned samples; None where the axes are too oblique to be assigned to x, y and z, or all is alike."""
        matrix = volume.world_from_index[:3, :3]
        order = np.abs(matrix / np.linalg.norm(matrix, axis=0)).argmax(axis=1)  # index axis of each world axis
        if sorted(order) != [0, 1, 2]:
            return None
        step = max(1, int(STEP_MM / min(volume.spacing)))
        thinned = volume._every(step)
        values = thinned.astype(np.float64).transpose()  # [x, y, z] of the index
        columns, origin = step * matrix[:, order], volume.world_from_index[:3, 3].copy()
        values = values.transpose(order)
        for axis in range(3):
            if columns[axis, axis] < 0:
                values = np.flip(values, axis)
                origin += (values.shape[axis] - 1) * columns[:, axis]
                columns[:, axis] *= -1
        finite = values[np.isfinite(values)]
        if finite.size == 0 or finite.min() == finite.max():
            return None
        is_ct = volume.modality != "MR" and looks_like_hounsfield(finite, volume)
        low, high = robust_range_of(finite)
        threshold = AIR_HU if is_ct else low + 0.6 * (otsu(finite, low, high) - low)
        values = np.where(np.isfinite(values), values, finite.min())
        return cls(
            values, values > threshold, step * np.asarray(volume.spacing)[order], np.column_stack([columns, origin])
        )

    def face(self) -> tuple[slice, slice] | None:
        """Where the face is across and along; None where the tissue is no head with a face."""
        filled = [self.is_tissue.mean(axis=tuple({0, 1, 2} - {axis})) > MIN_FILLED for axis in range(3)]
        if not all(axis.any() for axis in filled):
            return None
        first, last = (np.array([ends(np.flatnonzero(axis)) for axis in filled]) for ends in (np.min, np.max))
        width, length, height = (last - first + 1) * self.steps
        if width < MIN_WIDTH_MM or length < MIN_LENGTH_MM or height < FACE_MM[1]:
            return None
        middle, vertex = (first[0] + last[0]) // 2, last[2]
        profile = self._around(middle, PROFILE_MM)
        forehead = self._front(profile, self._below(vertex, FOREHEAD_MM))
        nose = self._front(profile, self._below(vertex, FACE_MM))
        if nose < forehead - MAX_BEHIND_MM / self.steps[1]:
            return None
        is_scanned = vertex > MOUTH_MM[0] / self.steps[2]
        mouth = self._front(profile, self._below(vertex, MOUTH_MM)) if is_scanned else forehead
        if mouth < forehead - MAX_MOUTH_BEHIND_MM / self.steps[1]:
            return None
        middle_part = self.is_tissue[profile, :, self._below(vertex, FOREHEAD_MM)]
        rows = np.flatnonzero(middle_part.any(axis=(0, 2)))
        if middle_part[:, rows.min() : rows.max() + 1].mean() < MIN_SOLID:
            return None
        across, along = self._around(middle, FACE_HALF_MM), self._below(vertex, (FOREHEAD_MM[1], FACE_MM[1]))
        is_face = not self._is_too_wide(vertex) and self._has_its_surface(across, along)
        return (across, along) if is_face else None

    def _is_too_wide(self, vertex: int) -> bool:
        """Whether tissue between the vertex and the mouth is wider than a head."""
        filled = self.is_tissue[:, :, self._below(vertex, (0.0, FACE_MM[1]))].mean(axis=(1, 2)) > MIN_FILLED
        return bool(np.ptp(np.flatnonzero(filled)) * self.steps[0] > MAX_WIDTH_MM) if filled.any() else False

    def _has_its_surface(self, across: slice, along: slice) -> bool:
        """Whether most rays from the front meet tissue behind the wall of the scan."""
        part = self.is_tissue[across, :, along]
        meets = part.any(axis=1)
        return bool(meets.any() and np.mean(part[:, -1][meets]) <= 1 - MIN_UNCUT)

    def _around(self, middle: int, half_mm: float) -> slice:
        half = max(1, round(half_mm / self.steps[0]))
        return slice(max(middle - half, 0), middle + half + 1)

    def _below(self, vertex: int, heights_mm: tuple[float, float]) -> slice:
        upper, lower = (vertex - round(height / self.steps[2]) for height in heights_mm)
        return slice(max(lower, 0), max(upper, 0) + 1)

    def _front(self, across: slice, along: slice) -> float:
        """How far forward tissue comes in a part: the largest index that two samples in a row reach."""
        part: NDArray[np.bool_] = np.asarray(self.is_tissue[across, :, along].any(axis=0))  # [y, z]
        solid = part[:-1] & part[1:]
        reached = np.flatnonzero(solid.any(axis=1))
        return float(reached.max()) if reached.size else -np.inf

    def kept(self, clipping: Clipping) -> NDArray[np.bool_]:
        """Whether samples are left by the clips, which are in the world."""
        kept = np.ones(self.values.shape, bool)
        if clipping == Clipping():
            return kept
        grid = np.stack([*np.indices(kept.shape), np.ones(kept.shape)])
        places = np.einsum("ij,j...->i...", self.world_from_thinned, grid)
        for plane in clipping.planes:
            apart = places - np.reshape(plane.point, (3, 1, 1, 1))
            kept &= np.einsum("i,i...->...", np.asarray(plane.normal), apart) >= 0
        for box, inside in [(clipping.crop, True), *((box, False) for box in clipping.boxes)]:
            if box is not None and box.space == "world":
                lower, upper = (end.reshape(3, 1, 1, 1) for end in np.sort([box.lower, box.upper], axis=0))
                within = ((places >= lower) & (places <= upper)).all(axis=0)
                kept &= within if inside else ~within
        return kept

    def is_opaque(self, opacity: Floats, unit: float, face: tuple[slice, slice]) -> bool:
        """Whether rays from the front stop in the skin."""
        across, along = face
        tissue = np.flip(self.is_tissue[across, :, along], 1)  # from the front
        alpha = np.clip(np.flip(opacity[across, :, along], 1), 0.0, 1.0 - 1e-9)
        meets = tissue.any(axis=1)
        if not meets.any():
            return False
        first = tissue.argmax(axis=1)
        depth = np.arange(tissue.shape[1]).reshape(1, -1, 1) - first[:, None]
        n_steps = max(1, round(SKIN_MM / self.steps[1]))
        extinction = np.where((depth >= 0) & (depth < n_steps), np.log1p(-alpha), 0.0).sum(axis=1)
        covered = -np.expm1(extinction * self.steps[1] / unit)
        return bool(np.mean(covered[meets] >= MIN_OPACITY) >= MIN_SHARE)
