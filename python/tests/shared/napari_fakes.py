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


class Points(Image):
    """A layer of points; `size` is their diameter."""

    shading, shown = "none", True

    def __init__(self, data, name="spots", size=1.0, face_color=(1, 0, 0, 1), **fields):
        data = np.asarray(data, float)
        super().__init__(data, name, np.ones(data.shape[1]))
        self.ndim = data.shape[1]
        self.size, self.face_color = np.full(len(data), size), np.broadcast_to(face_color, (len(data), 4))
        vars(self).update(fields)


class Tracks(Points):
    """A layer of tracks: rows of number, time, z, y, x."""

    tail_length, head_length, tail_width = 30, 0, 2

    def __init__(self, data, name="tracks", track_colors=(0, 1, 0, 1), **fields):
        super().__init__(data, name)
        self.ndim, self.scale = self.data.shape[1] - 1, np.ones(self.data.shape[1] - 1)
        self.track_colors = np.broadcast_to(track_colors, (len(self.data), 4))
        vars(self).update(fields)


class Shapes(Points):
    """A layer of shapes of one kind."""

    def __init__(self, data, name="shapes", shape_type="path", edge_color=(0, 0, 1, 1), edge_width=1.0, **fields):
        super().__init__(np.concatenate(data), name)
        self.data, self.shape_type = data, [shape_type] * len(data)
        self.edge_color, self.edge_width = np.broadcast_to(edge_color, (len(data), 4)), np.full(len(data), edge_width)
        vars(self).update(fields)


class Surface(Points):
    """A layer of one surface, whose values have grey colours."""

    shading = "flat"

    def __init__(self, data, name="surface", **fields):
        super().__init__(data[0], name)
        self.data, self.contrast_limits = data, (0.0, 1.0)
        self.colormap = SimpleNamespace(map=lambda share: np.stack([share, share, share, np.ones_like(share)], -1))
        vars(self).update(fields)


class Vectors(Image):
    """A layer that is not drawn."""

    def __init__(self, name="arrows"):
        super().__init__(np.zeros((2, 2, 3)), name)


def viewer(*layers, camera=None, size=(60, 80), ndisplay=3, point=None):
    """A viewer of layers; `size`: height and width of its canvas."""
    ndim = max((getattr(layer, "ndim", 3) for layer in layers), default=3)
    dims = SimpleNamespace(
        ndim=ndim, ndisplay=ndisplay, displayed=tuple(range(ndim - ndisplay, ndim)), point=point or (0.0,) * ndim
    )
    return SimpleNamespace(layers=list(layers), camera=camera or Camera(), dims=dims, canvas=SimpleNamespace(size=size))
