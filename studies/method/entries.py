"""Ways to draw that are compared: ray casting, standard splatting, high-resolution splatting, and its ablations."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import wavesplat as ws

#: Offsets of gradient differences to each side, in sample distances, as the paper varies them.
OFFSETS = (0.1, 0.5, 0.75, 1.0)
KERNELS = ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian")
TABLE_ENTRIES = 4


@dataclass(frozen=True)
class Entry:
    """A way to draw. `how`: keyword arguments of `draws`."""

    group: str
    label: str
    how: dict[str, Any] = field(default_factory=dict)
    gradient_offset: float = 1.0
    draws: Callable[..., ws.Picture] = ws.render

    @property
    def is_literal(self) -> bool:
        """Whether it is drawn by a literal twin, written to be exact and not to be fast."""
        return self.draws is ws.study.splat

    def draw(self, volume: ws.Volume, scene: dict[str, Any]) -> ws.Picture:
        """Draw a scene, the arguments that all ways have in common."""
        arguments = {**scene, "shading": ws.Shading.headlight(gradient_offset=self.gradient_offset), **self.how}
        return self.draws(volume, arguments.pop("transfer_function"), **arguments)


def standard(label: str, kernel: str = "linear", **choices: Any) -> Entry:
    """Entry of a kind of standard splatting."""
    how = {"kernel": kernel, "standard": ws.study.StandardSplatting(**choices)}
    return Entry("standard splatting", label, how, draws=ws.study.standard)


def rays(label: str, step: float, gradient_offset: float = 1.0) -> Entry:
    """Entry of the reference ray caster."""
    return Entry("ray casting", label, {"step": step}, gradient_offset, ws.reference.raycast)


RAYS = [rays(f"step {step}", step) for step in (1.0, 0.5, 0.25)]

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
    for quality in ("draft", "normal", "fine", "high")
]

#: Settings of high-resolution splatting; `at_equal_time` picks the best that takes no longer than standard splatting.
SETTINGS = [
    Entry(
        "high-resolution splatting",
        f"{sheets:g} per slice, {texels:g} texels per pixel",
        {"quality": ws.Sampling(sheets, texels)},
    )
    for sheets in (0.5, 1.0, 2.0)
    for texels in (0.35, 0.5, 0.7, 1.0)
]

#: The method by itself: two sheets a slice and nothing between them, as the paper has it but for the second sheet.
PLAIN = {"sheets_per_slice": 2.0, "oversampling": 1.0}


def plain(label: str, *, sheets: float = 2.0, pre_integration: bool = False) -> Entry:
    """Entry of the method by itself, by the fast renderer: the literal splatter without an ablation, to rounding."""
    how: dict[str, Any] = {"pre_integration": pre_integration, "early_ray_termination": False}
    how |= {"quality": ws.Sampling(sheets, PLAIN["oversampling"])}
    return Entry("the method, plain", label, how, draws=ws.study.render)


def ablation(group: str, label: str, offset: float = 1.0, **choices: Any) -> Entry:
    """Entry of the method with one part left out or changed."""
    return Entry(group, label, {**PLAIN, "ablation": ws.study.Ablation(**choices)}, offset, ws.study.splat)


BASE = plain("two sheets a slice")
UNCORRECTED = ablation("view angle", "not corrected", view_angle_correction=False)
ABLATIONS = [
    BASE,
    plain("pre-integrated between the sheets", pre_integration=True),
    plain("one sheet a slice", sheets=1.0),
    plain("four sheets a slice", sheets=4.0),
    UNCORRECTED,
    ablation("kernel slicing", "none: the nearest slice alone", kernel_slicing=False),
    *(
        ablation("gradient", f"{scheme}, d = {offset:g}", offset, gradient=scheme)
        for scheme in ("footprint", "footprint-forward", "sheet-central", "sheet-forward")
        for offset in OFFSETS
    ),
    ablation("footprint", f"nearest of {TABLE_ENTRIES} entries", footprint="nearest", footprint_entries=TABLE_ENTRIES),
    ablation(
        "footprint",
        f"nearest of {TABLE_ENTRIES}, noise on the samples",
        footprint="nearest-noise",
        footprint_entries=TABLE_ENTRIES,
    ),
    ablation("footprint", "nearest of 64 entries", footprint="nearest", footprint_entries=64),
]

#: Settings of high-resolution splatting against the signal itself, which is drawn with every kernel by every way.
FINE = {"quality": "high"}
#: Texels per pixel of standard splatting: as many as quality high has where surfaces are hard.
FINE_STANDARD = {"oversampling": 3.0}
PLACES: tuple[tuple[Literal["axis", "view"], str], ...] = (("axis", "along the axes"), ("view", "parallel to the view"))
AGAINST_SIGNAL = [
    rays("step 0.25, linear", 0.25),
    rays("step 0.25, linear, d = 0.1", 0.25, 0.1),
    *(
        Entry("high-resolution splatting", f"{kernel}, d = {offset:g}", {**FINE, "kernel": kernel}, offset)
        for kernel in KERNELS
        for offset in (1.0, 0.1)
    ),
    *(
        Entry(
            "standard splatting",
            f"{kernel}, sheets {where}",
            {**FINE_STANDARD, "kernel": kernel, "standard": ws.study.StandardSplatting(buffer=buffer)},
            draws=ws.study.standard,
        )
        for kernel in KERNELS
        for buffer, where in PLACES
    ),
]
