"""VTK's `vtkFixedPointVolumeRayCastMapper`, or its mapper for GPUs, on the scenes of `cases.toml`.

Two of its habits need a word: it multiplies the ambient term with the light's ambient colour, which is black unless
set, and it changes its sample distance by itself unless told not to.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scenes
import vtk
from numpy.typing import NDArray
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


class Scene:
    """A window off screen that draws a case."""

    def __init__(self, case: scenes.Case, sample_distance: float, *, on_gpu: bool = False) -> None:
        volume = scenes.load(case.volume)
        unit = min(volume.spacing)
        image = vtk.vtkImageData()
        image.SetDimensions(*volume.samples.shape[::-1])
        image.SetSpacing(*volume.spacing)
        self._samples = numpy_to_vtk(volume.samples.ravel(), deep=True)
        image.GetPointData().SetScalars(self._samples)
        curves = scenes.transfer_function(case)
        opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
        for value, alpha in curves.opacity:
            opacity.AddPoint(value, alpha)
        for value, red, green, blue in curves.color:
            color.AddRGBPoint(value, red, green, blue)
        look = vtk.vtkVolumeProperty()
        look.SetScalarOpacity(opacity)
        look.SetColor(color)
        look.SetInterpolationTypeToLinear()
        look.SetScalarOpacityUnitDistance(unit)
        look.ShadeOn()
        look.SetAmbient(0.1)
        look.SetDiffuse(0.7)
        look.SetSpecular(0.2)
        look.SetSpecularPower(10.0)
        mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper() if on_gpu else vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.SetImageSampleDistance(1.0)
        mapper.SetSampleDistance(sample_distance * unit)
        mapper.LockSampleDistanceToInputSpacingOff()
        if not on_gpu:
            mapper.SetNumberOfThreads(case.threads)
            mapper.SetInteractiveSampleDistance(sample_distance * unit)
            mapper.IntermixIntersectingGeometryOff()
        mapper.SetInputData(image)
        actor = vtk.vtkVolume()
        actor.SetMapper(mapper)
        actor.SetProperty(look)
        self._renderer = vtk.vtkRenderer()
        self._renderer.SetBackground(0, 0, 0)
        self._renderer.AddVolume(actor)
        light = vtk.vtkLight()
        light.SetLightTypeToHeadlight()
        light.SetAmbientColor(1, 1, 1)
        self._renderer.AddLight(light)
        self._window = vtk.vtkRenderWindow()
        self._window.SetOffScreenRendering(1)
        self._window.SetMultiSamples(0)
        self._window.SetSize(case.size, case.size)
        self._window.AddRenderer(self._renderer)
        self._case = case

    def draw(self, turn_deg: float) -> None:
        """Draw one frame."""
        view = scenes.camera(self._case, turn_deg)
        camera = self._renderer.GetActiveCamera()
        camera.SetFocalPoint(*view.focal_point)
        camera.SetPosition(*view.position)
        camera.SetViewUp(*view.view_up)
        camera.SetParallelProjection(view.parallel_scale is not None)
        if view.parallel_scale is not None:
            camera.SetParallelScale(view.parallel_scale)
        else:
            camera.SetViewAngle(scenes.VIEW_ANGLE_DEG)
        self._renderer.ResetCameraClippingRange()
        self._window.Render()

    def wait(self) -> None:
        """Wait until the frame is drawn."""
        self._window.WaitForCompletion()

    def renderer(self) -> str:
        """Name of the OpenGL renderer that drew."""
        told = self._window.ReportCapabilities() or ""
        lines = [line.split(":", 1)[1].strip() for line in told.splitlines() if line.startswith("OpenGL renderer")]
        return lines[0] if lines else "unknown"

    def picture(self) -> NDArray[np.float64]:
        """Picture of the view itself, over black."""
        self.draw(0.0)
        width, height = self._window.GetSize()
        pixels: Any = vtk.vtkUnsignedCharArray()
        self._window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 1, pixels)
        rgba = vtk_to_numpy(pixels).reshape(height, width, 4)[::-1]
        return rgba[..., :3].astype(np.float64) / 255
