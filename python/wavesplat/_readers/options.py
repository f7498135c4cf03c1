"""Options of reading files: names, types and meaning, once for all functions that open files.

Their defaults stand in `Request` (`request.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Literal, TypedDict

from wavesplat._public import public

if TYPE_CHECKING:
    from numpy.typing import DTypeLike

__all__ = ["FileOptions", "OpenOptions"]


class FileOptions(TypedDict, total=False):
    """Options of every function that opens files; `OpenOptions` documents them."""

    series: str | int | None
    dataset: str | None
    level: int | None
    shape: Sequence[int] | None
    dtype: DTypeLike | None
    spacing: Sequence[float] | None
    byte_order: Literal["little", "big"] | None
    offset: int
    unit: str | None
    gaps: Literal["fill", "refuse"]
    suv: bool
    component: Literal["x", "y", "z", "magnitude"] | None
    resample: int | None
    external_files: bool
    memory: float | str | None
    holes: bool
    cache: bool | str | PathLike[str]


@public
class OpenOptions(FileOptions, total=False):
    """Options of reading a volume, as `wavesplat.open` takes them.

    Parameters
    ----------
    series : int or str, optional
        DICOM: which series, if there are several: its number, its description (or a part of it that no other has;
        capitals do not count), its modality ("CT"), or its UID or the start of it. Microscopes' files by bioio: which
        image, by number or name. The error that asks for it lists them.
    time, channel : int, optional
        Which time point and which channel, from 0, if the file holds several. DICOM: which volume of a series, such as
        an echo, or magnitude or phase.
        BigDataViewer: which setup, in the order of their numbers, be it a channel, a tile or an angle.
        In arrays without named axes (.npy, raw, HDF5), time is the first axis and channel the last.
    dataset : str, optional
        HDF5, netCDF, .npz, VTK, Zarr, cubes, VASP: the name of the array, if there are several; of OME-Zarr the path of
        an image in a series or plate, such as "A/1/0".
    level : int, optional
        OME-Zarr, Imaris, BigDataViewer: the level of detail; 0, the default, is the finest.
    shape, dtype : optional
        Raw: number of samples (z, y, x) and their type, such as "uint8".
    spacing : three numbers (x, y, z), optional
        Distances between neighbouring samples, instead of what the file says, in its unit or in `unit`.
    byte_order : "little" or "big", optional
        Raw: of samples wider than a byte; little by default.
    offset : int, default 0
        Raw: bytes before the first sample.
    unit : str, optional
        The world's unit of length, "mm", "um", "nm", "m", ..., instead of what the file says; numbers stay as they are.
    gaps : "fill" or "refuse", default "fill"
        DICOM: slices that are missing, or not evenly spaced, are filled in from their neighbours with a warning, or an
        error.
    suv : bool, default False
        DICOM: a PET's values as standardised uptake values (SUV) by body weight, corrected for decay as the header
        says, by the pseudo-code of QIBA. An error names what the header lacks for it.
    component : "x", "y", "z" or "magnitude", optional
        Of arrays of vectors (HDF5, VTK, NIfTI, MINC 2, Zarr, NumPy): which component, or their length. None is the
        length, with a note; of directions of fibres in NIfTI, three channels.
    resample : int, optional
        netCDF, VTK, openPMD's modes: sample a grid that is not evenly spaced on one that is, with so many samples along
        its longest side; netCDF, whose axes have units of their own, along each axis that is not even. Without it such
        a grid is an error. A note says how much finer or coarser the samples are than the grid.
    external_files : bool, default False
        NRRD, MetaImage, OME-TIFF, HDF5, BigDataViewer: also read samples from files that this one names in other
        folders; HDF5: from any that it names. Such a file can name whatever you may read: allow it for files that you
        trust.
    memory : str or number, optional
        Leave the samples where they are, and read them while they are drawn, with at most this many bytes in memory,
        such as "2 GB": a `LazyVolume`, as from `Volume.lazy`, with all levels of the image. None does the same where
        the samples take more than a quarter of the free memory. Not for files that are compressed as one stream, and
        not for DICOM.
    holes : bool, default False
        With `memory`: samples that cannot be read are left out and reported, instead of an error.
    cache : bool or path, default True
        With `memory`: where range and bounds of the samples are kept, as for `Volume.lazy`: the user's cache folder, a
        folder of that name, or nowhere.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> np.arange(24, dtype=np.uint16).tofile("ramp.raw")
    >>> as_they_are: ws.OpenOptions = {"shape": (2, 3, 4), "dtype": "uint16", "spacing": (1, 1, 2)}
    >>> ws.open("ramp.raw", **as_they_are).spacing
    (1.0, 1.0, 2.0)
    """

    time: int | None
    channel: int | None
