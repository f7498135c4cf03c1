"""Files of a single plane: `wavesplat slice` shows them, and elsewhere a sentence says so."""

import json

import nibabel
import numpy as np
import pytest
import SimpleITK
import tifffile
from cases_of_the_day import nightly
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


def save_pyramid(path, samples, axes):
    """Write levels of every second sample as OME-Zarr, or as OME-TIFF with SubIFDs."""
    levels = [samples[..., :: 2**k, :: 2**k] for k in range(3)]
    if path.suffix == ".tif":
        metadata = {"axes": axes.upper(), "PhysicalSizeX": 0.25, "PhysicalSizeY": 0.25}
        with tifffile.TiffWriter(path, ome=True) as file:
            file.write(levels[0], subifds=2, metadata=metadata)
            for level in levels[1:]:
                file.write(level, subfiletype=1)
        return
    import zarr

    group = zarr.open_group(path, mode="w")
    datasets = []
    for number, level in enumerate(levels):
        group.create_array(str(number), data=level)
        scale = [1.0] * (len(axes) - 2) + [0.25 * 2**number] * 2
        datasets.append({"path": str(number), "coordinateTransformations": [{"type": "scale", "scale": scale}]})
    kinds = [{"name": "c", "type": "channel"}] * (len(axes) - 2)
    kinds += [{"name": name, "type": "space", "unit": "micrometer"} for name in "yx"]
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{"axes": kinds, "datasets": datasets}]}


# By day one format: both become the same pyramid.
@pytest.mark.parametrize("name", ["a.ome.tif", *nightly("a.ome.zarr")])
def test_a_plane_of_several_levels_is_read_at_the_one_that_the_picture_needs(tmp_path, wavesplat, name):
    y, x = np.mgrid[:96, :128]
    samples = np.where((y // 16 + x // 16) % 2, 200, 40).astype(np.uint8)
    save_pyramid(tmp_path / name, samples, "yx")
    window = ["--clim", "0,255", "-o", str(tmp_path / "o.png")]
    for options, level in (
        (["--size", "32x24"], 2),
        (["--size", "60x45"], 1),
        (["--size", "32x24", "--zoom", "4"], 0),
        (["--size", "32x24", "--level", "0"], 0),
        ([], 0),  # a small image is shown whole
    ):
        done = wavesplat("slice", tmp_path / name, *window, *options)
        assert done.returncode == 0, done.stderr
        assert (f"note: level {level} of 0..2" in done.stderr) == (level > 0)
    # The last picture: a pixel of each sample, row 0 on top.
    shown = np.asarray(Image.open(tmp_path / "o.png").convert("L")).astype(int)
    assert np.abs(shown - samples).max() <= 1


def test_channels_of_a_plane_are_shown_together_and_a_volume_is_refused(tmp_path, wavesplat):
    plane = np.random.default_rng(4).poisson(10, (2, 24, 32)).astype(np.uint8)
    plane[0, 4:10, 4:20] += 200
    plane[1, 14:20, 10:30] += 200
    save_pyramid(tmp_path / "a.ome.zarr", plane, "cyx")
    done = wavesplat("slice", tmp_path / "a.ome.zarr", "-o", tmp_path / "o.png")
    assert done.returncode == 0, done.stderr
    shown = np.asarray(Image.open(tmp_path / "o.png").convert("RGB")).astype(int)
    assert shown[7, 10, 1] > shown[7, 10, 0] + 60  # green
    assert shown[17, 20, 0] > shown[17, 20, 1] + 60  # magenta
    with pytest.raises(FileError, match="the axes are c, y, x, so the image is 2-D.*wavesplat slice` shows it"):
        ws.open(tmp_path / "a.ome.zarr", channel=0)


@pytest.mark.parametrize("options", [[], ["--memory", "100MB"]])
def test_a_plane_of_a_zarr_image_without_axes(tmp_path, wavesplat, options):
    """As early releases of bioformats2raw wrote it; `filters: []` made zarr warn each time it was read."""
    array = {"shape": [1, 2, 1, 40, 50], "chunks": [1, 1, 1, 40, 50], "fill_value": "0", "dtype": "|u1", "filters": []}
    array |= {"zarr_format": 2, "compressor": None, "order": "C", "dimension_separator": "."}
    (tmp_path / "a.zarr" / "0").mkdir(parents=True)
    (tmp_path / "a.zarr" / ".zgroup").write_text('{"zarr_format": 2}')
    multiscales = [{"datasets": [{"path": "0"}], "version": "0.1"}]
    (tmp_path / "a.zarr" / ".zattrs").write_text(json.dumps({"multiscales": multiscales}))
    (tmp_path / "a.zarr" / "0" / ".zarray").write_text(json.dumps(array))
    for channel in range(2):
        (tmp_path / "a.zarr" / "0" / f"0.{channel}.0.0.0").write_bytes((PLANE // (channel + 1)).tobytes())
    done = wavesplat("info", tmp_path / "a.zarr", *options)
    assert (done.returncode, done.stderr) == (0, "")
    assert "the first cannot be shown: the file holds a single plane of x 50, y 40, z 1 samples" in done.stdout
    window = ["--channel", "1", "--clim", "0,255", "--size", "50x40"]
    done = wavesplat("slice", tmp_path / "a.zarr", "-o", tmp_path / "o.png", *window, *options)
    assert (done.returncode, done.stderr) == (
        0,
        "wavesplat: note: a single plane: it is shown as it is, and has no thickness\n",
    )
    shown = np.asarray(Image.open(tmp_path / "o.png").convert("L")).astype(int)
    assert np.abs(shown - PLANE // 2).max() <= 1
    with pytest.raises(FileError, match=r"a single plane of x 50, y 40, z 1 samples.*`wavesplat slice` shows it"):
        ws.open(tmp_path / "a.zarr", channel=0, memory="1 MB")
