"""The argument `device`: what draws, by name.

A document or a script may name a GPU that this machine does not have, or not now: the CPU then draws, with a note. A
word that no GPU has in its name is a slip, and refused. The two are told apart by the words of makers, families and
drivers, and by model numbers, since no list of names is complete; only for other words are the drivers asked.
"""

from __future__ import annotations

import os
import re

from wavesplat import gpu
from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

__all__ = ["chosen_device"]

#: What "auto" is to be: for jobs and tests.
DEVICE_VARIABLE = "WAVESPLAT_DEVICE"
KINDS = ("auto", "cpu", "gpu")
#: Words in names of GPUs and of their drivers.
WORDS = re.compile(
    "adreno|amd|apple|arc|arm|asahi|ati|d3d12|dx12|firepro|geforce|gpu|graphics|grid|gtx|intel|instinct|iris|lavapipe|"
    "llvmpipe|mali|metal|mesa|microsoft|nvidia|nvk|powervr|quadro|qualcomm|radeon|radv|rdna|rtx|swiftshader|tegra|"
    "tesla|titan|turnip|uhd|vega|venus|videocore|virtio|vmware|vulkan|warp|xe"
)
#: Model numbers: A100, M2, L40S, 4090, 7900XTX.
MODEL = re.compile(r"(?!cpu)[a-z]{1,3}\d{1,5}[a-z]{0,3}|\d{3,5}[a-z]{0,3}")


def chosen_device(device: str) -> str:
    """What should draw, as the compiled module takes it.

    Raises
    ------
    ArgumentError
        If it is no device; the message lists what can be given.
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
    if _may_be_gpu(name):
        return name
    adapters = [f"{adapter.name} {adapter.backend}" for adapter in gpu.adapters()]
    if any(name.lower() in adapter.lower() for adapter in adapters):
        return name
    there = ", ".join(adapters) if adapters else "none"
    raise ArgumentError(
        f'{what} is {described(name)}; give "auto", "cpu", "gpu" or part of a GPU\'s name; this machine has: {there}'
    )


def _may_be_gpu(name: str) -> bool:
    """Whether a name has a word or a model number that GPUs have."""
    words = re.split(r"[^a-z0-9]+", name.lower())
    return any(WORDS.fullmatch(word) or MODEL.fullmatch(word) for word in words)
