"""Make the volumes that the package bundles, from the data collection they were taken from.

    python python/tools/make_example_data.py FOLDER_OF_THE_COLLECTION

`mri_head_t1.nii.gz` is resampled to 1.5 mm along its own oblique axes and stored in 8 bits (its range is 0..208);
`ct_abdomen_pelvis_3mm.nii.gz` is copied as it is.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import SimpleITK as sitk  # noqa: N813 - its own documentation calls it so

SPACING_MM = 1.5
DATA = Path(__file__).parents[1] / "wavesplat" / "data"


def make_mri_head(source: Path) -> None:
    """Smooth to the coarser grid's band, resample, and narrow to uint8."""
    fine = sitk.Cast(sitk.ReadImage(str(source)), sitk.sitkFloat32)
    # A Gaussian of 0.4 of the new spacing keeps aliasing below what 1.5 mm can show.
    smooth = sitk.DiscreteGaussian(fine, [(SPACING_MM * 0.4) ** 2] * 3, useImageSpacing=True)
    size = [int((n - 1) * step / SPACING_MM) + 1 for n, step in zip(fine.GetSize(), fine.GetSpacing(), strict=True)]
    coarse = sitk.Resample(
        smooth, size, sitk.Transform(), sitk.sitkBSpline, fine.GetOrigin(), [SPACING_MM] * 3, fine.GetDirection()
    )
    rounded = sitk.Cast(sitk.Round(sitk.Clamp(coarse, sitk.sitkFloat32, 0, 255)), sitk.sitkUInt8)
    for key in rounded.GetMetaDataKeys():
        rounded.EraseMetaData(key)
    sitk.WriteImage(rounded, str(DATA / "mri_head" / "mri_head.nii.gz"), useCompression=True, compressionLevel=9)


def main() -> None:
    """Make both volumes."""
    collection = Path(sys.argv[1])
    make_mri_head(collection / "mri_head_t1.nii.gz")
    shutil.copyfile(collection / "ct_abdomen_pelvis_3mm.nii.gz", DATA / "ct_pelvis" / "ct_pelvis.nii.gz")


if __name__ == "__main__":
    main()
