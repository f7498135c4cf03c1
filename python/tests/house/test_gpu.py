"""Pictures of a GPU from Python: they are the CPU's, and their report names the device and the reason."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

import wavesplat as ws

#: The device of the tests: llvmpipe, which runs on the processor, unless another is asked for.
NAME = os.environ.get("WAVESPLAT_TEST_GPU", "llvmpipe")
LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5), (255, 1.0, 1.0, 1.0)])


@cache
def names() -> list[str]:
    return [adapter.name for adapter in ws.gpu.adapters()]


@pytest.fixture
def device():
    if not any(NAME.lower() in name.lower() for name in names()):
        if "WAVESPLAT_TEST_GPU" in os.environ:
            pytest.fail(f"{NAME} is asked for, and there is {names()}")
        pytest.skip("no software GPU: install mesa-vulkan-drivers")
    return NAME


def alike(a: ws.Picture, b: ws.Picture) -> bool:
    return bool(np.abs(a.rgba - b.rgba).max() <= 1 / 255) and b.rgba[..., 3].max() > 0.05


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"kernel": "catmull-rom", "camera": "isometric"},
        {"composite": "maximum"},
        {"composite": ws.FirstHit(120.0)},
        {"depth": True},
        {"psnr": 30},
        {"clip": ws.Crop((2, 3, 4), (20, 22, 18))},
    ],
    ids=["soft", "cubic", "maximum", "surface", "depth", "psnr", "crop"],
)
def test_pictures_are_those_of_the_cpu(device, options):
    volume = ws.examples.ripples(24)
    own = ws.render(volume, LOOK, size=(90, 70), device=device, **options)
    of_cpu = ws.render(volume, LOOK, size=(90, 70), device="cpu", **options)
    told = own.report["device"]
    assert NAME.lower() in told["name"].lower(), told
    assert told["reason"] is None
    assert of_cpu.report["device"] == {"name": "cpu", "reason": None}
    assert alike(own, of_cpu)
    if "depth" in options:
        assert np.array_equal(np.isnan(own.depth), np.isnan(of_cpu.depth))
        assert np.nanmax(np.abs(own.depth - of_cpu.depth)) < 0.01
    json.dumps(own.report)


def test_curves_that_end_in_opacity_1_are_those_of_the_cpu(device):
    samples = np.where(np.random.default_rng(1).random((16, 16, 16)) < 0.1, 385, 0.5).astype(np.float32)
    function = ws.TransferFunction.from_colormap("turbo", clim=(0, 31), opacity=[0.0, 1.0])
    options = {"size": (90, 70), "camera": "isometric"}
    other = ws.Layer(ws.examples.ripples(24), LOOK)
    for thing in (ws.Scene(ws.Volume(samples), function), ws.Scene([ws.Layer(ws.Volume(samples), function), other])):
        own = thing.render(device=device, **options)
        assert own.report["device"]["reason"] is None
        assert alike(own, thing.render(device="cpu", **options))


def test_scenes_with_labels_layers_and_light(device):
    volume = ws.examples.ripples(24)
    codes = np.zeros((24, 24, 24), np.uint8)
    codes[:, :12] = 1
    labels = ws.Labels(codes, {1: ws.Label("red", 0.3)})
    shading = ws.Shading(ambient_occlusion=0.6, shadow=0.5)
    one = ws.Scene(volume, LOOK, labels=labels, shading=shading)
    moved = ws.Volume(volume.samples, spacing=(0.8, 0.8, 0.8))
    for scene in (one, ws.Scene([volume, moved], [LOOK, LOOK])):
        own, of_cpu = (scene.render(size=(60, 60), device=name) for name in (device, "cpu"))
        assert own.report["device"]["reason"] is None
        assert alike(own, of_cpu)


def test_small_memory_means_pages(device):
    z, y, x = np.ogrid[-1:1:150j, -1:1:140j, -1:1:130j]
    volume = ws.Volume((255 * np.clip(1.1 - np.sqrt(x * x + y * y + z * z), 0, 1)).astype(np.uint8))
    whole = ws.render(volume, LOOK, size=(64, 64), device=device)
    before = ws.gpu.memory()
    try:
        ws.gpu.memory("3 MB")
        paged = ws.render(volume, LOOK, size=(64, 64), device=device)
        ws.gpu.memory("1 kB")
        by_cpu = ws.render(volume, LOOK, size=(64, 64), device=device)
    finally:
        ws.gpu.memory(before)
    assert [picture.report["device"]["paged"] for picture in (whole, paged)] == [False, True]
    assert np.array_equal(paged.rgba, whole.rgba)
    assert by_cpu.report["device"]["name"] == "cpu"
    assert "allowed" in by_cpu.report["device"]["reason"]
    assert alike(by_cpu, whole)


@pytest.mark.nightly  # by day: one volume has pages in `test_small_memory_means_pages`
def test_one_volume_in_two_layers_has_pages_for_each(device):
    z, y, x = np.ogrid[-1:1:140j, -1:1:150j, -1:1:150j]
    volume = ws.Volume((255 * np.clip(1.1 - np.sqrt(x * x + y * y + z * z), 0, 1)).astype(np.uint8))
    other = ws.TransferFunction([(20, 0.0), (90, 0.05)], [(0, 0.2, 0.5, 1.0)])
    scene = ws.Scene([volume, volume], [LOOK, other])
    before = ws.gpu.memory()
    try:
        ws.gpu.memory("6 MB")
        paged = [scene.render("left", size=(64, 64), device=device) for _ in range(2)]
    finally:
        ws.gpu.memory(before)
    assert paged[0].report["device"]["paged"]
    assert np.array_equal(paged[0].rgba, paged[1].rgba)
    assert alike(paged[0], scene.render("left", size=(64, 64), device="cpu"))


def test_light_that_turns_with_the_camera_does_not_fill_the_gpu(device):
    volume = ws.examples.ripples(24)
    scene = ws.Scene(volume, LOOK, shading=ws.Shading(shadow=0.6))
    told = [
        scene.render(ws.Camera.orbit(volume, angle, 20), size=(40, 40), device=device).report["device"]
        for angle in (0, 30, 60)
    ]
    assert len({one["sample_bytes"] for one in told}) == 1


def test_what_the_cpu_draws_is_said_with_the_reason(device):
    volume = ws.examples.ripples(16)
    lazy = ws.Volume.lazy(np.asarray(volume.samples), cache=False)
    report = ws.render(lazy, LOOK, size=(32, 32), device=device).report
    assert report["device"]["name"] == "cpu"
    assert "CPU" in report["device"]["reason"]
    assert f"drawn by the CPU: {report['device']['reason']}" in report["notes"]


def test_a_variable_says_what_auto_is(device, monkeypatch):
    monkeypatch.setenv("WAVESPLAT_DEVICE", device)
    volume = ws.examples.ripples(16)
    assert NAME.lower() in ws.render(volume, LOOK, size=(32, 32)).report["device"]["name"].lower()
    assert ws.render(volume, LOOK, size=(32, 32), device="cpu").report["device"]["name"] == "cpu"


def test_no_name_is_refused():
    for wrong in ("", None, 3):
        with pytest.raises(ws.errors.ArgumentError, match="device"):
            ws.render(ws.examples.ripples(8), LOOK, size=(8, 8), device=wrong)


def test_a_software_gpu_is_never_chosen_by_itself(monkeypatch):
    monkeypatch.delenv("WAVESPLAT_DEVICE", raising=False)
    volume = ws.examples.ripples(8)
    for device in ("auto", "gpu"):
        told = ws.render(volume, LOOK, size=(8, 8), device=device).report["device"]
        assert "llvmpipe" not in told["name"]
        assert told["name"] != "cpu" or told["reason"]


def test_no_driver_is_loaded_where_nobody_asks_for_one(monkeypatch):
    monkeypatch.delenv("WAVESPLAT_DEVICE", raising=False)
    code = """
import sys, numpy as np, wavesplat as ws
volume = ws.examples.ripples(8)
for _ in range(3):
    ws.render(volume, size=(8, 8), device=sys.argv[1])
print(any("vulkan" in line or "llvm" in line.lower() for line in open("/proc/self/maps")))
"""
    if not os.path.exists("/proc/self/maps") or os.path.exists("/dev/dri"):  # noqa: PTH110
        pytest.skip("this tells of Linux without a GPU")
    for device in ("cpu", "auto"):
        told = subprocess.run([sys.executable, "-c", code, device], capture_output=True, text=True, check=True)
        assert told.stdout.split() == ["False"]


def test_forked_processes_draw_on_the_cpu(device):
    if not hasattr(os, "fork"):
        pytest.skip("no fork here")
    code = """
import os, sys, wavesplat as ws
volume = ws.examples.ripples(12)
parent = ws.render(volume, size=(24, 24), device=sys.argv[1])
child = os.fork()
told = ws.render(volume, size=(24, 24), device=sys.argv[1]).report["device"]
if child == 0:
    os._exit(0 if told["name"] == "cpu" and "fork" in told["reason"] else 3)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), told["reason"])
"""
    told = subprocess.run([sys.executable, "-c", code, device], capture_output=True, text=True, check=True, timeout=600)
    assert told.stdout.split() == ["0", "None"]


def test_memory_is_an_amount():
    with pytest.raises(ws.errors.ArgumentError, match="limit"):
        ws.gpu.memory("much")


@pytest.mark.nightly
def test_the_command_compares_pictures(device):
    command = [sys.executable, "-m", "wavesplat", "gpu-check", device]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=1800).stdout
    assert "self-test passed" in told
    assert told.count("\n| ") >= 7
    rows = [line.split("|") for line in told.splitlines() if line.startswith("| ") and "---" not in line][1:]
    assert all(float(row[3]) <= 1 for row in rows), told
    none = subprocess.run([*command[:-1], "no such GPU"], capture_output=True, text=True, check=True).stdout
    assert "no GPU" in none
