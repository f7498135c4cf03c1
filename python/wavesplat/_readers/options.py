"""Options of reading files: names, types, defaults and meaning, once for all functions that open files.

The first sentence on an option is also its help on the command line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Literal, TypedDict

from wavesplat._public import public

if TYPE_CHECKING:
    from numpy.typing import DTypeLike


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
        DICOM, vendors' files: which series or image, by number, name or start of the UID. DICOM: also by its
        description, or a part of it that no other has (capitals do not count), or its modality ("CT"). The error that
        asks for it lists them.
    time : int, optional
        Which time point, from 0; of DICOM which volume of a series, such as an echo, magnitude or phase. In arrays
        without named axes (.npy, raw, HDF5) time is the first axis.
    channel : int, optional
        Which channel, from 0; of BigDataViewer which setup, in the order of their numbers, be it a channel, a tile or
        an angle. In arrays without named axes channel is the last axis.
    dataset : str, optional
        HDF5, netCDF, .npz, VTK, Zarr, cubes, VASP: the name of the array, if there are several. Of OME-Zarr the path of
        an image in a series or plate, such as "A/1/0".
    level : int, optional
        OME-Zarr, Imaris, BigDataViewer: the level of detail; 0, the default, is the finest.
    shape : (z, y, x), optional
        Raw: number of samples.
    dtype : optional
        Raw: type of the samples, such as "uint8".
    spacing : three numbers (x, y, z), optional
        Distances between neighbouring samples, instead of the file's, in its unit or in `unit`.
    byte_order : "little" or "big", optional
        Raw: byte order of samples wider than a byte; little by default.
    offset : int, default 0
        Raw: bytes before the first sample.
    unit : str, optional
        Unit of lengths, instead of the file's: mm, um, nm, m, ...; numbers stay as they are.
    gaps : "fill" or "refuse", default "fill"
        DICOM: fill in slices that are missing or not evenly spaced, or refuse the series. They are filled in from their
        neighbours, with a warning.
    suv : bool, default False
        DICOM PET: values as standardised uptake values (SUV) by body weight, corrected for decay. This follows the
        header and the pseudo-code of QIBA; an error names what the header lacks for it.
    component : "x", "y", "z" or "magnitude", optional
        Of vectors (HDF5, VTK, NIfTI, MINC 2, Zarr, NumPy): which component, or their length. None is the length, with a
        note; of directions of fibres in NIfTI, three channels.
    resample : int, optional
        Uneven grids (netCDF, VTK, openPMD's modes): sample them evenly, with this many samples along the longest side.
        Of netCDF, whose axes have units of their own, along each axis that is not even. Without it such a grid is an
        error. A note says how much finer or coarser the samples are than the grid.
    external_files : bool, default False
        Read files in other folders, too, that a trusted file or document names. NRRD, MetaImage, OME-TIFF, HDF5 and
        BigDataViewer can name files of samples, HDF5 anywhere: any that you may read.
    memory : str or number, optional
        Leave the samples in their files, and read them while they are drawn: at most this many bytes, such as "2GB". It
        gives a `LazyVolume`, as from `Volume.lazy`, with all levels of the image. None does the same where the samples
        take more than a quarter of the free memory. Not for files that are compressed as one stream, and not for DICOM.
    holes : bool, default False
        With `memory`: leave out samples that cannot be read, and report them, instead of an error.
    cache : bool or path, default True
        With `memory`: where range and bounds of the samples are kept. As for `Volume.lazy`: the user's cache folder, a
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


@dataclass(frozen=True, kw_only=True)
class OpenValues:
    """The values of `OpenOptions`."""

    series: str | int | None = None
    time: int | None = None
    channel: int | None = None
    dataset: str | None = None
    level: int | None = None
    shape: Sequence[int] | None = None
    dtype: DTypeLike | None = None
    spacing: Sequence[float] | None = None
    byte_order: Literal["little", "big"] | None = None
    offset: int = 0
    unit: str | None = None
    gaps: Literal["fill", "refuse"] = "fill"
    suv: bool = False
    component: Literal["x", "y", "z", "magnitude"] | None = None
    resample: int | None = None
    external_files: bool = False
    #: For volumes that are left in their files: bytes that are held at once, whether samples that cannot be read are
    #: left out, and where surveys are kept.
    memory: float | str | None = None
    holes: bool = False
    cache: bool | str | PathLike[str] = True
