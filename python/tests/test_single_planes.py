"""Files of a single plane: `wavesplat slice` shows them, and elsewhere a sentence says so."""

import nibabel
import numpy as np
import pytest
import SimpleITK
import tifffile
from PIL import Image

import wavesplat as ws
from wavesplat.errors import FileError

PLANE = np.random.default_rng(3).integers(0, 256, (40, 50), np.uint8)


def write_vti(path, samples):
    z, y, x = samples.shape
    extent, numbers = f"0 {x - 1} 0 {y - 1} 0 {z - 1}", " ".join(map(str, samples.ravel().tolist()))
    path.write_text(
        f'<VTKFile type="ImageData" version="1.0"><ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">'
        f'<Piece Extent="{extent}"><PointData Scalars="v"><DataArray Name="v" type="UInt8" format="ascii">{numbers}'
        "</DataArray></PointData></Piece></ImageData></VTKFile>"
    )


WAYS = {
    "a.tif": lambda path: tifffile.imwrite(path, PLANE),
    "a.npy": lambda path: np.save(path, PLANE),
    "flat.npy": lambda path: np.save(path, PLANE[None]),
    "a.nrrd": lambda path: SimpleITK.WriteImage(SimpleITK.GetImageFromArray(PLANE), str(path)),
    "a.mha": lambda path: SimpleITK.WriteImage(SimpleITK.GetImageFromArray(PLANE[None]), str(path)),
    "a.vti": lambda path: write_vti(path, PLANE[None]),
}


@pytest.mark.parametrize("name", WAYS)
def test_the_slice_command_shows_a_single_plane(tmp_path, wavesplat, name):
    WAYS[name](tmp_path / name)
    window = ["--clim", "0,255", "--size", "50x40"]
    done = wavesplat("slice", str(tmp_path / name), "-o", str(tmp_path / "o.png"), *window)
    assert done.returncode == 0, done.stderr
    assert "note: a single plane" in done.stderr
    shown = np.asarray(Image.open(tmp_path / "o.png").convert("L")).astype(int)
    # The picture's rows may run the other way in the world of the file; the values are those of the file.
    ways = [PLANE, PLANE[::-1], PLANE[:, ::-1], PLANE[::-1, ::-1]]
    assert min(np.abs(shown - way.astype(int)).max() for way in ways) <= 1


def test_the_plane_that_it_holds_is_shown(tmp_path, wavesplat):
    # A coronal slice: flat along y.
    image = nibabel.Nifti1Image(PLANE.T[:, None, :], np.diag([1.0, 3, 1, 1]))
    image.to_filename(tmp_path / "a.nii.gz")
    done = wavesplat("slice", str(tmp_path / "a.nii.gz"), "-o", str(tmp_path / "o.png"), "--size", "50x40")
    assert done.returncode == 0, done.stderr
    assert np.asarray(Image.open(tmp_path / "o.png").convert("L")).std() > 50


@pytest.mark.parametrize("name", WAYS)
def test_elsewhere_a_sentence_says_what_it_is(tmp_path, wavesplat, name):
    WAYS[name](tmp_path / name)
    with pytest.raises(FileError, match="a single plane of x 50, y 40, z 1 samples.*`wavesplat slice` shows it"):
        ws.open(tmp_path / name)
    done = wavesplat("render", str(tmp_path / name), "-o", str(tmp_path / "o.png"))
    assert done.returncode == 1
    assert "a single plane" in done.stderr
    assert not (tmp_path / "o.png").exists()


def test_a_line_of_samples_is_no_plane(tmp_path):
    np.save(tmp_path / "a.npy", PLANE[None, :1])
    with pytest.raises(FileError, match="fewer than 2 samples"):
        ws.open(tmp_path / "a.npy")


@pytest.mark.parametrize("name", ["b.tif", "b.ome.tiff", "b.ims", "b.nii.gz?token=secret"])
def test_addresses_of_other_files_than_zarr_say_the_way(name):
    with pytest.raises(FileError, match="only Zarr is read from addresses; get the file first") as error:
        ws.open(f"https://example.invalid/a/{name}")
    assert "secret" not in str(error.value)
