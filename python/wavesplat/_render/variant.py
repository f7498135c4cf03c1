"""The parts of high-resolution splatting, each to be left out or changed, for studies of what they buy."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from operator import index
from typing import Any, Literal, TypeAlias

from wavesplat import _native
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Variant"]

GradientScheme: TypeAlias = Literal["footprint", "footprint-forward", "sheet-central", "sheet-forward"]
Footprint: TypeAlias = Literal["exact", "nearest", "nearest-noise"]


@public
@dataclass(frozen=True, kw_only=True)
class Variant:
    """How splatting is carried out. The default is the renderer as it is; each switch shows what one part of it buys.

    Parameters
    ----------
    view_angle_correction : bool, default True
        A sheet that rays cross at an angle theta to its normal stands for dz / cos(theta) of them. False: for dz, so
        that pictures get fainter as the view tilts. Composite "over" and "sum" see the difference.
    kernel_slicing : bool, default True
        A sheet is made of all slices within the kernel's radius, weighted by the kernel there. False: of the samples of
        the nearest slice alone, so that sheets between two slices repeat them.
    gradient : str, default "footprint"
        Where shading takes gradients, axis by axis of the grid; d is `Shading.gradient_offset`, in samples.
        "footprint": [V(x + d) - V(x - d)] / 2d at every texel. "footprint-forward": [V(x + d) - V(x)] / d, towards
        larger indices. "sheet-central", "sheet-forward": the same differences of the texels and sheets that there are,
        as sheet buffers give them: d becomes the nearest whole number of texels (along x and y) or of sheets (along z),
        at least one, and at most 4 samples. A small d gives the neighbours.
    footprint : str, default "exact"
        The weights within a sheet. "exact": the kernel. "nearest": the nearest entry of a table, which turns slopes
        into stairs. "nearest-noise": the same with every sample of each sheet displaced by up to half an entry, which
        turns the stairs into grain. The noise is a hash of the sample's place, so that pictures repeat; weights are
        scaled to sum 1, so that what is flat stays flat. It is slow.
    footprint_entries : int, 2 to 1024, default 8
        Entries of that table per sample distance.

    Raises
    ------
    ArgumentError
        If a name is unknown or the number of entries out of its range.

    Examples
    --------
    >>> import wavesplat as ws
    >>> plain = ws.Variant(view_angle_correction=False, kernel_slicing=False)
    >>> ws.render(ws.examples.ripples(8), variant=plain, size=(8, 8)).size
    (8, 8)

    Notes
    -----
    The alternatives are those of "High Resolution Image Splatting", IJACEN 2(7), 2014. Without view-angle correction or
    kernel slicing, slabs are not pre-integrated (`render`'s `refined`): pictures are made of plain sheets.
    """

    view_angle_correction: bool = True
    kernel_slicing: bool = True
    gradient: GradientScheme = "footprint"
    footprint: Footprint = "exact"
    footprint_entries: int = 8
    _core: _native.Variant = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        # Checked at once, so that an error points at the line that made it.
        try:
            entries = index(self.footprint_entries)
        except TypeError:
            raise ArgumentError(f"footprint_entries is {self.footprint_entries!r}; give a whole number") from None
        if not 2 <= entries <= 1024:
            raise ArgumentError(f"footprint_entries is {entries}; give a whole number between 2 and 1024")
        switches = (bool(self.view_angle_correction), bool(self.kernel_slicing))
        core = _native.Variant(*switches, str(self.gradient), str(self.footprint), entries)
        object.__setattr__(self, "_core", core)

    def __reduce__(self) -> tuple[Any, ...]:
        settings = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "_core"}
        return partial(type(self), **settings), ()
