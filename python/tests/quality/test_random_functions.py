"""Peaks, steps and gaps of opacity, however thin or faint, against closed forms, by the study of random functions."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import wavesplat as ws

STUDY = Path(__file__).parents[3] / "studies" / "random_functions" / "random_functions.py"
RAMP = np.broadcast_to(np.linspace(0, 100, 16, dtype=np.float32)[:, None, None], (16, 16, 16))
CAMERA = ws.Camera((7.5, 7.5, 100), (7.5, 7.5, 7.5), (0, 1, 0), parallel_scale=4)


@pytest.fixture(scope="module")
def study():
    spec = importlib.util.spec_from_file_location("random_functions", STUDY)
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        # Dataclasses look up their module by name.
        patch.setitem(sys.modules, spec.name, module)
        spec.loader.exec_module(module)
        yield module


def test_random_functions_are_integrated(study, is_night):
    errors = [study.measured(case) for case in study.cases(seed=20, n=54 if is_night else 27)]
    faults = [f"{e.case.kind}: {fault}" for e in errors for fault in e.faults()]
    assert faults == []


@pytest.mark.nightly  # by day: `test_a_thin_peak_is_integrated` at every quality
def test_a_better_quality_is_no_worse_on_a_ball(study):
    case = study.Case("peak", [(49.8, 0), (50, 1), (50.2, 0)], [(0, 1, 1, 1)], None, 16, 0, 0)
    psnr_db = study.ball_psnr_db(case)
    assert psnr_db["draft"] < psnr_db["normal"] < psnr_db["fine"] < psnr_db["high"]
    assert psnr_db["high"] > 35


def opacity_of(opacity, quality, volume=RAMP, **options):
    look = ws.TransferFunction(opacity, [(0, 1, 1, 1)], **options)
    picture = ws.render(volume, look, CAMERA, size=(8, 8), shading=None, quality=quality, device="cpu")
    return float(picture.rgba[4, 4, 3])


@pytest.mark.parametrize("quality", ["draft", "normal", "fine", "high"])
@pytest.mark.parametrize("half_width", [1.0, 0.25, 0.1, 0.01, 0.001])
@pytest.mark.parametrize("top", [0.1, 0.3, 0.9, 0.999_999, 1.0])
def test_a_thin_peak_is_integrated(top, half_width, quality):
    # The mean of -ln(1 - a) from 0 to the top, over 15 voxels of 100 values.
    mean = 1.0 if top == 1 else 1 + (1 - top) * np.log1p(-top) / top
    wanted = 1 - np.exp(-2 * half_width * 0.15 * mean)
    got = opacity_of([(50 - half_width, 0), (50, top), (50 + half_width, 0)], quality)
    assert got == pytest.approx(wanted, rel=0.03, abs=2e-4)


@pytest.mark.parametrize("quality", ["draft", "normal", "fine", "high"])
@pytest.mark.parametrize("half_width", [10.0, 1.0, 0.01])
def test_a_plateau_of_opacity_1_is_opaque_however_thin(half_width, quality):
    lo, hi = 50 - half_width, 50 + half_width
    assert opacity_of([(lo, 0), (lo, 1), (hi, 1), (hi, 0)], quality) > 0.999


@pytest.mark.parametrize("unit", [1.0, 1000.0])
@pytest.mark.parametrize("value", [40.0, 50.0])
def test_even_matter_at_a_node_of_opacity_1_is_opaque(value, unit):
    even = np.full((4, 16, 16), value, np.float32)
    even[:, :2] = 0
    assert opacity_of([(0, 0), (value, 1), (87.3, 0)], "normal", even, opacity_unit=unit) > 0.999


def test_the_reference_integrates_a_peak_that_a_step_of_a_ray_hits():
    # 15 voxels in steps of 0.2: the middle of one is at the value 50.
    look = ws.TransferFunction([(40, 0), (50, 1), (60, 0)], [(0, 1, 1, 1)])
    picture = ws.reference.raycast(RAMP, look, CAMERA, size=(2, 2), step=0.2, shading=None)
    assert picture.rgba[0, 0, 3] == pytest.approx(1 - np.exp(-20 * 0.15), abs=0.02)
