"""Words that are compared with headers are those of the standards, from these and not from files that we made."""

from __future__ import annotations

import pytest
from nibabel.nifti1 import intent_codes, unit_codes
from pydicom._private_dict import private_dictionaries
from pydicom.datadict import dictionary_VR

from wavesplat import _native
from wavesplat._looks.labels import structure_labels
from wavesplat._model.interchange import itk_image, nibabel_image
from wavesplat._model.volume import facts
from wavesplat._readers.dicom import attributes, header, mosaic, segments, series, structures, suv, units, volumes
from wavesplat._readers.nifti import neuroimaging
from wavesplat._readers.nrrd import image_headers, nrrd_for_itk

#: Modality (0008,0060): PS3.3, C.7.3.1.1.1.
MODALITIES = """ANN AR ASMT AU BDUS BI BMD CFM CR CT CTPROTOCOL DG DMS DOC DX ECG EEG EMG EOG EPS ES FID GM HC HD IO
IOL IVOCT IVUS KER KO LEN LS MG MR M3D NM OAM OCT OP OPM OPT OPTBSV OPTENF OPV OSS OT PA PLAN POS PR PT PX REG RESP RF
RG RTDOSE RTIMAGE RTINTENT RTPLAN RTRAD RTRECORD RTSEGANN RTSTRUCT RWV SEG SM SMR SR SRF STAIN TEXTUREMAP TG US VA XA
XAPROTOCOL XC"""
#: Units (0054,1001) of PET.
UNITS = """CNTS NONE CM2 CM2ML PCNT CPS BQML MGMINML UMOLMINML MLMING MLG 1CM UMOLML PROPCNTS PROPCPS MLMINML MLML GML
STDDEV"""
#: NRRD, "type": https://teem.sourceforge.net/nrrd/format.html, section 5; without blanks.
NRRD_TYPES = """signedchar int8 int8_t uchar unsignedchar uint8 uint8_t short shortint signedshort signedshortint int16
int16_t ushort unsignedshort unsignedshortint uint16 uint16_t int signedint int32 int32_t uint unsignedint uint32
uint32_t longlong longlongint signedlonglong signedlonglongint int64 int64_t ulonglong unsignedlonglong
unsignedlonglongint uint64 uint64_t float double"""
#: MetaImage, ElementType: https://docs.itk.org/en/latest/learn/metaio.html.
META_TYPES = """MET_CHAR MET_UCHAR MET_SHORT MET_USHORT MET_INT MET_UINT MET_LONG MET_ULONG MET_LONG_LONG
MET_ULONG_LONG MET_FLOAT MET_DOUBLE"""
#: Our words, those of the standard, and those of ours that are none of it: what makers write, and nothing.
TABLE = {
    "Units (0054,1001), PS3.3 C.8.9.1": (
        {*units.OF_PET, *units.OF_UPTAKE},
        UNITS,
        "",
    ),
    "SUVType (0054,1006), C.8.9.1": (units.OF_SUV.keys() - {""}, "BSA BW LBM LBMJAMES128 LBMJANMA IBW", ""),
    "RescaleType (0028,1054), C.11.1.1.2": (
        units.OF_RESCALED,
        "OD HU US MGML Z_EFF ED EDW HU_MOD PCT",
        "NONE UNSPECIFIED NORMALIZED",
    ),
    "DoseUnits (3004,0002), C.8.8.3": (units.OF_DOSES, "GY RELATIVE", ""),
    "SegmentationType (0062,0001), C.8.20.2": (segments.KINDS, "BINARY FRACTIONAL LABELMAP", ""),
    "ComplexImageComponent (0008,9208), C.8.13.3.1.1, without MIXED": (
        volumes.PARTS,
        "MAGNITUDE PHASE REAL IMAGINARY",
        "M P R I",
    ),
    "NRRD, type": (nrrd_for_itk.TYPES, NRRD_TYPES, ""),
    "NRRD, space with a time axis": (nrrd_for_itk.WITH_TIME, "rast last lpst", ""),
    "NRRD, space of a patient": (
        itk_image.SPACES,
        "right-anterior-superior ras left-anterior-superior las left-posterior-superior lps",
        "",
    ),
    "MetaImage, ElementType": (image_headers.META_TYPES, META_TYPES, ""),
    "AFNI, TAXIS_NUMS, https://afni.nimh.nih.gov/pub/dist/doc/program_help/README.attributes.html": (
        {str(code) for code in neuroimaging.AFNI_TIME_UNITS},
        "77001 77002",
        "",
    ),
}
#: Some words of a list that is longer.
PARTS = {
    "CorrectedImage (0028,0051), PS3.3 C.8.9.1": (
        {words[0] for words in suv.CORRECTIONS.values()},
        "DECY ATTN SCAT DTIM MOTN PMOT CLN RAN RADL DCAL NORM",
    ),
    "DecayCorrection (0054,1102), C.8.9.1": (suv.DECAY_CORRECTED, "NONE START ADMIN"),
    "ContourGeometricType (3006,0042), C.8.8.6": (
        structures.CLOSED,
        "POINT OPEN_PLANAR OPEN_NONPLANAR CLOSED_PLANAR CLOSEDPLANAR_XOR",
    ),
    "RTROIInterpretedType (3006,00A4), C.8.8.8": ({structure_labels.OUTLINE}, "EXTERNAL PTV CTV GTV ORGAN"),
    "Modality, no images": (header.NO_IMAGES, MODALITIES),
    "Modality, with units": (units.OF_MODALITY, MODALITIES),
    "Modality, by name": (series.MODALITIES.values(), MODALITIES),
    "Modality, with a look": (_native.KINDS_OF_MODALITIES.keys() - {"fluorescence", "EM"}, MODALITIES),
    "Modality, of other formats": (itk_image.DICOM_CODES, MODALITIES),
}


@pytest.mark.parametrize("where", TABLE)
def test_words_are_those_of_the_standard(where):
    ours, standard, beyond = TABLE[where]
    assert set(ours) == {*standard.split(), *beyond.split()}


@pytest.mark.parametrize("where", PARTS)
def test_words_are_some_of_the_standard(where):
    ours, standard = PARTS[where]
    assert set(ours) <= set(standard.split())


def test_codes_of_nifti_are_those_of_nibabel():
    metres = {"meter": 1.0, "mm": 1e-3, "micron": 1e-6}
    assert {code: mm / 1000 for code, mm in nibabel_image.MM_PER_UNIT.items()} == pytest.approx(
        {unit_codes.code[name]: size for name, size in metres.items()}
    )
    times = {"sec": "s", "msec": "ms", "usec": "us", "hz": "Hz", "ppm": "ppm", "rads": "rad/s"}
    ours = {**nibabel_image.TIME_UNITS, **nibabel_image.NO_TIMES}
    assert ours == {unit_codes.code[name]: unit for name, unit in times.items()}
    # By nifti1.h: z score, t test, F test, p-value.
    assert {intent_codes.code[name] for name in facts.OF_INTENTS} == {5, 3, 4, 22}


#: Types of DICOM by the way in which we read them.
TYPES = {
    "text": {"CS", "LO", "SH", "LT", "ST"},
    "decimal": {"DS", "IS"},
    "f4": {"FL"},
    "f8": {"FD"},
    "u2": {"US"},
    "u4": {"UL"},
    "time": {"TM"},
    "datetime": {"DT"},
    "comment": {"LT"},
}
SOURCES = [
    (attribute.name, source, tag)
    for attribute in attributes.ATTRIBUTES
    for source in attribute.sources
    for tag in (source.tag, *(() if source.encoding == "time" else source.others))
]


def test_attributes_are_read_as_the_dictionaries_say():
    """Names of UIH are in no dictionary of pydicom, but in dcm2niix (nii_dicom.cpp)."""
    wrong = []
    for name, source, tag in SOURCES:
        found = {dictionary_VR(tag)} if source.creator is None else set()
        if source.creator not in (None, attributes.UIH):
            group, element = f"{tag >> 16:04x}", f"{tag & 0xFF:02x}"
            found = {
                entries[key][0]
                for creator, entries in private_dictionaries.items()
                for key in entries
                if creator.startswith(source.creator.name) and key.lower() == f"{group}xx{element}"
            }
        if source.creator != attributes.UIH and not found & TYPES[source.encoding]:
            wrong.append(name)
    assert wrong == []


def test_names_of_private_blocks_are_those_of_the_dictionaries():
    names = {mosaic.CREATOR.name, suv.PHILIPS.name, suv.GE.name}
    assert names <= private_dictionaries.keys()
    assert private_dictionaries[suv.GE.name]["0009xx0D"][2] == "PET scan_datetime"
    assert private_dictionaries[suv.PHILIPS.name]["7053xx00"][2] == "SUV Scale Factor"
    assert private_dictionaries[suv.PHILIPS.name]["7053xx09"][2] == "Activity Concentration Scale Factor"
    assert private_dictionaries[mosaic.CREATOR.name]["0019xx0A"][2] == "NumberOfImagesInMosaic"
