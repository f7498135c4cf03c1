"""DICOM files that are no images: their content, and advice on what to name instead.

By the modality (DICOM PS3.3, C.7.3.1.1.1), else by the name of the SOP class (PS3.6, annex A).
"""

from __future__ import annotations

from typing import NamedTuple


class Content(NamedTuple):
    """The content of a file and advice on what to write instead, the ends of a sentence each."""

    what: str
    instead: str


IMAGES = "name the images that it belongs to, or a folder of them"
WAVEFORMS = "waveforms are no volume; open them with pydicom (Dataset.waveform_array)"
DICOMDIR = "1.2.840.10008.1.3.10"
#: SOP classes that have rows and columns, and no pixels: raw data, which scanners add to a series, and spectra.
WITHOUT_PIXELS = ("1.2.840.10008.5.1.4.1.1.66", "1.2.840.10008.5.1.4.1.1.4.2")

#: Contents by modality.
NO_IMAGES = {
    "RTSTRUCT": Content(
        "a structure set, regions of a patient as lines (RTSTRUCT)",
        "draw it on the scan that it belongs to: wavesplat slice SCAN --contours FILE, or --labels FILE, which render "
        "takes too",
    ),
    "RTPLAN": Content(
        "a plan of a radiotherapy, its beams and fractions (RTPLAN)",
        "name the scan, or lay the dose (RTDOSE) over it: wavesplat slice SCAN --layer DOSE",
    ),
    "PLAN": Content("a plan", IMAGES),
    "RTINTENT": Content("the intent of a radiotherapy (RTINTENT)", "name the scan, or the dose (RTDOSE)"),
    "RTRAD": Content("beams of a radiotherapy (RTRAD)", "name the scan, or the dose (RTDOSE)"),
    "RTRECORD": Content("a record of a radiotherapy (RTRECORD)", "name the scan or the dose (RTDOSE) of the treatment"),
    "RTDOSE": Content("a dose without its grid (RTDOSE)", "export it with the grid of doses, or name the scan"),
    "SR": Content(
        "a structured report, text and measurements (SR)", "name the images or the segmentation (SEG) that it is about"
    ),
    "PR": Content(
        "a presentation state, how images were shown (PR)",
        "name the images themselves; how they are shown say --window and --zoom",
    ),
    "KO": Content("a list of important images (KO)", IMAGES),
    "SEG": Content(
        "a segmentation as surfaces, not as voxels (SEG)", "export it as a segmentation of voxels, such as by 3D Slicer"
    ),
    "REG": Content("a registration of two scans (REG)", "name one of the scans"),
    "FID": Content("fiducials", IMAGES),
    "ANN": Content("annotations of a slide (ANN)", "open them with a viewer of slides"),
    "M3D": Content("a surface for printing (M3D)", "take the surface out of it, such as by pydicom: it is no volume"),
    "DOC": Content("a document", "take the document out of it, such as by pydicom: it is no volume"),
    "AU": Content("sound", WAVEFORMS),
    "ECG": Content("an electrocardiogram (ECG)", WAVEFORMS),
    "EEG": Content("an electroencephalogram (EEG)", WAVEFORMS),
    "EMG": Content("an electromyogram (EMG)", WAVEFORMS),
    "EOG": Content("an electrooculogram (EOG)", WAVEFORMS),
    "POS": Content("positions of a body (POS)", WAVEFORMS),
    "HD": Content("pressures and waveforms (HD)", WAVEFORMS),
    "RESP": Content("a curve of breath (RESP)", WAVEFORMS),
    "RWV": Content("a table of real world values (RWV)", IMAGES),
}
DIRECTORY = Content("a directory of other files (DICOMDIR)", IMAGES)


def content_by(modality: str, sop_class: str, *, is_directory: bool) -> Content | None:
    """The content of a file without pixels; None where neither modality nor SOP class decides."""
    if is_directory or sop_class == DICOMDIR:
        return DIRECTORY
    if modality in NO_IMAGES:
        return NO_IMAGES[modality]
    from pydicom.uid import UID

    name = UID(sop_class).name if sop_class else ""
    if not name.endswith("Storage") or "Image" in name:
        return None
    return Content(f"something else ({name.removesuffix(' Storage')})", IMAGES)
