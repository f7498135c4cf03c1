"""A volume: samples on a grid, and where the grid lies in the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._model.arguments.clips import Crop
from wavesplat._model.arguments.types import takes_its_types, text_of
from wavesplat._model.interchange import convert_to, volume_file
from wavesplat._model.interchange.convert_from import converted
from wavesplat._model.interchange.converted import Converted, check_shape
from wavesplat._model.lazy.checks import is_wide_integer, narrowest_integer, renderable_type
from wavesplat._model.volume import affine, smoothing, units
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.sources import Source, then
from wavesplat._model.volume.stack import Box, stacked
from wavesplat._public import public
from wavesplat._storage.paths import printable
from wavesplat._system import values
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    import nibabel
    import pyvista
    import SimpleITK
    import xarray
    from numpy.typing import DTypeLike

    from wavesplat._model.lazy.volume import LazyVolume


@public
class Volume(Grid):
    """A 3-D grid of scalar samples and its place in the world.

    Parameters
    ----------
    samples : array, shape (z, y, x), or an image
        Any real dtype. An array of NumPy, Dask, Zarr, h5py, PyTorch (detached, copied from a GPU) or xarray; an image
        of SimpleITK, ITK, nibabel, PyVista or VTK; a layer of napari; another volume. What these say of place, unit,
        anatomy and name counts (docs/interop.md has the table), unless `spacing` or `world_from_index` is given.
        8, 16 and 32-bit integers and 32 and 64-bit floats keep their type.
        A C-contiguous array of these types is shared, not copied, and `samples` is a read-only view of it. After
        writing to your own array call `changed`: what was prepared for earlier pictures would make wrong ones.
        Do not write to it while a picture is drawn. Any other array is copied.
        NaN and infinity are missing: each takes one cell of matter out of the picture, whatever the kernel.
    spacing : three numbers (x, y, z), optional
        Distances between neighbouring samples, in world units.
        Sample (0, 0, 0) is then at the world origin. Default 1.
    world_from_index : array, shape (4, 4), optional
        Affine from the index (x, y, z) of a sample to the world, instead of `spacing`. Shear is fine.
    unit : str, optional
        The world's unit of length: "mm", "um", "nm", "m", ...; None is unknown. Scale bars show it.
    anatomical : bool, optional
        Whether the world's axes are a patient's (RAS), as with an affine from nibabel; only then slices have
        letters. None is what `facts` say, or no.
    name : str, optional
        Name in messages; None is the object's own name, or "volume".
    facts : Facts, optional
        Facts beside samples and place; `unit` and `anatomical` take precedence over its fields.

    Raises
    ------
    ArgumentError
        If the array is not 3-D, is empty or not real, or the spacing or affine is degenerate.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> volume = ws.Volume(np.zeros((20, 30, 40), np.int16), spacing=(0.5, 0.5, 1.5))
    >>> volume.shape, volume.bounds[1].tolist()
    ((20, 30, 40), [19.5, 14.5, 28.5])
    """

    #: `_cut`: the boxes that were last taken out for a picture, and the volume without them (`_model.volume.cutting`).
    #: `_kind`: the kind of data found in its samples (`_looks.kinds.kinds`), None until looked for.
    #: `_parts`: parts of it that were drawn, or why there is none: without the table, the brain (`_looks`).
    #: `_resampled`: the axes it was last resampled on, and the resampled volume (`_scene.drawing.resampling`).
    #: `_source`: its source for documents, None if unknown (`_model.volume.sources`).
    #: `_lazily`: the volume as a lazy one, for pictures with lazy volumes (`_render.lazy_layers`).
    __slots__ = ("_core", "_cut", "_kind", "_lazily", "_parts", "_resampled", "_samples", "_source")

    _cut: tuple[tuple[Crop, ...], Volume] | None
    _kind: Any
    _resampled: tuple[bytes, Volume] | None
    _parts: dict[Any, Any]
    _source: Source | None
    _lazily: LazyVolume | None

    def __init__(
        self,
        samples: object,
        *,
        spacing: Sequence[float] | None = None,
        world_from_index: ArrayLike | None = None,
        unit: str | None = None,
        anatomical: bool | None = None,
        name: str | None = None,
        facts: Facts | None = None,
    ) -> None:
        has_place = spacing is not None or world_from_index is not None
        found = converted(samples, "samples", has_place=has_place)
        self._fill(
            found,
            spacing=spacing,
            world_from_index=world_from_index,
            unit=unit,
            anatomical=anatomical,
            name=name,
            facts=facts,
        )

    @staticmethod
    def lazy(
        samples: object,
        *,
        spacing: Sequence[float] | None = None,
        world_from_index: ArrayLike | None = None,
        unit: str | None = None,
        anatomical: bool | None = None,
        name: str | None = None,
        facts: Facts | None = None,
        memory: float | str | None = None,
        level: int | None = None,
        cache: bool | str | PathLike[str] = True,
        holes: bool = False,
    ) -> LazyVolume:
        """A volume whose samples stay where they are, and are read while it is drawn; for data larger than memory.

        Parameters
        ----------
        samples : array, or list of arrays
            Anything with `shape` (z, y, x), `dtype` and slicing: of Zarr, Dask, h5py, xarray, TensorStore, a memory
            map of NumPy. A list has the levels of a pyramid, the finest first, each about half as large as the one
            before; pictures take the coarsest whose samples are no further apart than pixels.
        spacing, world_from_index, unit, anatomical, name, facts : optional
            As for `Volume`, for the finest level; coarser ones fill the same box, from the outer faces of its samples,
            where the arrays do not say where they lie.
        memory : str or number, optional
            Bytes of samples that are held at once while it is drawn, such as "2 GB". None is a quarter of the memory
            that is free, at most 4 GB.
        level : int, optional
            Draw this level, whatever the picture; 0 is the finest.
        cache : bool or path, default True
            Where to keep the survey, made by one pass over the samples (their range, and bounds of bricks, by which
            invisible chunks are not read again): the user's cache folder, a folder of that name, or nowhere. Surveys of
            arrays without files (Dask, web servers) are only kept in a folder that you name. See docs/large_volumes.md.
        holes : bool, default False
            Samples that cannot be read are drawn as the smallest value, and listed in `Picture.report["holes"]`,
            instead of an error that names the chunk.

        Returns
        -------
        LazyVolume
            It is drawn as any volume, to the byte as the CPU draws one in memory.

        Raises
        ------
        ArgumentError
            If the array is not 3-D or not real, or the place is degenerate.

        Examples
        --------
        >>> import numpy as np, os, tempfile, wavesplat as ws
        >>> path = os.path.join(tempfile.mkdtemp(), "big.npy")
        >>> np.save(path, np.arange(60000, dtype=np.uint16).reshape(30, 40, 50))
        >>> lazy = ws.Volume.lazy(np.load(path, mmap_mode="r"), spacing=(1, 1, 2), memory="200 MB")
        >>> lazy.shape, lazy.value_range
        ((30, 40, 50), (0.0, 59999.0))

        Notes
        -----
        The first picture of a level looks through all of its samples once before it is drawn.
        """
        from wavesplat._model.lazy.parts import lazy_volume

        return lazy_volume(
            samples,
            place=(spacing, world_from_index),
            given=(unit, anatomical, name, facts),
            memory=memory,
            level=level,
            keep=cache,
            holes=holes,
        )

    @classmethod
    def _of(cls, thing: object, name: str | None, argument: str) -> Volume:
        """The volume of another library's object; `argument`: name of the argument in messages."""
        volume = cls.__new__(cls)
        volume._fill(converted(thing, argument), name=name)
        return volume

    def _fill(
        self,
        found: Converted,
        *,
        spacing: Sequence[float] | None = None,
        world_from_index: ArrayLike | None = None,
        unit: str | None = None,
        anatomical: bool | None = None,
        name: str | None = None,
        facts: Facts | None = None,
    ) -> None:
        name = printable((found.name or "volume") if name is None else text_of(name, "name of the volume"))
        self._samples = _as_renderable(found.samples, name)
        n_z, n_y, n_x = self._samples.shape
        if spacing is None and world_from_index is None:
            world_from_index = found.world_from_index
            known = found.facts
        else:  # the object's unit and anatomy belong to its own place
            known = replace(found.facts, unit=None, is_anatomical=False)
        matrix = _checked_affine(spacing, world_from_index, name)
        if spacing is not None:
            matrix = matrix @ np.diag([*found.directions, 1.0])
        given = known if facts is None else _with_guesses(facts, known.guesses, name)
        super().__init__(name, (n_z, n_y, n_x), matrix, _checked_facts(given, unit, anatomical, name))
        self._source = None
        # Built at once, so that what is wrong with a volume is said where the volume is made.
        self._renew()

    def changed(self) -> None:
        """Report that the shared array was written to: the range of values and all prepared data are made anew.

        A volume whose array was copied (see `Volume`) keeps its samples: make a new one.

        Raises
        ------
        ArgumentError
            If no sample is finite any more.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> array = np.zeros((20, 30, 40), np.uint8)
        >>> volume = ws.Volume(array)
        >>> array[5:15] = 200
        >>> volume.changed()
        >>> volume.value_range
        (0.0, 200.0)
        """
        self._source = None
        self._renew()

    def smoothed(self, deviation: float, *, unit: Literal["voxels", "world"] = "voxels") -> Volume:
        """The volume smoothed by a Gaussian: less noise, and no rings on skin that the steps of samples make.

        Parameters
        ----------
        deviation : float
            Standard deviation of the Gaussian, 0 or more, the same along all axes; 0.5 to 1 voxel softens what samples
            show of themselves and moves no edge. The kernel ends at 3 deviations; beyond the volume its outermost
            samples are repeated.
        unit : "voxels" or "world"
            Unit of the deviation: distances of samples, or world units, along the volume's axes.

        Returns
        -------
        Volume
            float32, shape, place and name as before; float64 of 32-bit integers and float64. `facts.processing` records
            it. Samples that are not finite take no part and are NaN. A deviation so small that no neighbour has a
            weight returns the volume itself.

        Raises
        ------
        ArgumentError
            If the deviation is negative, not finite or wider than the volume, or the unit has another name.

        Examples
        --------
        >>> import wavesplat as ws
        >>> pelvis = ws.examples.ct_pelvis().smoothed(0.7)
        >>> pelvis.dtype, pelvis.facts.processing
        (dtype('float32'), ('smoothed by a Gaussian, deviation 0.7 voxels',))
        """
        if unit not in ("voxels", "world"):
            raise ArgumentError(f'unit of the deviation is {described(unit)}; it is "voxels" or "world"')
        number = values.number(deviation, "deviation", "a number", finite=False)
        named = (self.unit or "world units") if unit == "world" else unit
        steps = self.spacing if unit == "world" else (1.0, 1.0, 1.0)
        deviations = [number / step for step in reversed(steps)]
        if not (number >= 0 and max(deviations) <= max(self.shape)):
            raise ArgumentError(
                f"deviation is {number:g} {named}; give 0 or more, and no more than the volume is wide: "
                f"{self.shape} samples (z, y, x)"
            )
        if max(deviations) < smoothing.MIN_DEVIATION:
            return self
        samples = smoothing.smoothed(self._samples, deviations)
        source = then(self._source, "smoothed", deviation=number, unit=unit)
        return self._processed(samples, f"smoothed by a Gaussian, deviation {number:g} {named}", source)

    def moved(self, matrix: ArrayLike) -> Volume:
        """The volume at another place: the same samples, and an affine map after `world_from_index`.

        Parameters
        ----------
        matrix : array, shape (4, 4)
            Affine from the volume's world to the new one, column vectors, world units, such as `open_transform` reads
            it from the file of a registration.

        Returns
        -------
        Volume
            Nothing is resampled. `facts.processing` says that it was moved.

        Raises
        ------
        ArgumentError
            If it is no affine map, or has no inverse.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> shift = np.eye(4)
        >>> shift[:3, 3] = 5, 0, -2
        >>> ws.examples.ripples(8).moved(shift).world_from_index[:3, 3] - ws.examples.ripples(8).world_from_index[:3, 3]
        array([ 5.,  0., -2.])
        """
        world_from_world = affine.checked_map(matrix, f"volume {self._name!r}: the matrix to move it by")
        facts = replace(self._facts, processing=(*self._facts.processing, "moved by an affine map"))
        return self._placed(world_from_world, facts, then(self._source, "moved", matrix=world_from_world.tolist()))

    def _placed(self, world_from_world: NDArray[np.float64], facts: Facts, source: Source | None) -> Volume:
        """The volume with a map after its affine, and with new `facts` and `source`."""
        matrix = world_from_world @ self._world_from_index
        made = Volume(self._samples, world_from_index=matrix, name=self._name, facts=facts)
        made._source = source
        return made

    def to_xarray(self) -> xarray.DataArray:
        """The volume as an array with names: axes z, y, x, coordinates in the world, and the unit as their `units`.

        Axes that are not the world's count along themselves from 0; the attribute `world_from_coordinates`, 16 numbers
        row by row, takes (x, y, z, 1) to the world. Attributes also say `space`, "RAS" of a patient, and `modality`.
        The samples are shared.

        Raises
        ------
        LibraryError
            If xarray is not installed (`pip install "wavesplat[xarray]"`).

        Examples
        --------
        >>> import wavesplat as ws
        >>> array = ws.examples.ct_pelvis().to_xarray()
        >>> ws.Volume(array.isel(z=slice(10, 20))).shape[0]
        10
        """
        return convert_to.to_xarray(self, self._samples)

    def to_sitk(self) -> SimpleITK.Image:
        """The volume as an image of SimpleITK; its world is LPS and millimetres if the volume's is a patient's.

        Another world stays as it is, and the image's metadata say so (`NRRD_space` and `unit`).

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.examples.ct_pelvis().to_sitk().GetSize()
        (122, 101, 112)
        """
        return convert_to.to_simple_itk(self, self._samples)

    def to_nibabel(self) -> nibabel.Nifti1Image:
        """The volume as a NIfTI image of nibabel, in millimetres where its unit is known. The samples are shared.

        NIfTI has no world but a patient's: of another the description says "axes without anatomy", which `Volume` and
        `wavesplat.open` understand.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.examples.ct_pelvis().to_nibabel().header.get_xyzt_units()[0]
        'mm'
        """
        return convert_to.to_nibabel(self, self._samples)

    def to_pyvista(self) -> pyvista.ImageData:
        """The volume as an image of PyVista, its samples the active scalars of the points, called as the volume is.

        Field data say `unit` and, of a patient's world, `space`, "RAS".

        Raises
        ------
        LibraryError
            If PyVista is not installed (`pip install "wavesplat[pyvista]"`).
        """
        return convert_to.to_pyvista(self, self._samples)

    @takes_its_types
    def save(self, path: str | PathLike[str], *, downsampling: Literal["mean", "nearest"] | None = None) -> None:
        """Write the volume to a file; the suffix chooses the format.

        Parameters
        ----------
        path : path
            `.nii.gz` or `.nii` (NIfTI; see `to_nibabel` for units and anatomy), or `.nrrd`, which keeps place, unit,
            anatomy and modality as they are. `.ome.tif` (OME-TIFF): distances and their unit, name and colour of the
            channel. `.ome.zarr` (OME-Zarr 0.5, a folder): the same, place and window, and coarser levels; it replaces
            only a folder of Zarr. Samples keep their type. The last two are written part by part: lazy volumes stay in
            their files.
        downsampling : "mean" or "nearest", optional
            For `.ome.zarr`: samples of coarser levels are means of finer ones, or every second one, for labels. None is
            "nearest" for segmentations of DICOM, else "mean".

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.

        Warns
        -----
        WavesplatWarning
            If OME-TIFF or OME-Zarr has no place for a fact, such as anatomy or turned axes.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.examples.ripples(16).save("ripples.nrrd")
        >>> ws.open("ripples.nrrd").shape
        (16, 16, 16)
        """
        volume_file.save(stacked([[self]]), path, downsampling)

    def _stored_grid(self) -> Grid:
        """Grid of the samples that `save` writes."""
        return self

    def _stored_box(self, box: Box) -> NDArray[Any]:
        """Samples of a box, [z, y, x]."""
        return self._samples[tuple(slice(lower, upper) for lower, upper in zip(*box, strict=True))]

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """The samples, as `numpy.asarray(volume)` asks for them: read-only, unless they are copied."""
        wanted = self.dtype if dtype is None else np.dtype(dtype)
        if copy is False and wanted != self.dtype:
            raise ValueError(f"samples are {self.dtype}; {wanted} of them is a copy")
        if copy:
            return np.array(self._samples, wanted)
        return self._samples.astype(wanted, copy=False)

    def _processed(self, samples: NDArray[Any], how: str, source: Source | None) -> Volume:
        """A volume of processed samples at the same place; `how` is added to its `facts.processing`."""
        facts = replace(self._facts, processing=(*self._facts.processing, how))
        made = Volume(samples, world_from_index=self._world_from_index, name=self._name, facts=facts)
        made._source = source
        return made

    def _renew(self) -> None:
        """Rebuild the core, and drop all that was made from the samples."""
        self._core = self._built()
        self._cut = None
        self._kind = None
        self._lazily = None
        self._resampled = None
        self._parts = {}

    def _built(self) -> _native.Volume:
        return _native.Volume(self._samples, self._world_from_index, self._name)

    @property
    def samples(self) -> NDArray[Any]:
        """The samples, shape (z, y, x), read-only, in the type they are rendered from."""
        return self._samples

    @property
    def dtype(self) -> np.dtype[Any]:
        """The samples' type."""
        return self._samples.dtype

    @property
    def _type_in_memory(self) -> np.dtype[Any]:
        """The type that the samples have in memory, by which looks are chosen."""
        return self.dtype

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite sample."""
        return self._core.value_range

    @property
    def n_nonfinite(self) -> int:
        """Number of samples that are NaN or infinite: missing samples, which make matter around them fainter."""
        return self._core.n_nonfinite

    def _every(self, step: int) -> NDArray[Any]:
        """Every n-th sample along each axis, [z, y, x]."""
        return self._samples[::step, ::step, ::step]

    def __repr__(self) -> str:
        n_z, n_y, n_x = self.shape
        spacing = " x ".join(f"{step:.4g}" for step in self.spacing)
        return (
            f"<Volume {self.name!r}: z {n_z}, y {n_y}, x {n_x}, {self.dtype}, "
            f"spacing (x, y, z) {spacing}{f' {self.unit}' if self.unit else ''}"
            f"{f', {self.orientation}' if self.is_anatomical else ''}{f', {self.modality}' if self.modality else ''}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        how = partial(type(self), world_from_index=self._world_from_index, name=self._name, facts=self._facts)
        return how, (self._samples,), self._source

    def __setstate__(self, source: Source) -> None:
        self._source = source


def _as_renderable(array: NDArray[Any], name: str) -> NDArray[Any]:
    """A read-only, C-contiguous, native-endian 3-D array of a type the renderer takes; shared where possible."""
    check_shape(array.shape, name)
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.result_type(array.dtype, np.float32)), np.nan)
    dtype = _renderable_dtype(array, name)
    shared = np.require(array, dtype, ["C", "A"]).view()
    shared.flags.writeable = False
    return shared


def _renderable_dtype(array: NDArray[Any], name: str) -> np.dtype[Any]:
    if is_wide_integer(array.dtype):
        return narrowest_integer(int(array.min()), int(array.max()))
    return renderable_type(array.dtype, name)


def _with_guesses(facts: Facts, guesses: tuple[str, ...], name: str) -> Facts:
    given: object = facts
    if not isinstance(given, Facts):
        raise ArgumentError(f"volume {name!r}: facts is a {type(given).__name__}; give a wavesplat.Facts")
    return replace(facts, guesses=(*facts.guesses, *guesses))


def _checked_facts(facts: Facts, unit: str | None, anatomical: bool | None, name: str) -> Facts:
    if unit is not None:
        facts = replace(facts, unit=units.checked(unit))
    if anatomical is None:
        return facts
    try:
        return replace(facts, is_anatomical=bool(anatomical))
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"volume {name!r}: anatomical is {described(anatomical)}; give True or False") from None


def _checked_affine(
    spacing: Sequence[float] | None, world_from_index: ArrayLike | None, name: str
) -> NDArray[np.float64]:
    if world_from_index is None:
        matrix = affine.from_spacing((1.0, 1.0, 1.0) if spacing is None else spacing)
    elif spacing is not None:
        raise ArgumentError(f"volume {name!r}: got both spacing and world_from_index; give one of them")
    else:
        try:
            matrix = np.array(world_from_index, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ArgumentError(f"volume {name!r}: world_from_index is no array of numbers; give 4 x 4") from None
        if matrix.shape != (4, 4):
            raise ArgumentError(f"volume {name!r}: world_from_index has shape {matrix.shape}; it must be (4, 4)")
        if matrix[3].tolist() != [0, 0, 0, 1]:
            raise ArgumentError(
                f"volume {name!r}: the last row of world_from_index is {matrix[3].tolist()}; it must be 0, 0, 0, 1"
            )
    matrix.flags.writeable = False
    return matrix
