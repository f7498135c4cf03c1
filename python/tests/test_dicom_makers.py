"""Headers that scanners of several makers wrote, without their patients, against the results of other programs.

`fixtures/dicom_headers` holds values of attributes from public files, and names these; the pixels are made up.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from dicom_files import random, save, sequence, slice_at

import wavesplat as ws

FOLDER = Path(__file__).parent / "fixtures" / "dicom_headers"
PET = json.loads((FOLDER / "pet.json").read_text())["headers"]
#: Private elements of Philips by their names.
PHILIPS = {"SUVScaleFactor": 0x00, "ActivityConcentrationScaleFactor": 0x09}


@pytest.mark.parametrize("scan", PET, ids=[scan["name"] for scan in PET])
def test_uptake_of_real_headers_is_that_of_calculate_suv(tmp_path, scan):
    pixels = random(3)
    datasets = []
    for number, one in enumerate(pixels):
        drug = sequence(scan["tracer"])
        own = {"RescaleSlope": 1 + number, "RescaleIntercept": 0, "RadiopharmaceuticalInformationSequence": drug}
        dataset = slice_at(one, number, modality="PT", **scan["header"], **own)
        for name, value in scan["private"].items():
            block = dataset.private_block(0x7053, "Philips PET Private Group", create=True)
            block.add_new(PHILIPS[name], "DS", str(value))
        datasets.append(dataset)
    volume = ws.open(save(tmp_path / "pet", datasets), suv=True)
    slopes = np.arange(1, 4)[:, None, None]
    np.testing.assert_allclose(volume.samples, pixels * slopes * scan["suv_factor"], rtol=1e-3)
