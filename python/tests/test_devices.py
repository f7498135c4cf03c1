"""Names of devices: what is kept for a GPU that may be elsewhere, and what is a slip."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat import gpu
from wavesplat._render.devices import chosen_device
from wavesplat.errors import ArgumentError


@pytest.fixture
def adapters(monkeypatch):
    """A machine with one GPU of an unusual name."""
    found = [gpu.Adapter("Fancy Pixelmill", "Vulkan", "discrete", "1.0", 1, 2)]
    monkeypatch.setattr(gpu, "adapters", lambda: found)
    return found


@pytest.mark.parametrize(
    "name", ["nonsense", "cuda", "cuda:0", "opengl", "zz", "cpu0", "CPU 1", "gpus", "the fast one"]
)
def test_a_slip_is_an_error_that_lists_what_there_is(adapters, name):
    with pytest.raises(
        ArgumentError, match=r'give "auto", "cpu", "gpu" or .*this machine has: Fancy Pixelmill Vulkan$'
    ):
        chosen_device(name)


def test_a_machine_without_gpus_says_so(adapters):
    adapters.clear()
    with pytest.raises(ArgumentError, match="this machine has: none"):
        ws.render(np.eye(8)[None].repeat(8, 0), size=(8, 8), device="nonsense")


@pytest.mark.parametrize(
    "name",
    ["NVIDIA", "RTX 4090", "A100", "H100", "L40S", "4090", "Apple M2", "Radeon", "llvmpipe", "no such GPU", "dx12"],
)
def test_a_gpu_that_may_be_elsewhere_is_kept(monkeypatch, name):
    monkeypatch.setattr(gpu, "adapters", lambda: pytest.fail("drivers were asked"))
    assert chosen_device(name) == name


def test_a_gpu_of_this_machine_is_known_by_any_part_of_its_name(adapters):
    assert chosen_device("pixelmill") == "pixelmill"


@pytest.mark.parametrize(("given", "meant"), [("CPU", "cpu"), (" gpu ", "gpu"), ("Auto", "auto")])
def test_kinds_of_devices(monkeypatch, given, meant):
    monkeypatch.delenv("WAVESPLAT_DEVICE", raising=False)
    assert chosen_device(given) == meant


def test_the_variable_is_checked_too(adapters, monkeypatch):
    monkeypatch.setenv("WAVESPLAT_DEVICE", "nonsense")
    with pytest.raises(ArgumentError, match="WAVESPLAT_DEVICE is 'nonsense'"):
        chosen_device("auto")
