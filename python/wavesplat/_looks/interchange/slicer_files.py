"""Volume properties of 3D Slicer: its built-in presets, `presets.xml` and other scenes, `.vp` and `.vp.json` files.

What is taken over, and how:

- Points of scalar opacity and colour, as they are; between them VTK's curves (`vtk_curves`).
- Opacity unit: Slicer leaves VTK's ScalarOpacityUnitDistance at 1, so opacities are for 1 mm, which is how
  `opacity_unit=1` reads them: both take a step s as 1 - (1 - alpha)^s. A `.vp.json` file can say another.
- Gradient opacity: VTK's magnitudes are per mean of the three spacings, ours per world unit. VTK multiplies the opacity
  of a step by the factor, we the extinction: the same where a step is faint.
- Light: one white headlight, its ambient, diffuse and specular terms, or none if the property is not shaded. Ours is
  two-sided, and Slicer's background is blue; it shows black here. The terms add up to more than 1 where a face is
  turned to the light. VTK's mapper for CPUs clips that, so that a smooth bright bone is a white bar. Its mapper for
  GPUs, which Slicer draws with, shows next to no highlights (of an upright cylinder, in the middle of its height only),
  and less light away from the middle of the picture, since its headlight is at the eye. Ours keeps the highlights, and
  compresses colours above our usual shoulder.
- Not taken over: interpolation, effective range, and all but the first component.

Sources: github.com/Slicer/Slicer, Modules/Loadable/VolumeRendering (storage nodes, schema, developer guide), commit
583e9b37; `crates/look` has the points of its presets.xml.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.interchange import vtk_curves
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

WHAT = "volume property of 3D Slicer"
TAG = "VolumeProperty"
#: Contents of the lines of a `.vp` file, in order.
VP_LINES = (
    "interpolation",
    "shade",
    "diffuse",
    "ambient",
    "specular",
    "specular power",
    "scalar opacity",
    "gradient opacity",
    "color",
)
#: Midpoint and sharpness of points that have none.
MIDPOINT, SHARPNESS = 0.5, 0.0


@dataclass(frozen=True, kw_only=True)
class VolumeProperty:
    """Slicer's record of a look; nodes as for `TransferFunction`, but magnitudes are per mean spacing."""

    name: str
    shade: bool
    ambient: float
    diffuse: float
    specular: float
    specular_power: float
    opacity: list[tuple[float, ...]]
    color: list[tuple[float, ...]]
    gradient_opacity: list[tuple[float, ...]]
    opacity_unit: float = 1.0

    def look(self, volume: Volume | WaveletVolume | None) -> Look:
        """The look; without a volume its spacings count as 1."""
        spacing = 1.0 if volume is None else sum(volume.spacing) / 3
        gradient = [(max(magnitude, 0.0) / spacing, factor) for magnitude, factor in self.gradient_opacity]
        # Where the factor is 1 for all, gradients need not be looked at.
        gradient = gradient if any(factor != 1 for magnitude, factor in gradient if magnitude > 0) else []
        light = Shading.headlight(
            ambient=self.ambient,
            diffuse=self.diffuse,
            specular=self.specular,
            specular_power=max(self.specular_power, 1.0),
            shoulder=Shading().shoulder,
        )
        return Look(
            transfer_function=TransferFunction(self.opacity, self.color, self.opacity_unit, gradient),
            shading=light if self.shade else None,
            name=self.name,
            reason=f"3D Slicer's {self.name}.",
        )


def from_xml(root: Element) -> list[VolumeProperty]:
    """The volume properties of a scene, such as `presets.xml`, in its order."""
    found = [_of_attributes(element.attrib) for element in root.iter(TAG)]
    if not found:
        raise ArgumentError(f"{WHAT}: the scene has no <{TAG}>")
    return found


def from_vp(text: str, name: str) -> VolumeProperty:
    """The volume property of a `.vp` file: nine lines of numbers."""
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) < len(VP_LINES):
        raise ArgumentError(f"{WHAT}: {len(lines)} lines; a .vp file has {len(VP_LINES)}: {', '.join(VP_LINES)}")
    fields = dict(zip(VP_LINES, lines, strict=False))
    return VolumeProperty(
        name=name,
        shade=_number(fields["shade"], "shade") != 0,
        ambient=_number(fields["ambient"], "ambient"),
        diffuse=_number(fields["diffuse"], "diffuse"),
        specular=_number(fields["specular"], "specular"),
        specular_power=_number(fields["specular power"], "specular power"),
        opacity=_nodes(fields["scalar opacity"], "scalar opacity", 2),
        gradient_opacity=_nodes(fields["gradient opacity"], "gradient opacity", 2),
        color=_nodes(fields["color"], "color", 4),
    )


def from_json(document: dict[str, Any], name: str) -> list[VolumeProperty]:
    """The volume properties of a `.vp.json` file."""
    try:
        components = [properties["components"][0] for properties in document["volumeProperties"]]
        return [_of_component(component, name) for component in components]
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise ArgumentError(f"{WHAT}: not as its schema volume-property-schema-v1.0.0 says: {error!r}") from None


def _of_attributes(fields: dict[str, str]) -> VolumeProperty:
    missing = [name for name in ("scalarOpacity", "colorTransfer") if name not in fields]
    if missing:
        raise ArgumentError(f"{WHAT}: {fields.get('name', TAG)!r} has no {missing[0]}")
    return VolumeProperty(
        name=fields.get("name", ""),
        shade=_number(fields.get("shade", "0"), "shade") != 0,
        ambient=_number(fields.get("ambient", "0.1"), "ambient"),
        diffuse=_number(fields.get("diffuse", "0.7"), "diffuse"),
        specular=_number(fields.get("specular", "0.2"), "specular"),
        specular_power=_number(fields.get("specularPower", "10"), "specularPower"),
        opacity=_nodes(fields["scalarOpacity"], "scalarOpacity", 2),
        gradient_opacity=_nodes(fields.get("gradientOpacity", "0"), "gradientOpacity", 2),
        color=_nodes(fields["colorTransfer"], "colorTransfer", 4),
    )


def _of_component(fields: dict[str, Any], name: str) -> VolumeProperty:
    light = fields.get("lighting", {})
    if "rgbTransferFunction" in fields:
        color = _points(fields["rgbTransferFunction"], "color")
    else:
        color = [(x, grey, grey, grey) for x, grey in _points(fields["grayTransferFunction"], "y")]
    gradient = fields.get("gradientOpacity")
    return VolumeProperty(
        name=name,
        shade=bool(fields.get("shade", False)),
        ambient=float(light.get("ambient", 0.1)),
        diffuse=float(light.get("diffuse", 0.7)),
        specular=float(light.get("specular", 0.2)),
        specular_power=float(light.get("specularPower", 10.0)),
        opacity=_points(fields["scalarOpacity"], "y"),
        gradient_opacity=_points(gradient, "y") if gradient and not fields.get("disableGradientOpacity") else [],
        color=color,
        opacity_unit=float(fields.get("scalarOpacityUnitDistance", 1.0)),
    )


def _points(function: dict[str, Any], what: str) -> list[tuple[float, ...]]:
    nodes = []
    for point in function["points"]:
        values = point[what] if isinstance(point[what], list) else [point[what]]
        nodes.append((point["x"], *values, point.get("midpoint", MIDPOINT), point.get("sharpness", SHARPNESS)))
    return vtk_curves.line_nodes(nodes)


def _number(text: str, what: str) -> float:
    try:
        return float(text.split(maxsplit=1)[0])
    except (ValueError, IndexError):
        raise ArgumentError(f"{WHAT}: {what} is {text!r}; it must be a number") from None


def _nodes(text: str, what: str, n_each: int) -> list[tuple[float, ...]]:
    """Nodes of "count x y x y ..."; the count is of numbers, not of nodes."""
    try:
        # Text after an arrow is a remark, as in Slicer's own documentation.
        count, *numbers = (float(part) for part in re.split(r"=>|#", text)[0].split())
    except ValueError:
        raise ArgumentError(f"{WHAT}: {what} is {text!r}; it must be a count and so many numbers") from None
    if count != len(numbers) or len(numbers) % n_each:
        raise ArgumentError(
            f"{WHAT}: {what} says {count:g} numbers, and has {len(numbers)}; {n_each} are needed for every point"
        )
    nodes = [tuple(numbers[start : start + n_each]) for start in range(0, len(numbers), n_each)]
    return sorted(nodes, key=lambda node: node[0])
