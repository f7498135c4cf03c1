"""The pixels of a picture as a TIFF file has them."""

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws


def tiff_pixels(picture: ws.Picture) -> NDArray[np.generic]:
    """Array of the file, shape (height, width, 3 or 4), uint8."""
    import tifffile

    with tempfile.TemporaryDirectory() as folder:
        picture.save(Path(folder) / "a.tif")
        return tifffile.imread(Path(folder) / "a.tif")
