"""Quantities of calculated maps, as NIfTI and DICOM name them.

Intents of NIfTI: nifti1.h, NIFTI_INTENT_*, by nibabel's names. Image types of DICOM: PS3.3, table C.8-130 (derived
pixel contrast of CT and MR), and the words that scanners write for their own maps; they count only where the pixels
are DERIVED.
"""

from __future__ import annotations

ADC, DIFFUSIVITY, ANISOTROPY = "apparent diffusion coefficient", "diffusivity", "fractional anisotropy"
T1, T2, T2_STAR = "relaxation time T1", "relaxation time T2", "relaxation time T2*"
BLOOD_FLOW, BLOOD_VOLUME, PERFUSION = "blood flow", "blood volume", "time of perfusion"
Z_STATISTIC, T_STATISTIC, F_STATISTIC, P_VALUE = "z statistic", "t statistic", "F statistic", "p-value"
#: All but p-values, of which low ones matter.
QUANTITIES = frozenset(
    {
        *(ADC, DIFFUSIVITY, ANISOTROPY, T1, T2, T2_STAR, BLOOD_FLOW, BLOOD_VOLUME, PERFUSION),
        *(Z_STATISTIC, T_STATISTIC, F_STATISTIC),
    }
)
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
