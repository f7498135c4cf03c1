"""A volume: samples on a grid, and where the grid lies in the world."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._files.places import printable
from wavesplat._model import affine
from wavesplat._model.grid import Grid
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Volume"]

#: What the renderer reads as it is; everything else is converted once, to the nearest of these.
NATIVE_DTYPES = tuple(np.dtype(code) for code in ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"))


@public
class Volume(Grid):
    """A 3-D grid of scalar samples and its place in the world.

    Parameters
    ----------
    samples : array, shape (z, y, x)
        Any real dtype.
        8, 16 and 32-bit integers and 32 and 64-bit floats keep their type.
        A C-contiguous array of these types is shared, not copied, and `samples` is a read-only view of it. After
        writing to your own array call `changed`: what was prepared for earlier pictures would make wrong ones.
        Do not write to it while a picture is drawn. Any other array is copied.
        NaN and infinity are drawn as empty.
    spacing : three numbers (x, y, z), optional
        Distances between neighbouring samples, in world units (millimetres for medical data).
        Sample (0, 0, 0) is then at the world origin. Default 1.
    world_from_index : array, shape (4, 4), optional
        Affine from the index (x, y, z) of a sample to the world, instead of `spacing`. Shear is fine.
    name : str, optional
        What messages call the volume.

    Raises
    ------
    ArgumentError
        If the array is not 3-D, is empty or not real, or the spacing or affine is degenerate.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> volume = ws.Volume(np.zeros((20, 30, 40), np.int16), spacing=(0.5, 0.5, 1.5))
    >>> volume.shape, volume.bounds[1].tolist()
    ((20, 30, 40), [19.5, 14.5, 28.5])
    """

    __slots__ = ("_core", "_samples")

    def __init__(
        self,
        samples: ArrayLike,
        *,
        spacing: Sequence[float] | None = None,
        world_from_index: ArrayLike | None = None,
        name: str = "volume",
    ) -> None:
        name = printable(str(name))
        self._samples = _renderable(_as_array(samples), name)
        n_z, n_y, n_x = self._samples.shape
        super().__init__(name, (n_z, n_y, n_x), _checked_affine(spacing, world_from_index, name))
        # Built at once, so that what is wrong with a volume is said where the volume is made.
        self._core = self._built()

    def changed(self) -> None:
        """Say that the shared array was written to: range of values and all that was prepared are made anew.

        Of a volume whose array was copied (see `Volume`) the samples stay what they were: make a new one.

        Raises
        ------
        ArgumentError
            If no sample is finite any more.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> array = np.zeros((20, 30, 40), np.uint8)
        >>> volume = ws.Volume(array)
        >>> array[5:15] = 200
        >>> volume.changed()
        >>> volume.value_range
        (0.0, 200.0)
        """
        self._core = self._built()

    def _built(self) -> _native.Volume:
        return _native.Volume(self._samples, self._world_from_index, self._name)

    @property
    def samples(self) -> NDArray[Any]:
        """The samples, shape (z, y, x), read-only, in the type they are rendered from."""
        return self._samples

    @property
    def dtype(self) -> np.dtype[Any]:
        """The samples' type."""
        return self._samples.dtype

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite sample."""
        return self._core.value_range

    @property
    def n_nonfinite(self) -> int:
        """How many samples are NaN or infinite; they are drawn as empty."""
        return self._core.n_nonfinite

    def _every(self, step: int) -> NDArray[Any]:
        """Every n-th sample along each axis, [z, y, x]."""
        return self._samples[::step, ::step, ::step]

    def __repr__(self) -> str:
        n_z, n_y, n_x = self.shape
        spacing = " x ".join(f"{step:.4g}" for step in self.spacing)
        return (
            f"<Volume {self.name!r}: z {n_z}, y {n_y}, x {n_x}, {self.dtype}, "
            f"spacing (x, y, z) {spacing}, {self.orientation}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(type(self), world_from_index=self._world_from_index, name=self._name), (self._samples,)


def _as_array(samples: ArrayLike) -> NDArray[Any]:
    """An array; a masked one keeps its mask."""
    if isinstance(samples, np.ma.MaskedArray):
        return samples
    try:
        return np.asarray(samples)
    except ValueError:
        raise ArgumentError("the samples are rows of different lengths; give an array [z, y, x]") from None


def _renderable(array: NDArray[Any], name: str) -> NDArray[Any]:
    """A read-only, C-contiguous, native-endian 3-D array of a type the renderer takes; shared where possible."""
    _check_shape(array, name)
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.result_type(array.dtype, np.float32)), np.nan)
    dtype = _renderable_dtype(array, name)
    shared = np.require(array, dtype, ["C", "A"]).view()
    shared.flags.writeable = False
    return shared


def _check_shape(array: NDArray[Any], name: str) -> None:
    shape = tuple(array.shape)
    if array.ndim == 2:
        raise ArgumentError(
            f"volume {name!r}: the array is 2-D, shape {shape}; a volume is [z, y, x]: "
            "stack at least two slices with np.stack(slices)"
        )
    if array.ndim == 4:
        raise ArgumentError(
            f"volume {name!r}: the array is 4-D, shape {shape}; a volume is [z, y, x]: pick one time point or channel, "
            f"as array[n] with n = 0..{shape[0] - 1} or array[..., n] with n = 0..{shape[3] - 1}"
        )
    if array.ndim != 3:
        raise ArgumentError(f"volume {name!r}: the array is {array.ndim}-D, shape {shape}; a volume is 3-D, [z, y, x]")
    if 0 in shape:
        raise ArgumentError(f"volume {name!r}: shape {shape} (z, y, x) holds no samples; every axis needs at least 1")


def _renderable_dtype(array: NDArray[Any], name: str) -> np.dtype[Any]:
    dtype = array.dtype.newbyteorder("=")
    if dtype in NATIVE_DTYPES:
        return dtype
    if dtype.kind == "b":
        return np.dtype(np.uint8)
    if dtype.kind == "f":
        return np.dtype(np.float32 if dtype.itemsize == 2 else np.float64)
    if dtype.kind in "iu":
        return _narrowest_integer(array)
    hint = "take np.abs, .real or .imag" if dtype.kind == "c" else "convert them with array.astype"
    raise ArgumentError(f"volume {name!r}: samples are {array.dtype}, not real numbers; {hint}")


def _narrowest_integer(array: NDArray[Any]) -> np.dtype[Any]:
    """The smallest integer type that holds every sample of a 64-bit array exactly, else float64."""
    lowest, highest = int(array.min()), int(array.max())
    for dtype in NATIVE_DTYPES:
        if dtype.kind in "iu":
            limits = np.iinfo(dtype)
            if limits.min <= lowest and highest <= limits.max:
                return dtype
    return np.dtype(np.float64)


def _checked_affine(
    spacing: Sequence[float] | None, world_from_index: ArrayLike | None, name: str
) -> NDArray[np.float64]:
    if world_from_index is None:
        matrix = affine.from_spacing((1.0, 1.0, 1.0) if spacing is None else spacing)
    elif spacing is not None:
        raise ArgumentError(f"volume {name!r}: got both spacing and world_from_index; give one of them")
    else:
        try:
            matrix = np.array(world_from_index, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ArgumentError(f"volume {name!r}: world_from_index is no array of numbers; give 4 x 4") from None
        if matrix.shape != (4, 4):
            raise ArgumentError(f"volume {name!r}: world_from_index has shape {matrix.shape}; it must be (4, 4)")
        if matrix[3].tolist() != [0, 0, 0, 1]:
            raise ArgumentError(
                f"volume {name!r}: the last row of world_from_index is {matrix[3].tolist()}; it must be 0, 0, 0, 1"
            )
    matrix.flags.writeable = False
    return matrix
