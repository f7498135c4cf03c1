"""DICOM files made up by pydicom: single slices, and enhanced files of many frames."""

from __future__ import annotations

import numpy as np

CT, MR_ENHANCED = "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.4.1"
EXPLICIT_LITTLE = "1.2.840.10008.1.2.1"
TYPES = {"u1": (8, 0), "u2": (16, 0), "i2": (16, 1), "u4": (32, 0)}


def base(pixels, number=0, *, modality="CT", series="1.2.3", sop_class=CT, bits_stored=None, **attributes):
    """A dataset with pixels [rows, columns] or [frames, rows, columns], and without a position."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import UID

    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = UID(EXPLICIT_LITTLE)
    dataset.SOPClassUID = dataset.file_meta.MediaStorageSOPClassUID = sop_class
    dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = f"{series}.{number + 1}"
    dataset.SeriesInstanceUID, dataset.StudyInstanceUID = series, "1.2.9"
    dataset.Modality, dataset.InstanceNumber = modality, number
    dataset.Rows, dataset.Columns = pixels.shape[-2:]
    dataset.SamplesPerPixel, dataset.PhotometricInterpretation = 1, "MONOCHROME2"
    bits, sign = TYPES[pixels.dtype.str[1:]]
    dataset.BitsAllocated, dataset.BitsStored, dataset.PixelRepresentation = bits, bits_stored or bits, sign
    dataset.HighBit = dataset.BitsStored - 1
    data = pixels.tobytes()
    dataset.PixelData = data + b"\0" * (len(data) % 2)
    dataset["PixelData"].VR = "OB" if bits == 8 else "OW"
    for name, value in attributes.items():
        setattr(dataset, name, value)
    return dataset


def slice_at(pixels, number, z=None, *, spacing=(0.8, 0.7), **attributes):
    """A slice of a series along z, 1.5 mm apart."""
    place = [10.0, 20.0, 30.0 + (1.5 * number if z is None else z)]
    placed = {
        "ImagePositionPatient": place,
        "ImageOrientationPatient": [1, 0, 0, 0, 1, 0],
        "PixelSpacing": list(spacing),
    }
    return base(pixels, number, **{**placed, **attributes})


def sequence(*items):
    """A sequence of items; values that are dictionaries become sequences in turn."""
    from pydicom.dataset import Dataset
    from pydicom.sequence import Sequence

    made = []
    for values in items:
        item = Dataset()
        for name, value in values.items():
            setattr(item, name, sequence(value) if isinstance(value, dict) else value)
        made.append(item)
    return Sequence(made)


def save(folder, datasets):
    """Write each dataset to a file of its own."""
    folder.mkdir(exist_ok=True)
    for number, dataset in enumerate(datasets):
        dataset.save_as(folder / f"{number:03}.dcm", enforce_file_format=True)
    return folder


def enhanced(pixels, frames, **attributes):
    """A dataset of many frames. `frames`: for each its z, and slope, intercept, stack, time, label if given."""
    from pydicom.dataset import Dataset

    def item(**values):
        dataset = Dataset()
        for name, value in values.items():
            setattr(dataset, name, value)
        return dataset

    dataset = base(pixels, modality="MR", sop_class=MR_ENHANCED, NumberOfFrames=len(pixels), **attributes)
    dataset.SharedFunctionalGroupsSequence = [item(PixelMeasuresSequence=[item(PixelSpacing=[0.8, 0.7])])]
    dataset.DimensionIndexSequence = [
        item(DimensionIndexPointer=0x00209056),
        item(DimensionIndexPointer=0x00209057),
        item(DimensionIndexPointer=0x00209128),
    ]
    groups = []
    for frame in frames:
        z, slope, intercept, stack, time, label = (*frame, *(1.0, 0.0, "1", 1, "M")[len(frame) - 1 :])
        orientation = [1, 0, 0, 0, 1, 0] if stack == "1" else [0, 1, 0, 0, 0, 1]
        place = [10.0, 20.0, 30.0 + z] if stack == "1" else [10.0 + z, 20.0, 30.0]
        content = item(StackID=stack, TemporalPositionIndex=time, DimensionIndexValues=[int(stack), 1, time])
        groups.append(
            item(
                FrameContentSequence=[content],
                PlanePositionSequence=[item(ImagePositionPatient=place)],
                PlaneOrientationSequence=[item(ImageOrientationPatient=orientation)],
                PixelValueTransformationSequence=[item(RescaleSlope=slope, RescaleIntercept=intercept)],
                MRImageFrameTypeSequence=[item(FrameType=["ORIGINAL", "PRIMARY", label])],
            )
        )
    dataset.PerFrameFunctionalGroupsSequence = groups
    return dataset


def segmentation(masks, *, segments, kind="BINARY", step=1.5, between=1.5, whole=255, **attributes):
    """A DICOM segmentation, its frames in the order of `masks`: (segment, slice, mask [rows, columns]) each.

    segments : name and colour (CIE Lab as stored, or None) by number. between : SpacingBetweenSlices, if not None.
    """
    is_bit = kind == "BINARY"
    frames = np.array([mask for _, _, mask in masks]).astype(np.uint8)
    sop_class = "1.2.840.10008.5.1.4.1.1.66.7" if kind == "LABELMAP" else "1.2.840.10008.5.1.4.1.1.66.4"
    dataset = base(frames, modality="SEG", sop_class=sop_class, NumberOfFrames=len(frames), SegmentationType=kind)
    if is_bit:
        packed = np.packbits(frames.ravel() != 0, bitorder="little").tobytes()
        dataset.PixelData = packed + b"\0" * (len(packed) % 2)
        dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 1, 1, 0
    if kind == "FRACTIONAL":
        dataset.SegmentationFractionalType, dataset.MaximumFractionalValue = "PROBABILITY", whole
    described = []
    for number, (name, color) in segments.items():
        item = {"SegmentNumber": number, "SegmentLabel": name}
        described.append({**item, "RecommendedDisplayCIELabValue": color} if color else item)
    dataset.SegmentSequence = sequence(*described)
    measures = {"PixelSpacing": [0.8, 0.7], "SliceThickness": 1.5}
    if between is not None:
        measures["SpacingBetweenSlices"] = between
    dataset.SharedFunctionalGroupsSequence = sequence(
        {
            "PixelMeasuresSequence": measures,
            "PlaneOrientationSequence": {"ImageOrientationPatient": [1, 0, 0, 0, 1, 0]},
        }
    )
    groups = []
    for segment, place, _ in masks:
        group = {"PlanePositionSequence": {"ImagePositionPatient": [10.0, 20.0, 30.0 + step * place]}}
        if kind != "LABELMAP" and segment is not None:
            group["SegmentIdentificationSequence"] = {"ReferencedSegmentNumber": segment}
        groups.append(group)
    dataset.PerFrameFunctionalGroupsSequence = sequence(*groups)
    for name, value in attributes.items():
        setattr(dataset, name, value)
    return dataset


def structure_set(regions, **attributes):
    """An RTSTRUCT, for each region of its name, its colour (0..255, or None), its kind, and its lines, in LPS.

    A line is a list of points, or a pair of its type and its points; usually it is CLOSED_PLANAR.
    """
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.sequence import Sequence
    from pydicom.uid import UID

    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = UID(EXPLICIT_LITTLE)
    dataset.SOPClassUID = dataset.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.481.3"
    dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = "1.2.3.77.1"
    dataset.SeriesInstanceUID, dataset.StudyInstanceUID, dataset.Modality = "1.2.3.77", "1.2.9", "RTSTRUCT"
    rois, drawn, observed = [], [], []
    for number, (name, color, kind, lines) in enumerate(regions, 1):
        rois.append({"ROINumber": number, "ROIName": name})
        observed.append({"ObservationNumber": number, "ReferencedROINumber": number, "RTROIInterpretedType": kind})
        item = {"ReferencedROINumber": number}
        if color is not None:
            item["ROIDisplayColor"] = list(color)
        contours = []
        for line in lines:
            what, points = line if isinstance(line, tuple) else ("CLOSED_PLANAR", line)
            numbers = [f"{float(part):.6f}" for point in points for part in point]
            contours.append(
                {"ContourGeometricType": what, "NumberOfContourPoints": len(points), "ContourData": numbers}
            )
        region = sequence(item)[0]
        if contours:
            region.ContourSequence = sequence(*contours)
        drawn.append(region)
    dataset.StructureSetROISequence, dataset.RTROIObservationsSequence = sequence(*rois), sequence(*observed)
    dataset.ROIContourSequence = Sequence(drawn)
    for name, value in attributes.items():
        setattr(dataset, name, value)
    return dataset


def random(n, dtype=np.uint16, size=(6, 7), most=3000):
    """A stack of n frames of random numbers."""
    return np.random.default_rng(n).integers(0, most, (n, *size)).astype(dtype)
