"""Names of devices: parts of the names of this machine's GPUs select one."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat import gpu
from wavesplat._render import devices
from wavesplat._render.devices import chosen_device
from wavesplat.errors import ArgumentError


@pytest.fixture
def adapters(monkeypatch):
    """A machine with two GPUs of unusual names."""
    found = [gpu.Adapter(name, "Vulkan", "discrete", "1.0", 1, 2) for name in ("Fancy Pixelmill", "Other")]
    monkeypatch.setattr(gpu, "adapters", lambda: found)
    monkeypatch.setattr(devices, "_FOUND", set())
    return found


@pytest.mark.parametrize(
    "name", ["nonsense", "cuda:0", "zz", "CPU 1", "gpus", "NVIDIA", "RTX 4090", "A100", "Radeon", "no such GPU"]
)
def test_a_name_of_no_gpu_is_an_error_that_lists_the_gpus(adapters, name):
    with pytest.raises(
        ArgumentError,
        match=f"device is '{name}', and no GPU .* its GPUs: Fancy Pixelmill Vulkan, Other Vulkan; give part of one of",
    ):
        chosen_device(name)


def test_a_machine_without_gpus_says_so(adapters):
    adapters.clear()
    with pytest.raises(ArgumentError, match="its GPUs: none"):
        ws.render(np.eye(8)[None].repeat(8, 0), size=(8, 8), device="NVIDIA")


@pytest.mark.parametrize("name", ["pixelmill", "Fancy", "VULKAN", "mill vulkan"])
def test_a_gpu_of_this_machine_is_known_by_any_part_of_its_name(adapters, name):
    assert chosen_device(name) == name
    adapters.clear()  # drivers are asked once for a name
    assert chosen_device(name) == name


def test_a_fork_leaves_the_answer_to_the_compiled_module(adapters, monkeypatch):
    """A forked process cannot list the GPUs; the CPU draws, and the report says why."""
    adapters.clear()
    monkeypatch.setattr(devices, "_PROCESS", -1)
    assert chosen_device("pixelmill") == "pixelmill"


@pytest.mark.parametrize(("given", "meant"), [("CPU", "cpu"), (" gpu ", "gpu"), ("Auto", "auto")])
def test_kinds_of_devices(monkeypatch, given, meant):
    monkeypatch.delenv("WAVESPLAT_DEVICE", raising=False)
    assert chosen_device(given) == meant


def test_the_variable_is_checked_too(adapters, monkeypatch):
    monkeypatch.setenv("WAVESPLAT_DEVICE", "nonsense")
    with pytest.raises(ArgumentError, match="WAVESPLAT_DEVICE is 'nonsense'"):
        chosen_device("auto")
