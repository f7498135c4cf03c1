"""Units of DICOM values: of PET, of doses, of rescaled values, and by modality.

Defined terms: Units (0054,1001) and SUVType (0054,1006), DICOM PS3.3 C.8.9.1; DoseUnits (3004,0002), C.8.8.3;
RescaleType (0028,1054), C.11.1.1.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavesplat._readers.dicom_values import text

__all__ = ["ARBITRARY", "unit_of_values"]

#: Unit of numbers without a scale of their own, such as those of MR.
ARBITRARY = "a.u."
#: Units of PET.
OF_PET = {
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
    "ED": "10²³ electrons/ml",
    "Z_EFF": "effective Z",
    "PCT": "%",
    "US": "",
    "NONE": "",
    "UNSPECIFIED": "",
    "NORMALIZED": "",
}
OF_DOSES = {"GY": "Gy", "RELATIVE": "relative dose"}
OF_MODALITY = {"CT": "HU", "MR": ARBITRARY}
#: Longest name of a unit that a file gives in its own words.
MAX_LETTERS = 24


def unit_of_values(dataset: Any, rescaled: Sequence[Any], modality: str) -> str | None:
    """The unit of a file's values, once slope and intercept are applied; None where the file does not say.

    rescaled : functional groups with slope and intercept, the frame's own first.
    """
    if modality == "RTDOSE":
        return OF_DOSES.get(text(dataset, 0x30040002).upper())
    if modality in ("PT", "NM") and (said := text(dataset, 0x00541001).upper()):
        if said in ("GML", "CM2ML"):
            return OF_SUV.get(text(dataset, 0x00541006).upper() or ("BSA" if said == "CM2ML" else ""))
        return OF_PET.get(said)
    if modality == "SEG":
        return None
    said = next((found for one in (*rescaled, dataset) if (found := text(one, 0x00281054))), "").strip()
    unit = OF_RESCALED.get(said.upper(), said if said.isprintable() and len(said) <= MAX_LETTERS else "")
    return unit or OF_MODALITY.get(modality)
