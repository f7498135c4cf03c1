"""Arrays of vectors: the numbers of one component, or of the length of the vectors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import COLORS, quantity_of
from wavesplat._readers.request import Request, choose
from wavesplat.errors import ArgumentError

AXES = "xyz"
#: Components of a vector.
N_COMPONENTS = 3
#: Note on vectors of which no component is chosen.
LENGTH_NOTE = '{!r} holds vectors, of which the length is drawn; or component="x" (--component x)'


def is_length(n_components: int, dtype: np.dtype[Any], request: Request) -> bool:
    """Whether the length of vectors is drawn: then components are interpolated, not lengths."""
    is_asked = request.component in (None, "magnitude") and 1 < n_components <= len(AXES)
    return is_asked and _are_vectors(n_components, dtype, request)


def _are_vectors(n_components: int, dtype: np.dtype[Any], request: Request) -> bool:
    """Whether components are drawn as one number: three that are no colours, and none is chosen as a channel."""
    if request.component is not None:
        return True
    return n_components == N_COMPONENTS and dtype != np.uint8 and request.channel is None


def facts_of_colors(n: int, dtype: np.dtype[Any], request: Request, *, are_colors: bool = False) -> dict[str, Any]:
    """The channels, as arguments of `Facts`, of numbers that are red, green and blue: three bytes, or said to be."""
    is_rgb = n == N_COMPONENTS and (are_colors or dtype == np.uint8)
    if request.component is not None or not (is_rgb or (are_colors and n == len(COLORS))):
        return {}
    return {"channels": COLORS[:n], "channel": COLORS[request.channel or 0]}


def component_of(numbers: NDArray[Any], request: Request, name: str) -> tuple[NDArray[Any], tuple[str, ...]]:
    """The samples that are drawn of an array [..., component], and sentences about them.

    name : the array, in messages.
    """
    number, guesses = chosen_component(numbers.shape[-1], numbers.dtype, request, name)
    return (length_along(numbers, axis=-1) if number is None else numbers[..., number]), guesses


def chosen_component(n: int, dtype: np.dtype[Any], request: Request, name: str) -> tuple[int | None, tuple[str, ...]]:
    """The number of the component that is drawn of an array of `n`, None for the length, and sentences about it."""
    wanted = request.component
    if n == 1 and wanted is None:
        return 0, ()
    if not _are_vectors(n, dtype, request):
        return choose("channel", n, request.channel, request.path), ()
    if request.channel is not None:
        raise ArgumentError(
            f"component= and channel= both choose one of several numbers; leave one out: {request.path}"
        )
    if n == 1 or n > len(AXES) or (wanted is not None and wanted in AXES[n:]):
        raise ArgumentError(
            f"component={wanted!r}, but {name!r} has {n} {'number' if n == 1 else 'numbers'} at each place; "
            f"leave it out: {request.path}"
        )
    if wanted in ("x", "y", "z"):
        return AXES.index(wanted), ()
    return None, () if wanted else (LENGTH_NOTE.format(name),)


def quantity_of_array(name: str, n: int, dtype: np.dtype[Any], request: Request) -> str | None:
    """The name of what is drawn of an array of `n` components, such as "velocity magnitude"."""
    quantity = quantity_of(name)
    if quantity is None or n == 1 or not _are_vectors(n, dtype, request):
        return quantity
    return f"{quantity} {request.component or 'magnitude'}"


def check_vectors(request: Request, name: str) -> None:
    """Raise an `ArgumentError` where a component is asked for of an array that turned out to hold no vectors."""
    if request.component is not None:
        raise ArgumentError(f"component={request.component!r}, but {name!r} holds no vectors: {request.path}")


def has_vectors(shape: Sequence[int], dtype: np.dtype[Any], request: Request) -> bool:
    """Whether the last axis of an array is one of components: three, of floats, where the others are longer."""
    if len(shape) != 4 or request.time is not None or request.channel is not None:
        return False
    if request.component is not None:
        return shape[-1] == N_COMPONENTS
    return shape[-1] == N_COMPONENTS and min(shape[:3]) > N_COMPONENTS and dtype.kind == "f"


def length_along(numbers: NDArray[Any], axis: int) -> NDArray[Any]:
    """The length of vectors whose components lie along an axis."""
    return length_of(list(np.moveaxis(numbers, axis, 0)))


def type_of_length(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """Type of the length of vectors: float64 for components of 32-bit integers or wider ones, else float32."""
    return np.dtype(np.float64 if dtype.itemsize > 4 or (dtype.kind != "f" and dtype.itemsize == 4) else np.float32)


def length_of(components: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """The length of vectors, as `type_of_length`.

    Infinite where no number is large enough, such as for the largest float, which marks missing vectors.
    """
    dtype = type_of_length(components[0].dtype)
    total = np.zeros(components[0].shape, dtype)
    with np.errstate(over="ignore"):
        for component in components:
            total += np.square(component, dtype=dtype)
        np.sqrt(total, out=total)
        if (is_over := np.isinf(total)).any():  # the square alone may be too large
            few = [component[is_over].astype(dtype) for component in components]
            total[is_over] = np.hypot.reduce(np.stack(few), axis=0)
    return total
