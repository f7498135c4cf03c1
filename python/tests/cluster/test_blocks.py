"""Crops and small fields of view, whose matter goes up to the faces: cut open, in greys, with a note."""

import numpy as np
import pytest

import wavesplat as ws

PATIENT = ws.Facts(unit="mm", is_anatomical=True)


def crop_of_head(share, dtype=np.int16):
    """The middle of the bundled head, a share of each side."""
    head = ws.examples.mri_head()
    inside = tuple(slice(int(n * (0.5 - share / 2)), int(n * (0.5 + share / 2))) for n in head.shape)
    return ws.Volume(head.samples[inside].astype(dtype), spacing=head.spacing, facts=PATIENT)


def notes(volume, **options):
    return str(ws.render(volume, size=(32, 32), **options).report.get("notes"))


def ends_at(volume):
    """Where the ray through the middle of a picture ends: 0 nearest to the eye, 0.5 in the volume's middle."""
    picture = ws.render(volume, size=(64, 64), depth=True)
    to_eye = np.subtract(picture.camera.position, picture.camera.focal_point)
    to_eye = np.where(abs(to_eye) > 1e-6 * abs(to_eye).max(), to_eye, 0) / np.linalg.norm(to_eye)
    lower, upper = volume.bounds
    nearest, farthest = (np.where(signs > 0, upper, lower) @ to_eye for signs in (to_eye, -to_eye))
    seen = np.asarray(picture.camera.position) @ to_eye - picture.depth[32, 32]
    return (nearest - seen) / (nearest - farthest)


@pytest.mark.parametrize("share", [0.3, 0.5])
def test_a_crop_of_a_head_shows_slices_through_its_middle(share):
    volume = crop_of_head(share)
    look = ws.Look.auto(volume)
    assert (look.part, look.shading, look.view) == ("cut open", None, "isometric")
    assert "so it is cut open" in notes(volume)
    # The corner that faces the eye is gone.
    assert ends_at(volume) == pytest.approx(0.5, abs=0.1)


def test_a_whole_head_and_asked_looks_are_not_cut():
    head = ws.examples.mri_head()
    assert ws.Look.auto(head).part is None
    assert ws.Look.auto(crop_of_head(0.5), "over").part is None
    assert "cut open" not in notes(crop_of_head(0.5), composite="maximum")


def test_a_thin_crop_is_seen_from_its_front_as_its_middle_slice():
    head = ws.examples.mri_head()
    z, y, x = (n // 2 for n in head.shape)
    thin = ws.Volume(head.samples[z - 4 : z + 5, y - 25 : y + 25, x - 25 : x + 25], facts=PATIENT)
    look = ws.Look.auto(thin)
    assert (look.part, look.view) == ("cut open", None)
    assert ends_at(thin) == pytest.approx(0.5, abs=0.15)


@pytest.mark.parametrize(("axis", "view"), [(0, "xy"), (1, "xz"), (2, "yz")])
def test_a_crop_with_distant_slices_is_seen_along_them(axis, view):
    """As the sagittal slices of a spine are: the other planes are blurred."""
    whole = crop_of_head(0.5)
    every = [slice(None)] * 3
    every[axis] = slice(None, None, 4)
    spacing = [4.0 if 2 - axis == k else 1.0 for k in range(3)]
    coarse = ws.Volume(whole.samples[tuple(every)], spacing=spacing, facts=PATIENT)
    assert (ws.Look.auto(coarse).part, ws.Look.auto(coarse).view) == ("cut open", view)
    assert ends_at(coarse) == pytest.approx(0.5, abs=0.1)


def test_it_is_the_same_in_parts(tmp_path):
    crop_of_head(0.4).save(tmp_path / "a.nii")
    volumes = [ws.open(tmp_path / "a.nii"), ws.open(tmp_path / "a.nii", memory="100 MB")]
    pictures = [ws.render(volume, size=(32, 32)) for volume in volumes]
    assert "so it is cut open" in str(pictures[0].report["notes"])
    assert pictures[0].rgba.tobytes() == pictures[1].rgba.tobytes()


def test_what_does_not_lie_in_memory_is_not_said_to_be_cut_open(tmp_path):
    crop = crop_of_head(0.4)
    crop.save(tmp_path / "a.nii")
    lazy = ws.open(tmp_path / "a.nii", memory=crop.samples.nbytes)
    assert ws.Look.auto(lazy).part == "cut open"
    for volume in (lazy, ws.WaveletVolume.from_volume(crop)):
        assert "drawn in opaque greys; it is not cut open" in notes(volume)


def test_the_look_is_kept_in_its_file():
    look = ws.Look.auto(crop_of_head(0.5))
    assert ws.Look.from_json(look.to_json()).part == "cut open"


@pytest.mark.parametrize("n", [48, 8])
def test_dense_matter_has_a_note_on_what_shows_its_inside(n):
    dense = np.random.default_rng(1).integers(100, 200, (n, 48, 48)).astype(np.uint16)
    assert ("--composite maximum" in notes(ws.Volume(dense, spacing=(25, 25, 25), unit="um"))) == (n == 48)
