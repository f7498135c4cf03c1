"""A volume without its corner nearest to the eye, so that planes through its middle are seen (`Look.part`)."""

from __future__ import annotations

import numpy as np

from wavesplat._model.arguments.clips import Crop
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.views import view_angles
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.cutting import without
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render.framing import natural_view

BLOCK = "matter fills the volume up to its faces, as in a crop or a small field of view"
OTHER_VIEWS = "other views: --composite maximum, a preset (--preset), or slices by `wavesplat slice` with --plane ortho"
#: An axis is cut if the cosine of its angle to the direction of the eye is larger.
TOWARDS_EYE = 0.2


def note_on_block(*, is_cut: bool) -> str:
    """The note on a volume that is drawn by a look for blocks. is_cut : whether the corner at the eye is left out."""
    if is_cut:
        return f"{BLOCK}, so it is cut open and shown in greys, as slices through its middle; {OTHER_VIEWS}"
    return (
        f"{BLOCK}, so it is drawn in opaque greys; it is not cut open, since only volumes that are held in memory are, "
        f"and shows its faces alone; {OTHER_VIEWS}"
    )


def can_be_cut_open(volume: Volume | WaveletVolume) -> bool:
    """Whether all samples of a volume are in memory, or fit there, so that a part of them can be left out."""
    return not isinstance(volume, WaveletVolume) and not (isinstance(volume, LazyVolume) and not volume.fits_in_budget)


def cut_open_from(volume: Volume | WaveletVolume, view: str | None) -> Volume | WaveletVolume:
    """The volume without the corner, or of a view along its slices the half, that is nearest to the eye.

    The whole volume if it cannot be cut open (`can_be_cut_open`).
    """
    if isinstance(volume, WaveletVolume) or not can_be_cut_open(volume):
        return volume
    angles = natural_view(volume) if view is None else view_angles(view, is_anatomical=volume.is_anatomical)
    camera = Camera.orbit(volume, *angles)
    to_eye = np.subtract(camera.position, camera.focal_point)
    axes = volume.world_from_index[:3, :3] / np.array(volume.spacing)
    facing = to_eye @ axes / np.linalg.norm(to_eye)
    last = np.array(volume.shape[::-1]) - 1.0
    # A sample beyond the volume, so that its own face goes too.
    lower = np.where(facing > TOWARDS_EYE, last / 2, -1.0)
    upper = np.where(facing < -TOWARDS_EYE, last / 2, last + 1)
    whole = volume.read() if isinstance(volume, LazyVolume) else volume
    return without(whole, (Crop(tuple(lower.tolist()), tuple(upper.tolist()), space="index"),))
