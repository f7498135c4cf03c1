"""A volume without its corner nearest to the eye, so that planes through its middle are seen (`Look.part`)."""

from __future__ import annotations

import numpy as np

from wavesplat._model.camera import Camera
from wavesplat._model.crop import Crop
from wavesplat._model.cutting import without
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.views import view_angles
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._render.framing import natural_view

__all__ = ["NOTE", "cut_open_from"]

NOTE = (
    "matter fills the volume up to its faces, as of a crop or a small field of view, so it is cut open and shown in "
    "greys, as slices through its middle; for other views of it take --composite maximum, a preset (--preset), "
    "or `wavesplat slice` with --plane ortho"
)
#: Least cosine of the angle between the eye and an axis of the samples that is cut.
TOWARDS_EYE = 0.2


def cut_open_from(volume: Volume | WaveletVolume, view: str | None) -> Volume | WaveletVolume:
    """The volume without the corner that faces the eye of a view, or without the half that does.

    The whole volume where its samples are decoded, or read in parts and do not fit into the budget.
    """
    if isinstance(volume, WaveletVolume) or (isinstance(volume, LazyVolume) and not volume.fits_in_budget):
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
