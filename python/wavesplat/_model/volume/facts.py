"""Facts of a volume beside its samples and their place: statements of its file, and guesses; and quantities."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from inspect import signature
from math import isfinite
from operator import index
from typing import Any

from wavesplat import _native
from wavesplat._model.arguments.types import check_text, text_of
from wavesplat._model.volume import units
from wavesplat._public import public
from wavesplat._system import values
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Representation of an object as the call that makes it, without default arguments.


def short_repr(thing: Any) -> str:
    """`Facts(unit='mm')`: the arguments that differ from their defaults, read from the attributes of their names."""
    arguments = signature(type(thing)).parameters
    given = [
        f"{name}={value!r}"
        for name, argument in arguments.items()
        if (value := getattr(thing, name)) != argument.default
    ]
    return f"{type(thing).__name__}({', '.join(given)})"


# Quantities of calculated maps, as NIfTI and DICOM name them.
#
# Intents of NIfTI: nifti1.h, NIFTI_INTENT_*, by nibabel's names. Image types of DICOM: PS3.3, table C.8-130 (derived
# pixel contrast of CT and MR), and the words that scanners write for their own maps; they count only where the pixels
# are DERIVED.

(
    ADC,
    DIFFUSIVITY,
    ANISOTROPY,
    T1,
    T2,
    T2_STAR,
    BLOOD_FLOW,
    BLOOD_VOLUME,
    PERFUSION,
    Z_STATISTIC,
    T_STATISTIC,
    F_STATISTIC,
    P_VALUE,
) = _native.QUANTITIES
#: By nibabel's names of intents.
OF_INTENTS = {"z score": Z_STATISTIC, "t test": T_STATISTIC, "f test": F_STATISTIC, "p value": P_VALUE}
#: By values of ImageType (0008,0008) from the third on.
OF_IMAGE_TYPES = {
    "ADC": ADC,
    **dict.fromkeys(("FA", "DIFFUSION_ANISO"), ANISOTROPY),
    **dict.fromkeys(("T1 MAP", "T1_MAP"), T1),
    **dict.fromkeys(("T2 MAP", "T2_MAP"), T2),
    **dict.fromkeys(("T2_STAR MAP", "T2STAR MAP", "T2_STAR_MAP"), T2_STAR),
    **dict.fromkeys(("RCBF", "RELCBF", "CBF"), BLOOD_FLOW),
    **dict.fromkeys(("RCBV", "RELCBV", "CBV"), BLOOD_VOLUME),
    **dict.fromkeys(("MTT", "RELMTT", "TTP", "TMAX"), PERFUSION),
    "Z_SCORE": Z_STATISTIC,
    "T_TEST": T_STATISTIC,
}


def quantity_of_image_type(image_type: str) -> str | None:
    """The quantity that DICOM's ImageType names, values parted by backslashes; None of scans."""
    values = image_type.upper().split("\\")
    if values[0] != "DERIVED":
        return None
    return next((OF_IMAGE_TYPES[value] for value in map(str.strip, values[2:]) if value in OF_IMAGE_TYPES), None)


# Facts of a volume beside its samples and their place: statements of its file, and guesses.

#: Red, green and blue, 0..1.
Rgb = tuple[float, float, float]
#: Bound of time points: more than any file has.
MAX_TIMES = 2**53
#: Longest name of a unit of values.
LONGEST_UNIT = 40
#: Longest name of a quantity, and names of datasets and arrays that name none.
LONGEST_QUANTITY = 80
NO_QUANTITIES = {
    *("", "0", "arr_0", "array", "data", "dataset", "exported_data", "image", "imagefile", "imagescalars", "metaimage"),
    *("nrrdimage", "raw", "samples", "scalars", "tiff scalars", "values", "volume"),
}
#: Text in `Facts.processing` of samples that are the lengths of vectors.
LENGTH = "the length of the vectors"


@public
@dataclass(frozen=True)
class Channel:
    """A channel of a file, as the file describes it.

    Parameters
    ----------
    name : str
        Name of the channel; empty where the file has none.
    color : three numbers 0..1, optional
        Red, green, blue that the file wants it shown in.
    emission_nm : float, optional
        Wavelength of the light that was measured, in nanometres.
    window : two numbers (low, high), optional
        Values that the file wants shown in black and in the full colour (its contrast limits, or display range).
    is_active : bool
        Whether the file wants it shown.

    Raises
    ------
    ArgumentError
        If the colour is not three numbers 0..1, the wavelength not positive, or the window not two growing numbers.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Channel("DAPI", color=(0, 0, 1), emission_nm=461, window=(100, 900)).window
    (100.0, 900.0)
    """

    name: str = ""
    color: tuple[float, float, float] | None = None
    emission_nm: float | None = None
    window: tuple[float, float] | None = None
    is_active: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", text_of(self.name, "name of a channel"))
        check_text(self.name, "name of a channel")
        if self.color is not None:
            object.__setattr__(self, "color", _color(self.color))
        if self.emission_nm is not None:
            object.__setattr__(self, "emission_nm", values.positive(self.emission_nm, "emission_nm of a channel"))
        if self.window is not None:
            object.__setattr__(self, "window", _window(self.window, "window of a channel"))
        object.__setattr__(self, "is_active", bool(self.is_active))


@public
@dataclass(frozen=True, kw_only=True)
class Facts:
    """Facts that a file states about a volume; each may be left out.

    Parameters
    ----------
    unit : str, optional
        Unit of the world's axes: "km", "m", "cm", "mm", "um", "nm", "angstrom", "pm", or the name of another ("kpc").
        None: unknown, as for an array.
    is_anatomical : bool
        Whether the world's axes are a patient's (RAS: x to the right, y to the front, z up).
    modality : str, optional
        How it was measured, in DICOM's codes ("CT", "MR", "PT", "NM", "US", "XA", ...), or "fluorescence" or "EM";
        None where the file does not say. It is never guessed from the values.
    value_unit : str, optional
        Unit of the samples' values: "HU", "Bq/ml", "SUV", "Gy", "a.u." (of MR, whose numbers have no scale), ...; None
        where the file does not say.
    quantity : str, optional
        Name of the values, such as "temperature": of the dataset or array that they are in, or of a calculated map, by
        the intent of NIfTI or the image type of DICOM; None where the file has none.
    window : two numbers (low, high), optional
        Values that the file wants shown in black and in white, of a picture.
    is_inverted : bool
        Whether the file wants the lowest values shown in white, as X-ray films have them (MONOCHROME1 of DICOM).
    description : str, optional
        What the file calls the scan: tracer and description of the series in DICOM, which distinguish scans of one
        modality in legends.
    channel : Channel, optional
        The channel of the samples.
    channels : sequence of Channel
        All channels of the file, in order; empty where it describes none.
    n_times : int
        Time points in the file.
    time_step : float, optional
        Time between them, in `time_unit`.
    time_unit : str, optional
        Unit of the times, such as "s".
    times : sequence of float
        Times of all time points, in `time_unit`, where the file has one for each; else empty.
    levels : sequence of shapes (z, y, x)
        Levels of detail in the file, the finest first; empty where there is but one.
    conventions : sequence of str
        Values that the file leaves out and its format's conventions give, a sentence each.
    guesses : sequence of str
        Assumptions where the file says nothing, and why; a sentence each.
    processing : sequence of str
        Steps applied to the samples since they were read, in order, such as by `Volume.smoothed`.

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
    value_unit: str | None = None
    quantity: str | None = None
    window: tuple[float, float] | None = None
    is_inverted: bool = False
    description: str | None = None
    channel: Channel | None = None
    channels: tuple[Channel, ...] = ()
    n_times: int = 1
    time_step: float | None = None
    time_unit: str | None = None
    times: tuple[float, ...] = ()
    levels: tuple[tuple[int, int, int], ...] = ()
    conventions: tuple[str, ...] = ()
    guesses: tuple[str, ...] = ()
    processing: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        channels = _listed(self.channels, "channels")
        for channel in (*channels, *([] if self.channel is None else [self.channel])):
            if not isinstance(channel, Channel):
                raise ArgumentError(f"facts: a channel is a {type(channel).__name__}; give a wavesplat.Channel")
        object.__setattr__(self, "n_times", _count(self.n_times))
        given = {
            "unit": units.checked(self.unit),
            "is_anatomical": bool(self.is_anatomical),
            "modality": None if self.modality is None else text_of(self.modality, "facts: modality"),
            "value_unit": _value_unit(self.value_unit),
            "window": None if self.window is None else _window(self.window, "facts: window"),
            "is_inverted": bool(self.is_inverted),
            "quantity": _line(self.quantity, "quantity", "temperature"),
            "description": _line(self.description, "description", "Thorax 1.0"),
            "channels": channels,
            "n_times": self.n_times,
            "time_step": _step(self.time_step),
            "times": _times(self.times, self.n_times),
            "levels": _levels(self.levels),
            "conventions": _sentences(self.conventions, "conventions"),
            "guesses": _sentences(self.guesses, "guesses"),
            "processing": _sentences(self.processing, "processing"),
        }
        for name in ("modality", "time_unit"):
            check_text(getattr(self, name), f"facts: {name}")
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return short_repr(self)

    def as_json(self) -> dict[str, Any]:
        """The facts as a dictionary of JSON values."""
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Facts:
        """The facts of a dictionary that `as_json` made; a field of a later release is left out.

        Raises
        ------
        ArgumentError
            If a value cannot be right.
        """
        if not isinstance(document, Mapping):
            raise ArgumentError(f"facts: this is {described(document)}; give an object, as Facts.as_json returns it")
        given = {field.name: document[field.name] for field in fields(cls) if field.name in document}
        for name, value in given.items():
            if name == "channel" and value is not None:
                given[name] = _channel(value)
            elif name == "channels":
                given[name] = tuple(map(_channel, _listed(value, name)))
        return cls(**given)


def is_part_of_color(facts: Facts) -> bool:
    """Whether samples are the red, green or blue of a colour picture, and no channel of a microscope."""
    if facts.channel is None or facts.modality == "fluorescence":
        return False
    named = [(channel.name, channel.color) for channel in facts.channels[:3]]
    parts = [(channel.name, channel.color) for channel in COLORS[:3]]
    return named == parts and (facts.channel.name, facts.channel.color) in parts


def value_unit_of(name: object) -> str | None:
    """A unit of values as another program names it; None where it names none that can be shown."""
    text = name.strip() if isinstance(name, str) else ""
    return text if text and text.isprintable() and len(text) <= LONGEST_UNIT else None


def quantity_of(name: object) -> str | None:
    """The quantity that a dataset or an array in a file is named after; None where its name says nothing.

    name : may be a path within the file, such as "native_fields/temperature", or bytes.
    """
    text = name.decode("utf-8", "replace") if isinstance(name, bytes) else name
    text = " ".join(text.rstrip("/").rpartition("/")[2].split()) if isinstance(text, str) else ""
    is_name = text.lower() not in NO_QUANTITIES and text.isprintable() and len(text) <= LONGEST_QUANTITY
    return text if is_name else None


def description_of(*texts: str) -> str | None:
    """The description of a scan, joined from texts of its file; None if these are empty."""
    text = ", ".join(
        " ".join("".join(sign if sign.isprintable() else " " for sign in one).split()) for one in texts if one
    )
    return text[:LONGEST_QUANTITY].strip() or None


def _line(text: object, name: str, example: str) -> str | None:
    if text is None:
        return None
    if not isinstance(text, str) or len(text) > LONGEST_QUANTITY or not text.isprintable():
        raise ArgumentError(f'facts: {name} is {described(text)}; give a name of one line, such as "{example}"')
    return text.strip() or None


def _value_unit(unit: object) -> str | None:
    if unit is None:
        return None
    if not isinstance(unit, str) or len(unit) > LONGEST_UNIT or not unit.isprintable():
        raise ArgumentError(f'facts: value_unit is {described(unit)}; give the name of a unit, such as "HU"')
    return unit.strip() or None


def _channel(document: object) -> Channel:
    known = {field.name for field in fields(Channel)}
    if not isinstance(document, Mapping) or not known.issuperset(document):
        raise ArgumentError(f"facts: a channel is {described(document)}; give an object of {', '.join(sorted(known))}")
    return Channel(**document)


def _listed(things: object, name: str) -> tuple[Any, ...]:
    try:
        return tuple(things)  # type: ignore[arg-type]
    except TypeError:
        raise ArgumentError(f"facts: {name} is {described(things)}; give a list") from None


def _levels(levels: object) -> tuple[tuple[int, int, int], ...]:
    try:
        return tuple((int(z), int(y), int(x)) for z, y, x in levels)  # type: ignore[attr-defined]
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"facts: levels is {described(levels)}; give shapes (z, y, x)") from None


def _count(number: object) -> int:
    try:
        count = index(number)  # type: ignore[arg-type]
    except TypeError:
        count = 0
    if not 1 <= count < MAX_TIMES:
        raise ArgumentError(f"facts: n_times is {described(number)}; give a whole number from 1")
    return count


def _step(number: float | None) -> float | None:
    return None if number is None else values.number(number, "facts: time_step", "a number or None", finite=False)


def _times(times: Iterable[float], n_times: int) -> tuple[float, ...]:
    numbers = values.numbers(times, "facts: times", "numbers", finite=False)
    if numbers and len(numbers) != n_times:
        raise ArgumentError(f"facts: {len(numbers)} times are given for {n_times} time points; give as many, or none")
    if not all(isfinite(time) for time in numbers):
        raise ArgumentError("facts: a time is not a finite number; leave the times out")
    return numbers


def _color(color: Iterable[float]) -> tuple[float, float, float]:
    form = "red, green and blue, 0..1 each"
    red, green, blue = values.numbers(color, "color of a channel", form, n=3, least=0, most=1)
    return red, green, blue


def _window(window: Iterable[float], name: str) -> tuple[float, float]:
    form = "two numbers, the smaller one first"
    low, high = values.numbers(window, name, form, n=2)
    if not low < high:
        raise ArgumentError(f"{name} is {described(window)}; give {form}")
    return low, high


def _sentences(texts: Iterable[str], name: str) -> tuple[str, ...]:
    if isinstance(texts, str):
        raise ArgumentError(f"facts: {name} is one text; give a list of them")
    sentences = tuple(text_of(text, f"facts: a text of {name}") for text in _listed(texts, name))
    for sentence in sentences:
        check_text(sentence, f"facts: a text of {name}")
    return sentences


#: Channels of pixels whose three or four samples are a colour and its opacity.
COLORS = (
    Channel("red", (1.0, 0.0, 0.0)),
    Channel("green", (0.0, 1.0, 0.0)),
    Channel("blue", (0.0, 0.0, 1.0)),
    Channel("alpha", is_active=False),
)
