"""Standardised uptake values (SUV) of PET by body weight, from activities per volume.

    SUV = activity in Bq/ml * weight in g / (injected activity in Bq * 2^(-t / half-life))

t is the time from the injection to that to which the scanner corrected all frames for decay: the start of the scan
(DecayCorrection START), or the injection itself (ADMIN), where it is 0. Source: the vendor-neutral pseudo-code of the
Quantitative Imaging Biomarkers Alliance (QIBA) of the RSNA, "SUV Vendor Neutral Pseudo-code", both the common case and
the robust one for series whose date and time were changed by later processing,
https://qibawiki.rsna.org/index.php/Standardized_Uptake_Value_(SUV). The formula needs millilitres to weigh a
gram, so SUV has no unit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

from wavesplat._readers.dicom.attributes import SECONDS_PER_DAY, seconds_of
from wavesplat._readers.dicom.values import Creator, as_numbers, items, raw_value, text
from wavesplat.errors import FileError

NONE = float("nan")
#: Most half-lives between injection and scan: after these a thousandth is left, and dates in the header are wrong.
MAX_HALF_LIVES = 10.0
#: Least injected activity, Bq: a smaller number is in MBq.
MIN_DOSE = 1e4
PHILIPS = Creator(0x70530010, "Philips PET Private Group", "PHILIPS")
GE = Creator(0x00090010, "GEMS_PETD_01", "GE")
#: Corrections that SUV need, with their words in CorrectedImage (0028,0051): the standard's (PS3.3, C.8.9.1), and then
#: the word in QIBA's pseudo-code.
CORRECTIONS = {"attenuation": ("ATTN",), "decay": ("DECY", "DECAY")}
#: Words of DecayCorrection (0054,1102) for the times to which values can be corrected.
DECAY_CORRECTED = ("START", "ADMIN")


@dataclass(frozen=True)
class Tracer:
    """Elements of a PET file that SUV need; NaN and "" where there are none, times in seconds since the year 1."""

    units: str
    suv_type: str
    corrected: str
    decay_correction: str
    weight_kg: float
    dose_bq: float
    half_life_s: float
    #: When the tracer was injected; since midnight where the header has no date for it.
    injected: float
    is_injected_undated: bool
    series: float
    #: When the frame began, the time to which it belongs after the start of the scan, and how long it took, seconds.
    acquired: float
    reference_s: float
    duration_s: float
    #: Private factors of Philips from counts to SUV and to Bq/ml, and the start of the scan by GE.
    philips_suv: float
    philips_bqml: float
    ge_scan: float


@dataclass(frozen=True)
class Uptake:
    """The factor from a series' values to SUV, how it was found, and what was assumed."""

    factor: float
    description: str
    guesses: tuple[str, ...] = ()


def tracer_of(dataset: Any) -> Tracer:
    """The elements of a PET file that SUV need."""
    found = items(dataset, 0x00540016)
    drug: Any = found[0] if found else {}
    time_text = text(drug, 0x00181078) if found else ""
    undated = text(drug, 0x00181072) if found else ""
    return Tracer(
        units=text(dataset, 0x00541001).upper(),
        suv_type=text(dataset, 0x00541006).upper(),
        corrected=text(dataset, 0x00280051).upper(),
        decay_correction=text(dataset, 0x00541102).upper(),
        weight_kg=_number(dataset, 0x00101030),
        dose_bq=_number(drug, 0x00181074) if found else NONE,
        half_life_s=_number(drug, 0x00181075) if found else NONE,
        injected=_time(time_text[:8], time_text[8:]) if time_text else _time_of_day(undated),
        is_injected_undated=not time_text,
        series=_time(text(dataset, 0x00080021), text(dataset, 0x00080031)),
        acquired=_time(text(dataset, 0x00080022), text(dataset, 0x00080032)),
        reference_s=_number(dataset, 0x00541300) / 1000,
        duration_s=_number(dataset, 0x00181242) / 1000,
        philips_suv=_private(dataset, 0x70531000, PHILIPS),
        philips_bqml=_private(dataset, 0x70531009, PHILIPS),
        ge_scan=_ge_scan(dataset),
    )


def uptake_of(tracers: Sequence[Tracer | None], path: object) -> Uptake:
    """The factor from the values of a series to SUV by body weight; a `FileError` that names what is missing."""
    known = [one for one in tracers if one is not None]
    if len(known) < len(tracers):
        raise FileError(f"suv: the series is no PET, and has no uptake; leave suv out (--suv): {path}")
    first = known[0]
    reason = _difference(known) or next((description for holds, description in _reasons_against(first) if holds), "")
    if reason:
        raise FileError(f"suv: {reason}; leave suv out (--suv): {path}")
    if first.units == "GML":
        return Uptake(1.0, "SUV by body weight, as they are in the file")
    if first.units == "CNTS" and first.philips_suv > 0:
        return Uptake(first.philips_suv, f"SUV by the scanner's factor (7053,1000): values times {first.philips_suv:g}")
    dose, description = first.dose_bq, "corrected to the injection"
    guesses: tuple[str, ...] = ()
    if first.decay_correction == "START":
        since, guesses = _time_of_decay(known, path)
        dose *= 2.0 ** (-since / first.half_life_s)
        description = f"{since / 60:.4g} minutes of decay, half-life {first.half_life_s / 60:.4g} minutes"
    scale = first.philips_bqml if first.units == "CNTS" else 1.0
    factor = scale * first.weight_kg * 1000 / dose
    description = (
        f"SUV by body weight: {first.weight_kg:g} kg, {first.dose_bq / 1e6:.4g} MBq injected, {description}; values "
        f"times {factor:.4g}"
    )
    return Uptake(factor, description, guesses)


#: Elements that may differ between the files of a series.
OF_FRAMES = ("series", "acquired", "reference_s", "duration_s", "ge_scan")
NAMES = {
    "units": "Units (0054,1001)",
    "weight_kg": "PatientWeight (0010,1030)",
    "dose_bq": "RadionuclideTotalDose (0018,1074)",
    "half_life_s": "RadionuclideHalfLife (0018,1075)",
    "decay_correction": "DecayCorrection (0054,1102)",
    "injected": "RadiopharmaceuticalStartDateTime (0018,1078) or RadiopharmaceuticalStartTime (0018,1072)",
    "is_injected_undated": "RadiopharmaceuticalStartDateTime (0018,1078)",
    "philips_suv": "the scanner's factor (7053,1000)",
    "philips_bqml": "the scanner's factor (7053,1009)",
    "corrected": "CorrectedImage (0028,0051)",
    "suv_type": "SUVType (0054,1006)",
}


def _difference(tracers: Sequence[Tracer]) -> str:
    """The element in which files of a series differ, as a sentence; empty where there is none."""
    for field in fields(Tracer):
        if field.name not in OF_FRAMES and len({str(getattr(one, field.name)) for one in tracers}) > 1:
            return f"files of the series differ in {NAMES[field.name]}"
    return ""


def _reasons_against(one: Tracer) -> Iterator[tuple[bool, str]]:
    """Conditions under which SUV cannot be calculated, each with its sentence, in the order of their tests."""
    yield not one.units, "the header has no Units (0054,1001)"
    if one.units == "GML":
        yield one.suv_type not in ("", "BW"), f"the values are SUV by {one.suv_type} (SUVType) already, not by weight"
        return
    is_counts = one.units == "CNTS"
    yield one.units != "BQML" and not is_counts, f"the values are in {one.units} (Units, 0054,1001), not in BQML"
    has_factor = one.philips_suv > 0 or one.philips_bqml > 0
    yield is_counts and not has_factor, "the values are counts, and the scanner's factor (7053,1000) is missing"
    corrections = {word.strip() for word in one.corrected.split("\\")}
    corrected = "\\".join(sorted(corrections - {""})) or "nothing"
    for what, words in CORRECTIONS.items():
        description = (
            f"the header does not say that the values are corrected for {what}: CorrectedImage (0028,0051) has no "
            f"{words[0]}, it says {corrected}"
        )
        yield corrections.isdisjoint(words), description
    if is_counts and one.philips_suv > 0:
        return
    state = f"is {one.decay_correction}" if one.decay_correction else "is missing"
    is_known = one.decay_correction in DECAY_CORRECTED
    yield not is_known, f"DecayCorrection (0054,1102) {state}, and START or ADMIN is needed"
    for name in ("weight_kg", "dose_bq", "half_life_s"):
        yield not getattr(one, name) > 0, f"{NAMES[name]} is missing or 0"
    yield one.dose_bq < MIN_DOSE, f"{NAMES['dose_bq']} is {one.dose_bq:g}, too little for Bq"
    if one.decay_correction == "START":
        yield math.isnan(one.injected), f"{NAMES['injected']} is missing"
        is_timeless = all(map(math.isnan, (one.series, one.acquired, one.ge_scan)))
        yield is_timeless, "SeriesDate and SeriesTime (0008,0021 and 0008,0031), the time of the scan, are missing"


def _time_of_decay(tracers: Sequence[Tracer], path: object) -> tuple[float, tuple[str, ...]]:
    """Seconds from the injection to the time to which the series was corrected for decay, and what was assumed."""
    first = tracers[0]
    scan, guesses = _scan_time(tracers)
    since = scan - first.injected
    if first.is_injected_undated:
        since %= SECONDS_PER_DAY  # of the day of the scan, or before midnight
        if first.half_life_s > SECONDS_PER_DAY / 2:
            guesses = (*guesses, "SUV: the injection within 24 hours before the scan: the header has no date of it")
    if not 0 <= since <= MAX_HALF_LIVES * first.half_life_s:
        raise FileError(
            f"suv: the injection ({NAMES['injected']}) is {since / 60:.6g} minutes before the scan, with a half-life "
            f"of {first.half_life_s / 60:.4g}, so one of both times is wrong; leave suv out (--suv): {path}"
        )
    return since, guesses


def _scan_time(tracers: Sequence[Tracer]) -> tuple[float, tuple[str, ...]]:
    """The time to which a series was corrected, and a sentence where the header does not say it itself.

    The time of the series, unless that is after its first frame, as in series that were processed later. Then GE's own
    time; else the start of a frame less its FrameReferenceTime, which is the time of its mean count rate.
    """
    first = min(tracers, key=lambda one: (math.isnan(one.acquired), one.acquired))
    series, ge_scan = _earliest(one.series for one in tracers), _earliest(one.ge_scan for one in tracers)
    if series <= first.acquired or (math.isnan(first.acquired) and not math.isnan(series)):
        return series, ()
    if not math.isnan(ge_scan):
        return ge_scan, ()
    if first.reference_s > 0 and first.duration_s > 0:
        decay = math.log(2) / first.half_life_s
        during = decay * first.duration_s
        mean = math.log(during / -math.expm1(-during)) / decay
        guess = (
            "SUV: the start of the scan by FrameReferenceTime: the time of the series is missing, or after its frames"
        )
        return first.acquired - first.reference_s + mean, (guess,)
    guess = "SUV: the start of the scan as the start of its first frame: the time of the series is missing, or after it"
    return first.acquired, (guess,)


def _earliest(times: Iterable[float]) -> float:
    return min((time for time in times if not math.isnan(time)), default=NONE)


def _number(dataset: Any, tag: int) -> float:
    found = as_numbers(raw_value(dataset, tag), "decimal")
    return found[0] if found and math.isfinite(found[0]) else NONE


def _time(day: str, time: str) -> float:
    """Seconds since the year 1; NaN where date or time is missing."""
    found = seconds_of(day, time) if day and time else None
    return NONE if found is None or found < SECONDS_PER_DAY else found


def _time_of_day(time: str) -> float:
    found = seconds_of("", time) if time else None
    return NONE if found is None else found


def _private(dataset: Any, tag: int, creator: Creator) -> float:
    """A number of a private element as text; NaN if the block is another's."""
    return _number(dataset, tag) if creator.is_in(dataset) else NONE


def _ge_scan(dataset: Any) -> float:
    """The start of the scan by GE."""
    time_text = text(dataset, 0x0009100D) if GE.is_in(dataset) else ""
    return _time(time_text[:8], time_text[8:])
