"""What is compared: ray casting at several steps, standard splatting, high-resolution splatting, and its variants."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import wavesplat as ws

#: Half the width of the differences for gradients where the paper varies it, in sample distances.
OFFSETS = (0.1, 0.5, 0.75, 1.0)
KERNELS = ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian")
TABLE_ENTRIES = 4


@dataclass(frozen=True)
class Entry:
    """A way to draw. `how` are arguments of `render`; where there is a step, of the reference ray caster."""

    group: str
    label: str
    how: dict[str, Any] = field(default_factory=dict)
    step: float | None = None
    gradient_offset: float = 1.0
    #: Half a minute for a scan: only the ripples are drawn this way.
    is_slow: bool = False

    def draw(self, volume: ws.Volume, scene: dict[str, Any]) -> ws.Picture:
        """The picture of a scene, which is what all ways have in common."""
        arguments = {**scene, "shading": ws.Shading(gradient_offset=self.gradient_offset), **self.how}
        if self.step is not None:
            return ws.reference.raycast(volume, step=self.step, **arguments)
        return ws.render(volume, **arguments)


def standard(label: str, kernel: str = "linear", **choices: Any) -> Entry:
    """A kind of standard splatting."""
    how = {"method": "standard", "kernel": kernel, "standard": ws.StandardSplatting(**choices)}
    return Entry("standard splatting", label, how)


RAYS = [Entry("ray casting", f"step {step}", step=step) for step in (1.0, 0.5, 0.25)]

STANDARD = standard("sheets along the axes")
STANDARDS = [
    STANDARD,
    standard("the same, Gaussian", "gaussian"),
    standard("the same, cubic B-spline", "bspline3"),
    standard("the same, view angle not corrected", view_angle_correction=False),
    standard("sheets parallel to the view", buffer="view"),
    standard("the same, view angle not corrected", buffer="view", view_angle_correction=False),
]

QUALITIES = [
    Entry("high-resolution splatting", f'quality="{quality}"', {"quality": quality})
    for quality in ("draft", "normal", "high")
]

#: Settings among which the best that takes no longer than standard splatting is looked for.
SETTINGS = [
    Entry(
        "high-resolution splatting",
        f"{sheets:g} per slice, {texels:g} texels per pixel",
        {"sheets_per_slice": sheets, "oversampling": texels},
    )
    for sheets in (0.5, 1.0, 2.0)
    for texels in (0.35, 0.5, 0.7, 1.0)
]

#: Of the variants: two sheets a slice and nothing between them, as the paper has it but for the second sheet.
PLAIN = {"sheets_per_slice": 2.0, "oversampling": 1.0, "refined": False}


def variant(group: str, label: str, offset: float = 1.0, sheets: float = 2.0, **choices: Any) -> Entry:
    """One switch of the method."""
    how = {**PLAIN, "sheets_per_slice": sheets, "variant": ws.Variant(**choices)}
    return Entry(group, label, how, gradient_offset=offset)


BASE = variant("the method, plain", "two sheets a slice")
VARIANTS = [
    BASE,
    Entry("the method, plain", "pre-integrated between the sheets", {**PLAIN, "refined": True}),
    variant("the method, plain", "one sheet a slice", sheets=1.0),
    variant("the method, plain", "four sheets a slice", sheets=4.0),
    variant("view angle", "not corrected", view_angle_correction=False),
    variant("kernel slicing", "none: the nearest slice alone", kernel_slicing=False),
    *(
        variant("gradient", f"{scheme}, d = {offset:g}", offset, gradient=scheme)
        for scheme in ("footprint", "footprint-forward", "sheet-central", "sheet-forward")
        for offset in OFFSETS
    ),
    variant("footprint", f"nearest of {TABLE_ENTRIES} entries", footprint="nearest", footprint_entries=TABLE_ENTRIES),
    replace(
        variant(
            "footprint",
            f"nearest of {TABLE_ENTRIES}, noise on the samples",
            footprint="nearest-noise",
            footprint_entries=TABLE_ENTRIES,
        ),
        is_slow=True,
    ),
    variant("footprint", "nearest of 64 entries", footprint="nearest", footprint_entries=64),
]

#: Against the signal itself: every kernel, by every way to draw.
FINE = {"quality": "high"}
PLACES: tuple[tuple[Literal["axis", "view"], str], ...] = (("axis", "along the axes"), ("view", "parallel to the view"))
AGAINST_SIGNAL = [
    Entry("ray casting", "step 0.25, linear", step=0.25),
    Entry("ray casting", "step 0.25, linear, d = 0.1", step=0.25, gradient_offset=0.1),
    *(
        Entry("high-resolution splatting", f"{kernel}, d = {offset:g}", {**FINE, "kernel": kernel}, None, offset)
        for kernel in KERNELS
        for offset in (1.0, 0.1)
    ),
    *(
        Entry(
            "standard splatting",
            f"{kernel}, sheets {where}",
            {**FINE, "kernel": kernel, "method": "standard", "standard": ws.StandardSplatting(buffer=buffer)},
        )
        for kernel in KERNELS
        for buffer, where in PLACES
    ),
]
