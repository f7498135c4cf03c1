"""Stand-ins for viewers, cameras and layers of napari, for tests where it is not installed."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np


class Camera:
    """napari's camera, whose directions are vectors (z, y, x)."""

    def __init__(self, view=(-1, 0, 0), up=(0, -1, 0), **fields):
        self.view_direction, self.up_direction = view, up
        self.center, self.zoom, self.perspective = (0.0, 0.0, 0.0), 1.0, 0.0
        self.orientation = ("towards", "down", "right")
        vars(self).update(fields)

    def set_view_direction(self, view_direction, up_direction):
        self.view_direction, self.up_direction = view_direction, up_direction


class Image:
    """An image layer with a scale; its colours go from black to one colour."""

    visible, rgb, multiscale, units, opacity, gamma, rendering = True, False, False, None, 1.0, 1.0, "mip"

    def __init__(self, data, name="image", scale=None, color=(0, 1, 0), contrast_limits=(0, 1000), **fields):
        self.data, self.name, self.ndim = data, name, data.ndim
        self.scale = np.ones(data.ndim) if scale is None else np.array(scale)
        self.contrast_limits = contrast_limits
        self.colormap = SimpleNamespace(colors=np.array([(0, 0, 0, 1), (*color, 1)], float))
        vars(self).update(fields)

    def data_to_world(self, point):
        return tuple(np.asarray(point) * self.scale)

    def world_to_data(self, point):
        return tuple(np.asarray(point) / self.scale)


class Labels(Image):
    """A labels layer."""

    def get_color(self, number):
        return np.array([1.0, 0.5, number / 10, 1.0])


class Points:
    """A layer without samples."""

    visible, name = True, "spots"


def viewer(*layers, camera=None, size=(60, 80), ndisplay=3, point=None):
    """A viewer of layers; `size`: height and width of its canvas."""
    ndim = max((getattr(layer, "ndim", 3) for layer in layers), default=3)
    dims = SimpleNamespace(
        ndim=ndim, ndisplay=ndisplay, displayed=tuple(range(ndim - ndisplay, ndim)), point=point or (0.0,) * ndim
    )
    return SimpleNamespace(layers=list(layers), camera=camera or Camera(), dims=dims, canvas=SimpleNamespace(size=size))
