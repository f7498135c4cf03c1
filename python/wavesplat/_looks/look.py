"""Look: all that decides how a volume is shown, but the camera's distance and the picture's size.

It is 3D Slicer's volume property preset, with the operator and the view that go with it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Literal

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.sampling import Composite, composite_name
from wavesplat._model.arguments.types import check_text, takes_its_types
from wavesplat._model.volume.volume_like import VolumeLike, as_volume, volume_or_none
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.curves.colormaps import Opacity
    from wavesplat._looks.labels.labels import Labels


@public
@dataclass(frozen=True, kw_only=True)
class Look:
    """A transfer function, the light, the operator, the view and the background that it is made for.

    Parameters
    ----------
    transfer_function : TransferFunction or TransferFunction2D
        Colours and opacities of the values.
    shading : Shading or None
        Light; None draws the colours as given.
    composite : str, default "over"
        Operator along a ray, as for `render`.
    view : str, optional
        Name of a view, as for `render`; None is the view that fits the volume.
    background : str, optional
        Colour behind the volume, as for `render`; None leaves it open.
    labels : Labels, optional
        A segmentation that is drawn with it.
    part : str, optional
        Part of the body that is drawn: "brain" of a head in MR, by a simple extraction, not for measuring. The samples
        stay; where no brain is found, all is drawn, and a note says why. "cut open" leaves out the front corner, or the
        front half of a stack that is seen along its slices, so that planes through the middle are seen; volumes that
        are not held in memory are drawn whole, and a note says so. None draws all.
    name : str
        Name of the preset, "auto", or "" for one of your own.
    reason : str
        For which data it is, or why it was chosen for these.

    Examples
    --------
    >>> import wavesplat as ws
    >>> look = ws.Look.auto(ws.examples.ct_pelvis())
    >>> look.composite
    'over'
    """

    transfer_function: TransferFunction | TransferFunction2D
    shading: Shading | None = field(default_factory=Shading)
    composite: Composite = "over"
    view: str | None = None
    background: str | None = None
    labels: Labels | None = None
    part: Literal["brain", "cut open"] | None = None
    name: str = ""
    reason: str = ""

    def __post_init__(self) -> None:
        for name in ("name", "reason"):
            if not isinstance(getattr(self, name), str):
                raise ArgumentError(f"{name} of the look is {described(getattr(self, name))}; give a text")
        object.__setattr__(self, "composite", composite_name(self.composite))
        if self.part not in (None, "brain", "cut open"):
            raise ArgumentError(f'part of the look is {described(self.part)}; give "brain", "cut open" or None')
        for name in ("view", "background", "name", "reason"):
            check_text(getattr(self, name), f"{name} of the look")
        colors.parse(self.background)

    def __repr__(self) -> str:
        rest = [self.composite, *([] if self.shading else ["no shading"]), *([self.view] if self.view else [])]
        labels = [] if self.labels is None else [repr(self.labels)]
        return f"<Look {self.name!r}: {', '.join([*rest, repr(self.transfer_function), *labels])}>"

    @classmethod
    @takes_its_types
    def auto(cls, volume: VolumeLike, composite: Composite | None = None, *, colormap: str | None = None) -> Look:
        """A look for a first picture, by the kind of data that the volume holds; `reason` says which, and why.

        Parameters
        ----------
        volume : Volume, WaveletVolume, array, or what else `Volume` takes
            Any data.
        composite : str, optional
            Operator; None takes the one that suits the kind of data.
        colormap : str, optional
            Of fields: this map's colours, over the same values and with the same opacities, instead of the look's own.
            Names as in `TransferFunction.from_colormap`.

        Raises
        ------
        ArgumentError
            If all samples are equal. If there is no operator or map of that name, or the look is
            not one of a field, such as the look of a CT or of a projection.
        """
        from wavesplat._looks.kinds import automatic

        shown = as_volume(volume)
        look = automatic.automatic(shown, composite)
        return look if colormap is None else automatic.in_colors(look, shown, colormap)

    @classmethod
    @takes_its_types
    def preset(cls, name: str, volume: VolumeLike | None = None) -> Look:
        """A look by name, which usually looks good on one kind of data.

        Parameters
        ----------
        name : str
            For CT in Hounsfield units: "ct-bone", "ct-angio", "ct-lung", "ct-skin", "ct-muscle", "ct-heart",
            "ct-soft-tissue", "ct-vessels". Fitted to the volume's values: presets for MR, PET, microscopy and
            simulation, and "auto" (see `auto`). 3D Slicer's presets, such as "CT-AAA" or "MR-Default"; where ours has
            the same name, "slicer-" before it means theirs. `wavesplat presets` lists all. Case does not matter, and
            "-", "_" and a blank are alike.
        volume : Volume or WaveletVolume, optional
            Needed for the presets that are fitted to the volume's values; the others are checked against it.

        Raises
        ------
        ArgumentError
            If there is no preset of that name (the message offers near ones), or it needs a volume.

        Warns
        -----
        WavesplatWarning
            If the preset is for Hounsfield units and the volume's values do not look like them.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Look.preset("CT Bone").transfer_function.opacity_unit
        1.0
        """
        from wavesplat._looks import presets

        return presets.preset(name, volume_or_none(volume))

    @classmethod
    def channel(
        cls,
        volume: VolumeLike,
        color: str | Iterable[float] | None = None,
        window: Iterable[float | str] | None = None,
        composite: Composite = "over",
    ) -> Look:
        """A look for a channel of fluorescence: light of one colour, without shading, that rises over a window.

        Parameters
        ----------
        volume : Volume or WaveletVolume
            The channel.
        color : colour, optional
            "green", "magenta", "cyan", "yellow", "red", "blue", "#rrggbb" or (r, g, b). None is what the file says, or
            green.
        window : (low, high), optional
            Values up to the first are clear, from the second on they have the full light: numbers, or percentiles of
            the samples, such as ("1%", "99.8%"). None is the window of the file; where it has none, or one of all
            values that there could be, or one that next to no sample or most of them exceed, percentiles of the
            samples.
        composite : str, default "over"
            Operator: "over" shows what is in front of what; with "maximum", as microscopes show it, colours of several
            channels are added.

        Raises
        ------
        ArgumentError
            If the colour, the window or the operator is none.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(16)
        >>> ws.Look.channel(volume, "magenta", (0.2, 0.9)).reason
        'a channel in its colour, from 0.2 to 0.9'
        """
        from wavesplat._looks.kinds import channels

        return channels.channel_look(as_volume(volume), color, window, composite_name(composite))

    @takes_its_types
    def changed(
        self,
        *,
        window: Iterable[float | str] | None = None,
        gamma: float = 1.0,
        opacity: Opacity | None = None,
        exposure: float = 1.0,
        volume: VolumeLike | None = None,
    ) -> Look:
        """The same look with another window, brightness or opacity: its colours, light and operator stay.

        Parameters
        ----------
        window : (low, high), optional
            Sample values that the look's first and last node move to, and the others in proportion: numbers, or
            percentiles of the volume's samples, such as ("1%", "99.8%").
        gamma : float, default 1
            A value at place t of the window, 0..1, gets the colour of the place t ** gamma: less than 1 brightens
            mid-tones. Opacities stay.
        opacity : str, float or sequence, optional
            Curve of opacity over the window, as for `TransferFunction.from_colormap`.
        exposure : float, default 1
            Factor of light, above 0. With shading it is the light's; without, matter gives off so much more light:
            colours are brighter in the same hue, and above 1 matter is denser too.
        volume : Volume or WaveletVolume, optional
            Needed for percentiles.

        Raises
        ------
        ArgumentError
            If a number is out of range, or the look has no window: it is of labels, a step at one value, or a transfer
            function of two dimensions.

        Examples
        --------
        >>> import wavesplat as ws
        >>> look = ws.Look.channel(ws.examples.ripples(16), "green", (0, 1))
        >>> look.changed(window=(0.2, 0.8)).transfer_function.color[-1][0]
        0.8
        """
        from wavesplat._looks import changed

        shown = volume_or_none(volume)
        return changed.changed(self, shown, window=window, gamma=gamma, opacity=opacity, exposure=exposure)

    @classmethod
    @takes_its_types
    def from_json(cls, text: str, volume: VolumeLike | None = None) -> Look:
        """The look that a JSON text describes, as `to_json` writes it.

        Parameters
        ----------
        text : str
            An object with `version` 1 and `transfer_function`, which is an object as `TransferFunction.to_json` or
            `TransferFunction2D.to_json` writes it. Optional: `shading` (the arguments of `Shading`, or null),
            `composite`, `view`, `background`, `name` and `description`.
        volume : Volume or WaveletVolume, optional
            Needed when the values of the transfer function are relative to a volume's.

        Raises
        ------
        ArgumentError
            If it is not such a text; the message names the field.

        Examples
        --------
        >>> import wavesplat as ws
        >>> look = ws.Look.preset("ct-bone")
        >>> ws.Look.from_json(look.to_json()) == look
        True
        """
        from wavesplat._looks import look_files as look_json

        return look_json.parse(text, volume_or_none(volume))

    def to_json(self) -> str:
        """The look as a JSON text, which `from_json` reads back exactly."""
        from wavesplat._looks import look_files as look_json

        return look_json.write(self)

    @classmethod
    def load(cls, path: str | PathLike[str], volume: VolumeLike | None = None, name: str | None = None) -> Look:
        """The look in a file, ours or one of 3D Slicer or ParaView; what is in the file decides which.

        Parameters
        ----------
        path : path
            JSON as `save` or `TransferFunction.save` writes it; 3D Slicer's `.vp`, `.vp.json` and scenes such as
            `presets.xml`, with their light; ParaView's colour maps, `.json` and `.xml`, and the maps in its states,
            `.pvsm` and `.py`, which are read and never run.
        volume : Volume or WaveletVolume, optional
            Needed where values are relative to a volume's. Colour maps of ParaView from 0 to 1 are stretched over its
            values; Slicer's gradients are per mean of its spacings.
        name : str, optional
            Which one, if the file holds several; case does not matter.

        Raises
        ------
        FileError
            If the file cannot be read.
        ArgumentError
            If it is none of these, or holds several and none is named.

        Notes
        -----
        Opacities of Slicer are taken as opacities of 1 mm, VTK's ScalarOpacityUnitDistance where nothing else is said.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Look.preset("ct-bone").save("bone.json")
        >>> ws.Look.load("bone.json").name
        'ct-bone'
        """
        from wavesplat._looks import look_files

        return look_files.load(path, volume_or_none(volume), name)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the look to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        """
        from wavesplat._storage import json_texts

        json_texts.save(path, self.to_json())
