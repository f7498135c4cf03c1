"""Units of DICOM values: of PET, of doses, of rescaled and real-world values, and by modality."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from wavesplat._readers.dicom.values import as_numbers, items, raw_value, text

# Defined terms: Units (0054,1001) and SUVType (0054,1006), DICOM PS3.3 C.8.9.1; DoseUnits (3004,0002), C.8.8.3;
# RescaleType (0028,1054), C.11.1.1.2. Real-world values (C.7.6.16.2.11) have units of UCUM.

#: Unit of numbers without a scale of their own, such as numbers of MR.
ARBITRARY = "a.u."
#: Units of PET.
OF_PET: dict[str, str | None] = {
    "NONE": None,
    "STDDEV": "standard deviations",
    "BQML": "Bq/ml",
    "CNTS": "counts",
    "CPS": "counts/s",
    "PROPCNTS": ARBITRARY,
    "PROPCPS": ARBITRARY,
    "PCNT": "%",
    "CM2": "cm²",
    "1CM": "1/cm",
    "MGMINML": "mg/min/ml",
    "UMOLMINML": "µmol/min/ml",
    "UMOLML": "µmol/ml",
    "MLMING": "ml/min/g",
    "MLMINML": "ml/min/ml",
    "MLG": "ml/g",
    "MLML": "ml/ml",
}
#: Units of uptake values, of which SUVType says more.
OF_UPTAKE = ("GML", "CM2ML")
#: Standardised uptake values by SUVType: by body weight, where nothing is said, by lean body mass, by ideal weight, and
#: by body surface.
OF_SUV = {
    "": "SUV",
    "BW": "SUV",
    "BSA": "SUV (body surface)",
    "LBM": "SUV (lean mass)",
    "LBMJAMES128": "SUV (lean mass)",
    "LBMJANMA": "SUV (lean mass)",
    "IBW": "SUV (ideal weight)",
}
#: Units by RescaleType; "" where there is none.
OF_RESCALED = {
    "HU": "HU",
    "HU_MOD": "HU",
    "MGML": "mg/ml",
    "OD": "10⁻³ optical density",
    "ED": "10²³ electrons/ml",
    "EDW": "electron density of water",
    "Z_EFF": "effective Z",
    "PCT": "%",
    "US": "",
    "NONE": "",
    "UNSPECIFIED": "",
    "NORMALIZED": "",
}
OF_DOSES = {"GY": "Gy", "RELATIVE": "relative dose"}
OF_MODALITY = {"CT": "HU", "MR": ARBITRARY}
RESCALED = "RescaleType (0028,1054)"
#: Groups with slope and intercept, and with real-world values, their units, and codes of UCUM that we name otherwise.
RESCALED_GROUP, REAL_WORLD, UNITS_CODE = 0x00289145, 0x00409096, 0x004008EA
OF_CODES: dict[str, str | None] = {
    "[hnsf'U]": "HU",
    "1": None,
    "": None,
    "no units": None,
    "Bq/ml": "Bq/ml",
    "g/ml{SUVbw}": "SUV",
    "{SUVbw}g/ml": "SUV",
    "{counts}": "counts",
    "{counts}/s": "counts/s",
    "um2/s": "µm²/s",
    "mm2/s": "mm²/s",
}
#: Maximum letters of a unit in a file's own words that are shown as the unit, and in a sentence.
MAX_LETTERS, MAX_QUOTED = 24, 64


class ValueUnit(NamedTuple):
    """The unit of a file's values, None if it names none, and a sentence if its meaning is uncertain."""

    name: str | None
    note: str = ""


def unit_of_values(
    dataset: Any, groups: Sequence[Mapping[int, Any]], modality: str, scale: tuple[float, float]
) -> ValueUnit:
    """The unit of a file's values, once slope and intercept are applied.

    groups : functional groups by tag, the frame's own first. scale : the slope and the intercept that are applied.
    """
    found = _by_modality(dataset, [group[RESCALED_GROUP] for group in groups if RESCALED_GROUP in group], modality)
    mapped = next((group[REAL_WORLD] for group in groups if REAL_WORLD in group), None)
    mapped = mapped or next(iter(items(dataset, REAL_WORLD)), None)
    if mapped is None or found.name not in (None, ARBITRARY) or modality == "SEG":
        return found
    return _real_world(mapped, scale, found)


def _real_world(mapped: Any, scale: tuple[float, float], found: ValueUnit) -> ValueUnit:
    """The unit of real-world values, where these are the values that are read."""
    word = next((text(code, 0x00080100) for code in items(mapped, UNITS_CODE)), "")
    unit = OF_CODES.get(word, _shown(word) or None)
    if unit is None:
        return found
    own = [next(iter(as_numbers(raw_value(mapped, tag), "f8")), math.nan) for tag in (0x00409225, 0x00409224)]
    if all(math.isclose(one, other, rel_tol=1e-5, abs_tol=1e-9) for one, other in zip(own, scale, strict=True)):
        return ValueUnit(unit)
    note = "values by slope and intercept: the file has others to real-world values in"
    return ValueUnit(
        found.name, f"{note} {word[:MAX_QUOTED]!r} (RealWorldValueMappingSequence, 0040,9096), not applied"
    )


def _by_modality(dataset: Any, rescaled: Sequence[Any], modality: str) -> ValueUnit:
    """The unit by the attribute that a modality has for it."""
    if modality == "RTDOSE":
        return _by_word(text(dataset, 0x30040002), OF_DOSES, "DoseUnits (3004,0002)")
    if modality in ("PT", "NM") and (word := text(dataset, 0x00541001)):
        if word.upper() in OF_UPTAKE:
            kind = text(dataset, 0x00541006) or ("BSA" if word.upper() == "CM2ML" else "")
            found = _by_word(kind, OF_SUV, "SUVType (0054,1006)")
            return ValueUnit(f"SUV ({found.name})", found.note) if found.note else found
        return _by_word(word, OF_PET, "Units (0054,1001)")
    if modality == "SEG":
        return ValueUnit(None)
    word = next((word for one in (*rescaled, dataset) if (word := text(one, 0x00281054))), "")
    usual = OF_MODALITY.get(modality)
    if word.upper() in OF_RESCALED:
        unit = OF_RESCALED[word.upper()]
        is_guess = not unit and modality == "CT"
        note = f"values in HU, as in every CT: RescaleType (0028,1054) is {word}, and names no unit" if is_guess else ""
        return ValueUnit(unit or usual, note)
    # Makers have units of their own here, and DICOM permits it.
    return ValueUnit(_shown(word) or usual, "" if not word or word == _shown(word) else _unknown(word, RESCALED))


def _by_word(word: str, units: Mapping[str, str | None], where: str) -> ValueUnit:
    """The unit for a word of a list, or the word itself with a sentence on it."""
    if word.upper() in units or not word:
        return ValueUnit(units.get(word.upper()))
    return ValueUnit(_shown(word) or None, _unknown(word, where))


def _shown(word: str) -> str:
    return word[:MAX_LETTERS].strip() if word.isprintable() else ""


def _unknown(word: str, where: str) -> str:
    return f"values in the file's own unit, {word[:MAX_QUOTED]!r}: {where} has a word that DICOM does not define"
