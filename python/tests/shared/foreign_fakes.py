"""Stand-ins for objects of large libraries, for tests where these are not installed."""

from __future__ import annotations

import numpy as np
import SimpleITK


def simple_itk_image(samples, lps):
    """An image of SimpleITK, samples [z, y, x], and its affine (LPS)."""
    spacing = np.linalg.norm(lps[:3, :3], axis=0)
    image = SimpleITK.GetImageFromArray(samples)
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(lps[:3, 3].tolist())
    image.SetDirection((lps[:3, :3] / spacing).ravel().tolist())
    return image


def of_library(name):
    """Class decorator: the class pretends to be of a library."""

    def changed(kind):
        kind.__module__ = f"{name}.fake"
        return kind

    return changed


# NumPy's protocols ----------------------------------------------------------------------------------------------------


class WithArray:
    """An object with `__array__`, as arrays of JAX, TensorFlow and others."""

    def __init__(self, samples):
        self.samples = samples

    def __array__(self, dtype=None, copy=None):
        return np.array(self.samples, dtype)


class WithDlpack:
    def __init__(self, samples):
        self.samples = samples

    def __dlpack__(self, **options):
        return self.samples.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.samples.__dlpack_device__()


@of_library("cupy")
class OnGpu:
    __cuda_array_interface__ = {}  # noqa: RUF012

    def __array__(self, dtype=None, copy=None):
        raise TypeError("Implicit conversion to a NumPy array is not allowed")


# PyTorch, MONAI -------------------------------------------------------------------------------------------------------


@of_library("torch")
class Tensor:
    """A tensor on a GPU, with a gradient: only after `detach` and `cpu` it gives an array."""

    is_sparse = False
    dtype = "torch.int16"

    def __init__(self, samples, done=()):
        self.samples, self.done = samples, done

    def detach(self):
        return Tensor(self.samples, (*self.done, "detach"))

    def cpu(self):
        return Tensor(self.samples, (*self.done, "cpu"))

    def resolve_conj(self):
        return self

    resolve_neg = resolve_conj

    def numpy(self):
        if self.samples is None:
            raise RuntimeError("Cannot copy out of meta tensor; no data!")
        assert self.done == ("detach", "cpu")
        return self.samples

    def __array__(self, dtype=None, copy=None):
        raise TypeError("can't convert cuda:0 device type tensor to numpy")


@of_library("monai")
class MetaTensor(Tensor):
    def __init__(self, samples, affine):
        super().__init__(samples)
        self.affine = Tensor(affine)


# napari ---------------------------------------------------------------------------------------------------------------


class Layer:
    rgb = multiscale = False

    def __init__(self, data, scale, translate, name, units):
        self.data, self.scale, self.translate, self.name, self.units = data, scale, translate, name, units

    def data_to_world(self, point):
        return tuple(np.asarray(point) * self.scale + self.translate)


Layer.__module__, Layer.__name__ = "napari.layers.image.image", "Image"


# VTK ------------------------------------------------------------------------------------------------------------------


class _Array(np.ndarray):
    def GetNumberOfComponents(self):  # noqa: N802
        return self.shape[3] if self.ndim > 3 else 1

    def GetName(self):  # noqa: N802
        return self.name


class _Data:
    def __init__(self, array):
        self.array = array

    def GetScalars(self):  # noqa: N802
        return self.array

    def GetNumberOfArrays(self):  # noqa: N802
        return 0 if self.array is None else 1

    def GetArray(self, _number):  # noqa: N802
        return self.array

    def GetAbstractArray(self, _name):  # noqa: N802
        return None


class _Matrix:
    def GetElement(self, i, j):  # noqa: N802
        return float(i == j)


@of_library("vtkmodules")
class VtkImage:
    """A vtkImageData of samples [z, y, x], which may begin at another point than 0."""

    def __init__(self, samples, origin, spacing, *, first=(0, 0, 0), of_cells=False, name="values"):
        array = None if samples is None else np.asarray(samples).view(_Array)
        if array is not None:
            array.name = name
        shape = (2, 2, 2) if array is None else array.shape[:3]
        ends = [a + n - (0 if of_cells else 1) for a, n in zip(first, shape[::-1], strict=True)]
        self.extent = tuple(number for pair in zip(first, ends, strict=True) for number in pair)
        self.origin, self.spacing = origin, spacing
        self.points, self.cells = _Data(None if of_cells else array), _Data(array if of_cells else None)

    def GetExtent(self):  # noqa: N802
        return self.extent

    def GetOrigin(self):  # noqa: N802
        return self.origin

    def GetSpacing(self):  # noqa: N802
        return self.spacing

    def GetDirectionMatrix(self):  # noqa: N802
        return _Matrix()

    def GetPointData(self):  # noqa: N802
        return self.points

    def GetCellData(self):  # noqa: N802
        return self.cells

    def GetFieldData(self):  # noqa: N802
        return _Data(None)


@of_library("vtkmodules")
class VtkMesh:
    pass
