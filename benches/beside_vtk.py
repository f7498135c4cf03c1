"""Our first picture, ours with the points and the light of a preset of 3D Slicer, and VTK's with these, side by side.

    make looks-beside-vtk               needs VTK (pip install vtk) and the volumes of BENCH_DATA

VTK's vtkFixedPointVolumeRayCastMapper draws with one headlight, as Slicer's default view does, a step of half a voxel
and the same orthographic camera. Each picture is compared with its own renderer's supersampled one: three times the
pixels along each side, and for VTK half the step. Luminance: Rec. 709 weights on encoded values, of pixels that are not
black.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import numpy as np
import vtk
from numpy.typing import NDArray
from sheets import Sheet, mean_luminance
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import wavesplat as ws

DATA = Path(os.environ.get("BENCH_DATA", "../shared/data"))
CASES = [
    ("ct_abdomen_pelvis_3mm.nii.gz", "slicer-CT-AAA"),
    ("ct_abdomen_pelvis_3mm.nii.gz", "slicer-CT-Muscle"),
    ("ct_pelvis_right.nii.gz", "slicer-CT-Bones"),
    ("mri_head_t1.nii.gz", "slicer-MR-Default"),
]
SIDE = 512
FINER = 3


def main() -> None:
    """Draw, measure, write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/looks"))
    arguments = parser.parse_args()
    sheet = Sheet(3, len(CASES), SIDE)
    print(f"{'':46s} {'mean':>6s} {'clipped':>8s} {'dB':>6s}")
    for row, (path, preset) in enumerate(CASES):
        volume = ws.open(DATA / path)
        look = ws.Look.preset(preset, volume)
        eye = ws.Camera.orbit(volume, 0, 0, fit="view")
        columns = [
            ("ours by itself", lambda n, v=volume, e=eye: _ours(v, None, e, n)),
            (f"ours, {preset}", lambda n, v=volume, e=eye, a=look: _ours(v, a, e, n)),
            (f"VTK, {preset}", lambda n, v=volume, e=eye, a=look: _vtk(v, a, e, n)),
        ]
        for column, (name, draw) in enumerate(columns):
            rgb = draw(1)
            finer = draw(FINER).reshape(SIDE, FINER, SIDE, FINER, 3).mean(axis=(1, 3))
            psnr = -10 * np.log10(max(float(np.mean((rgb - finer) ** 2)), 1e-12))
            encoded = np.round(255 * rgb)
            seen = (encoded > 6).any(axis=2)
            mean = mean_luminance(encoded)
            clipped = 100 * float((encoded[seen] >= 255).all(axis=1).mean())
            text = f"{name}: mean {mean:.0f}, clipped {clipped:.2f} %, {psnr:.1f} dB"
            print(f"{volume.name[:20]:20s} {name:25s} {mean:6.1f} {clipped:8.2f} {psnr:6.1f}", flush=True)
            sheet.put(column, row, encoded.astype(np.uint8), text)
    sheet.save(arguments.out / "beside_vtk.png")


def _ours(volume: ws.Volume, look: ws.Look | None, eye: ws.Camera, finer: int) -> NDArray[np.float64]:
    side = finer * SIDE
    rgba = ws.render(volume, look, eye, size=(side, side), background="black").rgba
    return np.clip(rgba[..., :3].astype(np.float64), 0, 1)


def _vtk(volume: ws.Volume, look: ws.Look, eye: ws.Camera, finer: int) -> NDArray[np.float64]:
    image = vtk.vtkImageData()
    image.SetDimensions(*volume.shape[::-1])
    image.SetSpacing(*volume.spacing)
    samples = numpy_to_vtk(volume.samples.ravel(), deep=True)
    image.GetPointData().SetScalars(samples)
    step = 0.5 * min(volume.spacing) / (2 if finer > 1 else 1)
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetImageSampleDistance(1.0)
    mapper.SetSampleDistance(step)
    mapper.SetInteractiveSampleDistance(step)
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.IntermixIntersectingGeometryOff()
    mapper.SetInputData(image)
    actor = vtk.vtkVolume()
    actor.SetMapper(mapper)
    actor.SetProperty(_property(look))
    # The affine that remains is a rotation.
    turned = volume.world_from_index.copy()
    turned[:3, :3] /= np.array(volume.spacing)
    matrix = vtk.vtkMatrix4x4()
    matrix.DeepCopy(turned.ravel().tolist())
    actor.SetUserMatrix(matrix)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(actor)
    light = vtk.vtkLight()
    light.SetLightTypeToHeadlight()
    light.SetAmbientColor(1, 1, 1)
    renderer.AddLight(light)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(finer * SIDE, finer * SIDE)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*eye.focal_point)
    camera.SetPosition(*eye.position)
    camera.SetViewUp(*eye.view_up)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(eye.parallel_scale)
    renderer.ResetCameraClippingRange()
    window.Render()
    pixels: Any = vtk.vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, finer * SIDE - 1, finer * SIDE - 1, 1, pixels)
    rgba = vtk_to_numpy(pixels).reshape(finer * SIDE, finer * SIDE, 4)[::-1]
    return rgba[..., :3].astype(np.float64) / 255


def _property(look: ws.Look) -> Any:
    function, shading = look.transfer_function, look.shading
    assert isinstance(function, ws.TransferFunction)
    opacity, color, by_gradient = (
        vtk.vtkPiecewiseFunction(),
        vtk.vtkColorTransferFunction(),
        vtk.vtkPiecewiseFunction(),
    )
    for value, alpha in function.opacity:
        opacity.AddPoint(value, alpha)
    for value, red, green, blue in function.color:
        color.AddRGBPoint(value, red, green, blue)
    for magnitude, factor in function.gradient_opacity:
        by_gradient.AddPoint(magnitude, factor)
    shown = vtk.vtkVolumeProperty()
    shown.SetScalarOpacity(opacity)
    shown.SetColor(color)
    if function.gradient_opacity:
        shown.SetGradientOpacity(by_gradient)
    shown.SetInterpolationTypeToLinear()
    shown.SetScalarOpacityUnitDistance(function.opacity_unit or 1.0)
    if shading is not None:
        shown.ShadeOn()
        shown.SetAmbient(shading.ambient)
        shown.SetDiffuse(shading.diffuse)
        shown.SetSpecular(shading.specular)
        shown.SetSpecularPower(shading.specular_power)
    return shown


if __name__ == "__main__":
    main()
