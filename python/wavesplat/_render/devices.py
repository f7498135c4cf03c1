"""The argument `device`: "auto", "cpu", "gpu", or part of the name of a GPU of this machine."""

from __future__ import annotations

import os

from wavesplat import gpu
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Environment variable with the device that "auto" stands for: for jobs and tests.
DEVICE_VARIABLE = "WAVESPLAT_DEVICE"
KINDS = ("auto", "cpu", "gpu")

#: Names known to be among the GPUs, which drivers take long to list: not again for every picture.
_FOUND: set[str] = set()
#: The process that imported this: a fork of it may have no access to the GPUs that it lists.
_PROCESS = os.getpid()


def chosen_device(device: str) -> str:
    """The device that should draw, as the compiled module takes it.

    Raises
    ------
    ArgumentError
        If it is no device of this machine; the message lists the GPUs.
    """
    name: object = device
    if not (isinstance(name, str) and name.strip()):
        raise ArgumentError(
            f'device is {described(device)}; give "auto", "cpu", "gpu" or part of a name of wavesplat.gpu.adapters()'
        )
    asked = device.strip()
    if asked.lower() != "auto":
        return _known(asked, "device")
    return _known(os.environ.get(DEVICE_VARIABLE, "").strip() or "auto", DEVICE_VARIABLE)


def _known(name: str, what: str) -> str:
    if name.lower() in KINDS:
        return name.lower()
    if name.lower() in _FOUND:
        return name
    adapters = [f"{adapter.name} {adapter.backend}" for adapter in gpu.adapters()]
    if not adapters and os.getpid() != _PROCESS:
        return name  # the compiled module draws by the CPU, and its report says that the process is a fork
    if not any(name.lower() in adapter.lower() for adapter in adapters):
        there = ", ".join(adapters) if adapters else "none"
        raise ArgumentError(
            f"{what} is {described(name)}, and no GPU of this machine has this in its name; its GPUs: {there}; "
            'give part of one of these names, "auto", "cpu" or "gpu"'
        )
    _FOUND.add(name.lower())
    return name
