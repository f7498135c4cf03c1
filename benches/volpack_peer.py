"""VolPack, the shear-warp renderer of Lacroute and Levoy (1994), on the scenes of `cases.toml`, through its C library.

It runs on one thread and keeps a run-length encoded volume that belongs to one transfer function; making that is
`preparation_ms`, which no frame of ours has. It classifies and shades at the samples and interpolates colours. It
centres a volume on n / 2 and a picture on whole pixels, where ours are centred on the samples and on the middles of
pixels. On Debian the library is `libvolpack1-dev`.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import time
from typing import Any

import numpy as np
import scenes
from numpy.typing import NDArray

#: Constants of volpack.h.
NORM_MAX, GRAD_MAX = 7923, 221
MIN_VOXEL_OPACITY, MAX_RAY_OPACITY = 1014, 1043
PARALLEL, RGBA = 2400, 5004
MODEL, PROJECT = 0, 2

NORMAL, DENSITY, GRADIENT = 0, 1, 2


def library() -> str | None:
    """Name of the library's file; None if it is not installed."""
    return ctypes.util.find_library("volpack")


class Scene:
    """A classified volume and a picture of it."""

    def __init__(self, case: scenes.Case, min_opacity: float) -> None:
        volume = scenes.load(case.volume)
        self._case = case
        self._volpack = ctypes.CDLL(library())
        self._volpack.vpCreateContext.restype = ctypes.c_void_p
        self._volpack.vpGetErrorString.restype = ctypes.c_char_p
        self._context = ctypes.c_void_p(self._volpack.vpCreateContext())
        curves = scenes.transfer_function(case)
        values, opacities = np.array(curves.opacity).T
        self._alpha = np.interp(np.arange(256), values, opacities).astype(np.float32)
        color = np.array(curves.color)
        # Colours are sums over materials, one per node of the colour curve.
        hats = np.eye(len(color))
        self._weights = np.ascontiguousarray(
            [[np.interp(value, color[:, 0], hat) for hat in hats] for value in range(256)], np.float32
        )
        self._colors = 255 * color[:, 1:]
        self._table = np.zeros((NORM_MAX + 1, len(color), 3), np.float32)
        self._picture = np.zeros((case.size, case.size, 4), np.uint8)
        self._spacing = np.array(volume.spacing)
        self._size = np.array(volume.samples.shape[::-1])
        call = self._call
        call("vpSetVolumeSize", *(int(n) for n in self._size))
        # A voxel has a short (the normal) and two bytes, by which it is classified.
        call("vpSetVoxelSize", 4, 3, 2, 1)
        call("vpSetVoxelField", NORMAL, 2, 0, NORM_MAX)
        call("vpSetVoxelField", DENSITY, 1, 2, 255)
        call("vpSetVoxelField", GRADIENT, 1, 3, GRAD_MAX)
        call("vpSetClassifierTable", 0, DENSITY, self._alpha, self._alpha.nbytes)
        call("vpSetd", MIN_VOXEL_OPACITY, ctypes.c_double(min_opacity))
        call("vpSetd", MAX_RAY_OPACITY, ctypes.c_double(0.99))
        samples = np.ascontiguousarray(volume.samples)
        start = time.perf_counter()
        call("vpClassifyScalars", samples, samples.nbytes, DENSITY, GRADIENT, NORMAL)
        self.preparation_ms = 1e3 * (time.perf_counter() - start)
        n_materials = len(color)
        tables = (self._table, self._table.nbytes, DENSITY, self._weights, self._weights.nbytes)
        call("vpSetLookupShader", 3, n_materials, NORMAL, *tables)
        call("vpSetImage", self._picture, case.size, case.size, 4 * case.size, RGBA)
        call("vpCurrentMatrix", PROJECT)
        call("vpIdentityMatrix")
        half = scenes.camera(case).parallel_scale
        if half is None:
            raise ValueError("only orthographic")
        self._half = half
        call("vpWindow", PARALLEL, *map(ctypes.c_double, (-half, half, -half, half, -4 * half, 4 * half)))
        normals = [self._normal(i) for i in range(NORM_MAX + 1)]
        self._normals = np.array(normals)

    def _call(self, name: str, *arguments: Any) -> None:
        passed = [a.ctypes.data_as(ctypes.c_void_p) if isinstance(a, np.ndarray) else a for a in arguments]
        if getattr(self._volpack, name)(self._context, *passed) != 0:
            error = self._volpack.vpGetErrorString(self._volpack.vpGetError(self._context))
            raise RuntimeError(f"{name}: {error.decode()}")

    def _normal(self, number: int) -> list[float]:
        x, y, z = (ctypes.c_double() for _ in range(3))
        self._volpack.vpNormal(number, ctypes.byref(x), ctypes.byref(y), ctypes.byref(z))
        return [x.value, y.value, z.value]

    def draw(self, turn_deg: float) -> None:
        """Draw one frame."""
        view = scenes.camera(self._case, turn_deg)
        to_eye = np.subtract(view.position, view.focal_point)
        to_eye /= np.linalg.norm(to_eye)
        right = np.cross(view.view_up, to_eye)
        right /= np.linalg.norm(right)
        up = np.cross(to_eye, right)
        world_from_object = np.eye(4)
        for row, axis in enumerate((right, up, -to_eye)):
            # The longest axis of a volume is 1 long in its coordinates.
            world_from_object[row, :3] = axis * self._spacing * self._size.max()
        for row, axis in enumerate((right, up)):
            world_from_object[row, 3] = 0.5 * axis @ self._spacing - self._half / self._case.size
        self._call("vpCurrentMatrix", MODEL)
        self._call("vpSetMatrix", np.ascontiguousarray(world_from_object))
        facing = np.abs(self._normals @ to_eye)
        specular = 0.2 * np.maximum(2 * facing**2 - 1, 0) ** 10
        lit = self._colors[None] * (0.1 + 0.7 * facing)[:, None, None] + 255 * specular[:, None, None]
        self._table[:] = np.minimum(lit, 255)
        self._call("vpRenderClassifiedVolume")

    def picture(self) -> NDArray[np.float64]:
        """Picture of the view itself, over black."""
        self.draw(0.0)
        return self._picture[::-1, :, :3].astype(np.float64) / 255
