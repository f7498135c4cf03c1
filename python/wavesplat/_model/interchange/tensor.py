"""Tensors of PyTorch, and arrays of other libraries that may lie in the memory of a GPU."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume.facts import Facts
from wavesplat.errors import ArgumentError

#: The library of an array -> how it is brought to the computer's memory.
FETCHED = {"cupy": "cupy.asnumpy(array)", "jax": "jax.device_get(array)", "numba": "array.copy_to_host()"}


def of_torch(tensor: Any) -> Converted:
    """Convert a tensor [z, y, x], detached from its gradient and copied from a GPU where it has to be.

    A `MetaTensor` of MONAI, which knows its affine, is [channel, x, y, z] in the RAS world.
    """
    if tensor.is_sparse:
        tensor = tensor.to_dense()
    bare = tensor.detach().cpu().resolve_conj().resolve_neg()
    if str(bare.dtype) in ("torch.bfloat16", "torch.float8_e4m3fn", "torch.float8_e5m2"):  # not known to NumPy
        bare = bare.float()
    samples = bare.numpy()
    if type(tensor).__name__ != "MetaTensor":
        return Converted(samples)
    if samples.ndim == 4:
        if samples.shape[0] != 1:
            raise ArgumentError(f"the tensor has {samples.shape[0]} channels; give one of them, as tensor[:1]")
        samples = samples[0]
    affine = np.asarray(tensor.affine.detach().cpu().numpy(), np.float64)
    conventions = ("axes of a patient, in mm: MONAI counts them so",)
    return Converted(np.asarray(samples).T, affine, Facts(unit="mm", is_anatomical=True, conventions=conventions))


def of_array(array: Any) -> NDArray[Any] | None:
    """The array of an object with NumPy's or DLPack's protocol; None for an object with neither."""
    ways = ("__array__", "__array_interface__", "__array_struct__", "__dlpack__", "__cuda_array_interface__")
    if not any(hasattr(array, way) for way in ways):
        return None
    try:
        if not any(hasattr(array, way) for way in ways[:3]) and hasattr(array, ways[3]):
            return np.from_dlpack(array)
        found = np.asarray(array)
    except (TypeError, ValueError, RuntimeError, BufferError, AttributeError) as error:
        root = type(array).__module__.partition(".")[0]
        if hasattr(array, "__cuda_array_interface__") or hasattr(array, "__dlpack_device__"):
            how = FETCHED.get(root, "its own way to NumPy")
            raise ArgumentError(
                f"a {root}.{type(array).__name__} may lie in the memory of a GPU; copy it first, with {how}"
            ) from error
        first_line = (str(error).splitlines() or [type(error).__name__])[0]
        raise ArgumentError(
            f"a {type(array).__name__} cannot be read as an array ({first_line}); convert it first"
        ) from error
    return None if found.dtype.kind == "O" and found.ndim == 0 else found
