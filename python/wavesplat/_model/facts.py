"""What a file says about a volume beside its samples and their place, and what had to be guessed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from math import isfinite
from typing import Any

from wavesplat._model import units
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Channel", "Facts"]


@public
@dataclass(frozen=True)
class Channel:
    """A channel of a file, as the file describes it.

    Parameters
    ----------
    name : str
        Empty where the file has none.
    color : three numbers 0..1, optional
        Red, green, blue that the file wants it shown in.
    emission_nm : float, optional
        Wavelength of the light that was measured, in nanometres.

    Raises
    ------
    ArgumentError
        If the colour is not three numbers 0..1, or the wavelength not positive.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Channel("DAPI", color=(0, 0, 1), emission_nm=461).color
    (0.0, 0.0, 1.0)
    """

    name: str = ""
    color: tuple[float, float, float] | None = None
    emission_nm: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", str(self.name))
        if self.color is not None:
            object.__setattr__(self, "color", _color(self.color))
        if self.emission_nm is not None:
            object.__setattr__(self, "emission_nm", _positive(self.emission_nm, "emission_nm"))


@public
@dataclass(frozen=True, kw_only=True)
class Facts:
    """What a file says about a volume; all of it may be left out.

    Parameters
    ----------
    unit : str, optional
        Of the world's axes: "km", "m", "cm", "mm", "um", "nm", "angstrom", "pm", or the name of another ("kpc").
        None: unknown, as for an array.
    is_anatomical : bool
        Whether the world's axes are a patient's (RAS: x to the right, y to the front, z up).
    modality : str, optional
        How it was measured, as DICOM shortens it ("CT", "MR", "PT", "NM", "US", "XA", ...), or "fluorescence" or "EM";
        None where the file does not say. It is never guessed from the values.
    channel : Channel, optional
        The one that the samples are of.
    channels : sequence of Channel
        All of the file, in order; empty where it describes none.
    n_times : int
        Time points in the file.
    time_step : float, optional
        Between them, in `time_unit`.
    time_unit : str, optional
        Such as "s".
    levels : sequence of shapes (z, y, x)
        Levels of detail in the file, the finest first; empty where there is but one.
    conventions : sequence of str
        What the file leaves to its format's custom, a sentence each.
    guesses : sequence of str
        What was assumed, since the file does not say it, and why; a sentence each.
    processing : sequence of str
        What was done to the samples since they were read, in order, such as by `Volume.smoothed`.

    Raises
    ------
    ArgumentError
        If a value cannot be right.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Facts(unit="micrometer", modality="fluorescence").unit
    'um'
    """

    unit: str | None = None
    is_anatomical: bool = False
    modality: str | None = None
    channel: Channel | None = None
    channels: tuple[Channel, ...] = ()
    n_times: int = 1
    time_step: float | None = None
    time_unit: str | None = None
    levels: tuple[tuple[int, int, int], ...] = ()
    conventions: tuple[str, ...] = ()
    guesses: tuple[str, ...] = ()
    processing: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        channels = tuple(self.channels)
        for channel in (*channels, *([] if self.channel is None else [self.channel])):
            if not isinstance(channel, Channel):
                raise ArgumentError(f"facts: a channel is a {type(channel).__name__}; give a wavesplat.Channel")
        if self.n_times < 1:
            raise ArgumentError(f"facts: n_times is {self.n_times}; give 1 or more")
        given = {
            "unit": units.checked(self.unit),
            "is_anatomical": bool(self.is_anatomical),
            "modality": None if self.modality is None else str(self.modality),
            "channels": channels,
            "n_times": int(self.n_times),
            "time_step": None if self.time_step is None else float(self.time_step),
            "levels": tuple((int(z), int(y), int(x)) for z, y, x in self.levels),
            "conventions": _sentences(self.conventions, "conventions"),
            "guesses": _sentences(self.guesses, "guesses"),
            "processing": _sentences(self.processing, "processing"),
        }
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def as_json(self) -> dict[str, Any]:
        """As a dictionary of what JSON has."""
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Facts:
        """What `as_json` made of facts; a field of a later release is left out.

        Raises
        ------
        ArgumentError
            If a value cannot be right.
        """
        given = {field.name: document[field.name] for field in fields(cls) if field.name in document}
        for name, value in given.items():
            if name == "channel" and value is not None:
                given[name] = Channel(**value)
            elif name == "channels":
                given[name] = tuple(Channel(**channel) for channel in value)
        return cls(**given)


def _color(color: Iterable[float]) -> tuple[float, float, float]:
    try:
        red, green, blue = (float(share) for share in color)
    except (TypeError, ValueError):
        raise ArgumentError(f"color of a channel is {color!r}; give red, green and blue, 0..1 each") from None
    if not all(0 <= share <= 1 for share in (red, green, blue)):
        raise ArgumentError(
            f"color of a channel is ({red:g}, {green:g}, {blue:g}); give red, green and blue, 0..1 each"
        )
    return red, green, blue


def _positive(number: float, name: str) -> float:
    try:
        value = float(number)
    except (TypeError, ValueError):
        value = float("nan")
    if not (isfinite(value) and value > 0):
        raise ArgumentError(f"{name} of a channel is {number!r}; give a positive number")
    return value


def _sentences(texts: Iterable[str], name: str) -> tuple[str, ...]:
    if isinstance(texts, str):
        raise ArgumentError(f"facts: {name} is one text; give a list of them")
    return tuple(str(text) for text in texts)
