"""GPUs of this machine, tests of whether they draw what the CPU draws, and the limit of their memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from wavesplat import _native
from wavesplat._system.memory import bytes_of

__all__ = ["Adapter", "SelfTest", "adapters", "memory", "self_test"]


@dataclass(frozen=True)
class Adapter:
    """A GPU as its driver describes it.

    Attributes
    ----------
    name : str
        Name of the GPU: `device` of `wavesplat.render` takes it, or a part of it.
    backend : str
        "Vulkan", "Metal" or "DX12".
    kind : str
        "discrete", "integrated", "virtual", "other"; or "software", a program on the processor, which is used by its
        name alone.
    driver : str
        Name and version of the driver.
    vendor_id, device_id : int
        Numbers of maker and model, as on PCI.
    """

    name: str
    backend: str
    kind: str
    driver: str
    vendor_id: int
    device_id: int


@dataclass(frozen=True)
class SelfTest:
    """Result of opening a GPU and testing it.

    Attributes
    ----------
    reason : str or None
        Why it is not used; None where it draws what the CPU draws.
    gathers : bool
        Whether four samples are fetched at once; else one by one.
    timestamps : bool
        Whether it can measure how long it draws.
    texture_side, texture_layers, buffer_bytes : int
        Limits of its textures and buffers; 0 where it is not used.
    """

    reason: str | None
    gathers: bool = False
    timestamps: bool = False
    texture_side: int = 0
    texture_layers: int = 0
    buffer_bytes: int = 0


def adapters() -> list[Adapter]:
    """The GPUs of this machine, the best first; none where no driver is installed.

    Examples
    --------
    >>> import wavesplat as ws
    >>> all(adapter.backend in ("Vulkan", "Metal", "DX12") for adapter in ws.gpu.adapters())
    True
    """
    return [Adapter(**fields) for fields in _native.gpu_adapters()]


def self_test(name: str) -> SelfTest:
    """Open the first GPU whose name has this in it, and test it: samples, the exponential, a small picture.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.gpu.self_test("no such GPU").reason is None
    False
    """
    fields: dict[str, Any] = _native.gpu_check(name)
    return SelfTest(**fields)


def memory(limit: float | str | None = None) -> int:
    """Most bytes of samples that a GPU keeps; volumes that do not fit are drawn in pages, those that are seen.

    Parameters
    ----------
    limit : str or float, optional
        A new limit, such as "4 GB". It is 1.6 GB before: no driver says how much is free.

    Raises
    ------
    ArgumentError
        If it is no amount of memory.

    Examples
    --------
    >>> import wavesplat as ws
    >>> before = ws.gpu.memory()
    >>> ws.gpu.memory("2 GB")
    2000000000
    >>> ws.gpu.memory(before) == before
    True
    """
    return _native.gpu_memory(None if limit is None else bytes_of(limit, "limit"))
