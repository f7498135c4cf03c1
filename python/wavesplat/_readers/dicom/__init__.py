"""DICOM: files of hospitals, headers, frames, series, segments, regions and units."""
