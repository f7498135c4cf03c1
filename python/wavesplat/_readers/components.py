"""Arrays of vectors: the numbers of one component, or of the length of the vectors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.facts import COLORS, quantity_of
from wavesplat._readers.request import Request, choose
from wavesplat.errors import ArgumentError

__all__ = [
    "AXES",
    "N_COMPONENTS",
    "as_channel",
    "check_vectors",
    "component_of",
    "facts_of_colors",
    "has_vectors",
    "is_length",
    "length_of",
    "named_component",
    "number_of_component",
    "quantity_of_array",
]

AXES = "xyz"
#: Components of a vector.
N_COMPONENTS = 3


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
    n = numbers.shape[-1]
    wanted = request.component
    if n == 1 and wanted is None:
        return numbers[..., 0], ()
    if not _are_vectors(n, numbers.dtype, request):
        return numbers[..., choose("channel", n, request.channel, request.path)], ()
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
        return numbers[..., AXES.index(wanted)], ()
    guesses = (
        () if wanted else (f'{name!r} holds vectors, of which the length is drawn; or component="x" (--component x)',)
    )
    return length_of([numbers[..., number] for number in range(n)]), guesses


def quantity_of_array(name: str, n: int, dtype: np.dtype[Any], request: Request) -> str | None:
    """The name of what is drawn of an array of `n` components, such as "velocity magnitude"."""
    quantity = quantity_of(name)
    if n == 1 or not _are_vectors(n, dtype, request):
        return quantity
    return named_component(quantity, replace(request, component=request.component or "magnitude"))


def named_component(quantity: str | None, request: Request) -> str | None:
    """The name of the component that is asked for, such as "velocity x"; the quantity itself where none is."""
    return quantity if quantity is None or request.component is None else f"{quantity} {request.component}"


def check_vectors(request: Request, name: str) -> None:
    """Raise an `ArgumentError` where a component is asked for of an array that turned out to hold no vectors."""
    if request.component is not None:
        raise ArgumentError(f"component={request.component!r}, but {name!r} holds no vectors: {request.path}")


def number_of_component(n: int, dtype: np.dtype[Any], request: Request, name: str) -> int:
    """The number of the component that is drawn of an array of `n`, for samples that are read in parts."""
    if request.component in (None, "magnitude") and n > 1 and _are_vectors(n, dtype, request):
        raise ArgumentError(
            f'{name!r} holds vectors, whose length is not made of parts; choose one component, as component="x" '
            f"(--component x), or leave out memory=: {request.path}"
        )
    numbers = np.arange(n)[None]
    return int(component_of(numbers.astype(dtype), request, name)[0][0])


def has_vectors(shape: Sequence[int], dtype: np.dtype[Any], request: Request) -> bool:
    """Whether the last axis of an array is one of components: three, of floats, where the others are longer."""
    if len(shape) != 4 or request.time is not None or request.channel is not None:
        return False
    if request.component is not None:
        return shape[-1] == N_COMPONENTS
    return shape[-1] == N_COMPONENTS and min(shape[:3]) > N_COMPONENTS and dtype.kind == "f"


def as_channel(shape: Sequence[int], dtype: np.dtype[Any], request: Request) -> Request:
    """The request with a component as the number of a channel, for samples that are read in parts."""
    if not has_vectors(shape, dtype, request):
        return request
    if request.component in (None, "magnitude"):
        raise ArgumentError(
            "the array holds vectors, whose length is not made of parts; choose one component, as "
            f'component="x" (--component x), or leave out memory=: {request.path}'
        )
    return replace(request, channel=AXES.index(request.component), component=None)


def length_of(components: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """The length of vectors: float64 of components of 32-bit integers or wider ones, else float32.

    Infinite where no number is large enough, as of the largest float that marks missing vectors.
    """
    wide = components[0].dtype.itemsize > 4 or (components[0].dtype.kind != "f" and components[0].dtype.itemsize == 4)
    dtype = np.float64 if wide else np.float32
    total = np.zeros(components[0].shape, dtype)
    with np.errstate(over="ignore"):
        for component in components:
            total += np.square(component, dtype=dtype)
        np.sqrt(total, out=total)
        if (is_over := np.isinf(total)).any():  # the square alone may be too large
            few = [component[is_over].astype(dtype) for component in components]
            total[is_over] = np.hypot.reduce(np.stack(few), axis=0)
    return total
