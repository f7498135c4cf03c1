"""Meshes of openPMD in cylindrical modes, sampled on a box, beside the formula of their Fourier series."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

R_STEP, Z_STEP, Z_FIRST = 0.5, 0.25, 3.0
N_R, N_Z = 24, 40


def series(r, theta, z, sign=1.0, is_of_plane=False):
    """A smooth field of three modes, linear in z, and its coefficients' symmetry at the axis: r^m times even powers."""
    shift = 1 if is_of_plane else 0
    radial = [r**shift * (2 + 0.01 * r**2), r ** (1 - shift), 0.05 * r ** (2 - shift)]
    return (
        radial[0] * (1 + z)
        + radial[1] * (0.5 * z * np.cos(theta) + sign * (2 - z) * np.sin(theta))
        + radial[2] * (z * np.cos(2 * theta) + sign * 3 * np.sin(2 * theta))
    )


def coefficients(r, z, is_of_plane=False):
    shift = 1 if is_of_plane else 0
    r, z = np.meshgrid(r, z, indexing="ij")
    radial = [r**shift * (2 + 0.01 * r**2), r ** (1 - shift), 0.05 * r ** (2 - shift)]
    parts = [radial[0] * (1 + z), radial[1] * 0.5 * z, radial[1] * (2 - z), radial[2] * z, radial[2] * 3]
    return np.stack(parts)


def places(position):
    return (np.arange(N_R) + position) * R_STEP, Z_FIRST + np.arange(N_Z) * Z_STEP


def mesh_attributes(node, order="C", labels=("r", "z"), imag="+"):
    step = {"r": R_STEP, "z": Z_STEP}
    first = {"r": 0.0, "z": Z_FIRST}
    node.attrs.update(geometry=b"thetaMode", geometryParameters=np.bytes_(f"m=3;imag={imag}"))
    node.attrs.update(axisLabels=np.array(labels, "S1"), dataOrder=np.bytes_(order), gridUnitSI=1e-6)
    node.attrs.update(gridSpacing=[step[a] for a in labels], gridGlobalOffset=[first[a] for a in labels])


def scalar_file(path, position=0.5, order="C", labels=("r", "z"), imag="+"):
    stored = coefficients(*places(position))
    in_file = labels if order == "C" else labels[::-1]
    stored = stored if in_file == ("r", "z") else stored.transpose(0, 2, 1)
    with h5py.File(path, "w") as file:
        mesh = file.create_dataset("data/1/meshes/rho", data=stored)
        mesh_attributes(mesh, order, labels, imag)
        mesh.attrs["position"] = [position if a == "r" else 0.0 for a in labels]
    return path


def box_of(volume):
    """Radius, angle and z of every sample [z, y, x]."""
    nz, ny, nx = volume.shape
    z, y, x = np.meshgrid(*(np.arange(n) for n in (nz, ny, nx)), indexing="ij")
    world = volume.world_from_index
    x, y, z = (world[a, a] * k + world[a, 3] for a, k in enumerate((x, y, z)))
    return np.hypot(x, y), np.arctan2(y, x), z


def check(samples, expected, inside, at_most):
    assert (~inside).any()
    assert np.isnan(samples[~inside]).all()
    assert np.abs(samples[inside] - expected[inside]).max() <= at_most * np.abs(expected[inside]).max()


@pytest.mark.parametrize("position", [0.0, 0.5, 0.25])
@pytest.mark.parametrize(("order", "labels"), [("C", ("r", "z")), ("C", ("z", "r")), ("F", ("r", "z"))])
@pytest.mark.parametrize("imag", ["+", "-"])
def test_the_box_has_the_values_of_the_series(tmp_path, position, order, labels, imag):
    volume = ws.open(scalar_file(tmp_path / "a.h5", position, order, labels, imag), resample=33)
    assert (max(volume.shape), volume.unit, volume.facts.quantity) == (33, "um", "rho")
    r, theta, z = box_of(volume)
    radius = (N_R - 1 + position) * R_STEP
    assert volume.bounds == pytest.approx(
        np.array([(-radius, -radius, Z_FIRST), (radius, radius, Z_FIRST + (N_Z - 1) * Z_STEP)])
    )
    # Quadratic in r between points half a micrometre apart: at most a thousandth beside the largest value.
    expected = series(r, theta, z, -1.0 if imag == "-" else 1.0)
    check(volume.samples, expected, r <= radius * (1 + 1e-9), 1e-3)
    assert any("5 modes" not in guess and "3 modes" in guess for guess in volume.guesses)


def test_modes_that_are_linear_in_r_and_z_are_exact(tmp_path):
    path = tmp_path / "a.h5"
    r, z = places(0.5)
    rr, zz = np.meshgrid(r, z, indexing="ij")
    with h5py.File(path, "w") as file:
        mesh = file.create_dataset("data/1/meshes/phi", data=np.stack([1 + zz, 2 * rr, -3 * rr]))
        mesh_attributes(mesh)
        mesh.attrs["position"] = [0.5, 0.0]
    volume = ws.open(path, resample=41)
    r, theta, z = box_of(volume)
    # 1 + z + 2 x - 3 y.
    expected = 1 + z + 2 * r * np.cos(theta) - 3 * r * np.sin(theta)
    check(volume.samples, expected, r <= r.max() / np.sqrt(2) * (1 + 1e-9), 1e-6)


def test_vectors_are_turned_to_x_and_y(tmp_path):
    path = tmp_path / "a.h5"
    r, z = places(0.5)
    rr, zz = np.meshgrid(r, z, indexing="ij")
    with h5py.File(path, "w") as file:
        mesh = file.create_group("data/1/meshes/E")
        mesh_attributes(mesh)
        # E = (3, -y, z): E_r = 3 cos θ - r sin² θ = 3 cos θ - r/2 + r/2 cos 2θ, E_t = -3 sin θ - r sin θ cos θ.
        none = 0 * rr
        mesh["r"] = np.stack([-rr / 2, 3 + none, none, rr / 2, none])
        mesh["t"] = np.stack([none, none, -3 + none, none, -rr / 2])
        mesh["z"] = np.stack([zz, none, none, none, none])
        for name in "rtz":
            mesh[name].attrs["position"] = [0.5, 0.0]
    open_one = {"dataset": "data/1/meshes/E", "resample": 25}
    parts = {axis: ws.open(path, component=axis, **open_one) for axis in ("x", "y", "z", "magnitude")}
    radius, theta, z = box_of(parts["x"])
    inside = radius <= (N_R - 0.5) * R_STEP * (1 + 1e-9)
    vector = {"x": 3 + 0 * z, "y": -radius * np.sin(theta), "z": z}
    vector["magnitude"] = np.sqrt(sum(one**2 for one in vector.values()))
    for axis, volume in parts.items():
        assert np.abs(volume.samples - vector[axis])[inside].max() < 1e-5 * np.abs(vector[axis]).max(), axis
        assert volume.facts.quantity == f"E {axis}"
    default = ws.open(path, **open_one)
    np.testing.assert_array_equal(default.samples, parts["magnitude"].samples)
    assert any("the length is drawn" in guess for guess in default.guesses)
    radial = ws.open(path, dataset="data/1/meshes/E/r", resample=25)
    expected = 3 * np.cos(theta) - radius * np.sin(theta) ** 2
    away = inside & (radius > R_STEP)
    assert np.abs(radial.samples - expected)[away].max() < 1e-5 * np.abs(expected).max()
    with pytest.raises(ArgumentError, match="name the record"):
        ws.open(path, dataset="data/1/meshes/E/r", component="x", resample=25)


def test_what_cannot_be_sampled_is_said(tmp_path):
    path = scalar_file(tmp_path / "a.h5")
    with pytest.raises(FileError, match=r"thetaMode.*resample=N"):
        ws.open(path)
    with pytest.raises(ArgumentError, match="leave out memory="):
        ws.open(path, resample=20, memory="1 MB")
    with h5py.File(path, "r+") as file:
        file["data/1/meshes/rho"].attrs["axisLabels"] = np.array(["x", "z"], "S1")
    with pytest.raises(FileError, match="they must be r and z"):
        ws.open(path, resample=20)
    with h5py.File(path, "r+") as file:
        file["data/1/meshes/rho"].attrs["geometry"] = b"cartesian"
    with pytest.raises(ArgumentError, match="grids that are not even"):
        ws.open(path, resample=20)
    with h5py.File(tmp_path / "b.h5", "w") as file:
        mesh_attributes(file.create_dataset("rho", data=np.zeros((4, 8, 9))))
    with pytest.raises(FileError, match=r"shape \(2 m \+ 1, r, z\)"):
        ws.open(tmp_path / "b.h5", resample=20)
