"""A surface and balls in a volume: ours, VTK's and the ray caster's, in the same run; see `shapes.py`.

VTK draws by vtkOpenGLGPUVolumeRayCastMapper, the only one of its mappers that composites translucent geometry with
matter (dual depth peeling); without a GPU its program runs on the processor. It has the same transfer function, camera
and headlight, a step of half a voxel, and eight samples a pixel for edges where the window allows them.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import vtk
from numpy.typing import NDArray
from shapes import bumpy_ball
from sheets import Sheet
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import wavesplat as ws

SIDE = 256
#: Opacity and colour by Hounsfield units: faint flesh, bone that is half clear.
OPACITY = [(-200.0, 0.0), (0.0, 0.01), (150.0, 0.02), (300.0, 0.3), (1500.0, 0.6)]
COLOR = [(-200.0, 0.6, 0.3, 0.2), (150.0, 0.9, 0.6, 0.5), (300.0, 1.0, 0.95, 0.85), (1500.0, 1.0, 1.0, 1.0)]
LIGHT = {"ambient": 0.1, "diffuse": 0.7, "specular": 0.2, "specular_power": 10.0}


def compare(folder: Path) -> None:
    """Draw the three pictures for opaque and clear surfaces, print PSNR and times, write a sheet."""
    scan = ws.examples.ct_pelvis()
    look = ws.TransferFunction(OPACITY, COLOR, opacity_unit=min(scan.spacing))
    eye = ws.Camera.orbit(scan, 30, 20)
    lower, upper = np.array(scan.bounds)
    vertices, faces = bumpy_ball(120, (lower + upper) / 2, 90.0)
    spots = lower + np.random.default_rng(3).random((200, 3)) * (upper - lower)
    sheet = Sheet(3, 2, SIDE)
    print(f"{'':10s} {'ours':>9s} {'VTK':>9s}   PSNR against the ray caster; seconds of ours, VTK's")
    for row, opacity in enumerate((1.0, 0.4)):
        surface = ws.Surface(vertices, faces, color="orange", opacity=opacity)
        shapes = [surface, ws.Points(spots, radius=4.0, color="cyan")]
        scene = ws.Scene(ws.Layer(scan, look), geometry=shapes, shading=ws.Shading.headlight(), background="black")
        begin = time.perf_counter()
        ours = scene.render(eye, size=(SIDE, SIDE), device="cpu").rgba[..., :3]
        middle = time.perf_counter()
        theirs = by_vtk(scan, eye, (vertices, faces, opacity), spots)
        seconds = middle - begin, time.perf_counter() - middle
        wanted = ws.reference.raycast(scene, camera=eye, size=(SIDE, SIDE), step=0.1, rays_per_pixel=4).rgba[..., :3]
        pictures = {"ours": ours, "VTK": theirs, "ray caster": wanted}
        numbers = [psnr(picture, wanted) for picture in (ours, theirs)]
        told = f"{numbers[0]:6.1f} dB {numbers[1]:6.1f} dB   {seconds[0]:.2f} s, {seconds[1]:.2f} s"
        print(f"opacity {opacity:.1f} {told}")
        for column, (name, picture) in enumerate(pictures.items()):
            sheet.put(column, row, np.round(255 * np.clip(picture, 0, 1)).astype(np.uint8), f"{name}, {opacity}")
    sheet.save(folder / "shapes_beside_vtk.png")


def psnr(picture: NDArray[Any], wanted: NDArray[Any]) -> float:
    """PSNR in dB of colours of 0 to 1."""
    error = np.clip(picture, 0, 1).astype(np.float64) - np.clip(wanted, 0, 1)
    return float(-10 * np.log10(max(np.mean(error**2), 1e-12)))


def by_vtk(
    scan: ws.Volume,
    eye: ws.Camera,
    surface: tuple[NDArray[Any], NDArray[Any], float],
    spots: NDArray[Any],
) -> NDArray[np.float64]:
    """VTK's picture, shape (SIDE, SIDE, 3)."""
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(_volume(scan))
    vertices, faces, opacity = surface
    renderer.AddActor(_actor(_mesh(vertices, faces), (1.0, 0.6471, 0.0), opacity))
    ball = vtk.vtkSphereSource()
    ball.SetRadius(4.0)
    ball.SetThetaResolution(24)
    ball.SetPhiResolution(24)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(spots, deep=True))
    places = vtk.vtkPolyData()
    places.SetPoints(points)
    balls = vtk.vtkGlyph3D()
    balls.SetInputData(places)
    balls.SetSourceConnection(ball.GetOutputPort())
    balls.ScalingOff()
    balls.Update()
    renderer.AddActor(_actor(balls.GetOutput(), (0.0, 1.0, 1.0), 1.0))
    light = vtk.vtkLight()
    light.SetLightTypeToHeadlight()
    light.SetAmbientColor(1, 1, 1)
    renderer.AddLight(light)
    renderer.SetUseDepthPeeling(1)
    renderer.SetUseDepthPeelingForVolumes(1)
    renderer.SetMaximumNumberOfPeels(20)
    renderer.SetOcclusionRatio(0.0)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*eye.focal_point)
    camera.SetPosition(*eye.position)
    camera.SetViewUp(*eye.view_up)
    camera.SetParallelProjection(eye.parallel_scale is not None)
    if eye.parallel_scale is not None:
        camera.SetParallelScale(eye.parallel_scale)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(1)
    window.SetSize(SIDE, SIDE)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    return pixels.reshape(SIDE, SIDE, 3)[::-1].astype(np.float64) / 255


def _volume(scan: ws.Volume) -> Any:
    image = vtk.vtkImageData()
    image.SetDimensions(*scan.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(scan.samples.ravel(), deep=True))
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for value, alpha in OPACITY:
        opacity.AddPoint(value, alpha)
    for value, red, green, blue in COLOR:
        color.AddRGBPoint(value, red, green, blue)
    look = vtk.vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(color)
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(min(scan.spacing))
    look.ShadeOn()
    _light(look)
    mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetSampleDistance(0.5 * min(scan.spacing))
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    matrix = vtk.vtkMatrix4x4()
    for row in range(4):
        for column in range(4):
            matrix.SetElement(row, column, scan.world_from_index[row, column])
    volume.SetUserMatrix(matrix)
    return volume


def _mesh(vertices: NDArray[Any], faces: NDArray[Any]) -> Any:
    mesh = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    mesh.SetPoints(points)
    cells = vtk.vtkCellArray()
    ends = np.arange(0, 3 * len(faces) + 1, 3)
    cells.SetData(numpy_to_vtk(ends, deep=True), numpy_to_vtk(faces.ravel().astype(np.int64), deep=True))
    mesh.SetPolys(cells)
    smooth = vtk.vtkPolyDataNormals()
    smooth.SetInputData(mesh)
    smooth.SplittingOff()
    smooth.Update()
    return smooth.GetOutput()


def _actor(data: Any, rgb: tuple[float, float, float], opacity: float) -> Any:
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*rgb)
    look.SetSpecularColor(1, 1, 1)
    look.SetOpacity(opacity)
    look.SetInterpolationToPhong()
    _light(look)
    return actor


def _light(look: Any) -> None:
    look.SetAmbient(LIGHT["ambient"])
    look.SetDiffuse(LIGHT["diffuse"])
    look.SetSpecular(LIGHT["specular"])
    look.SetSpecularPower(LIGHT["specular_power"])
