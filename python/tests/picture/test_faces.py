"""A note where a face may be recognised: heads with opaque skin, seen from the front, and nothing else."""

import numpy as np
import pytest

import wavesplat as ws

SKIN = ws.TransferFunction([(20, 0.0), (40, 0.3)], [(0, 1, 0.9, 0.8)], opacity_unit=1.0)
#: Clear in skin (100) and opaque in brain (200).
BRAIN = ws.TransferFunction([(140, 0.0), (180, 0.3)], [(0, 1, 0.9, 0.8)], opacity_unit=1.0)


def head(*, face=True, skin=True, scale=1.0, modality="MR", matrix=None, anatomical=True):
    """A head of 4 mm samples: skin about a brain, on a neck, with a face before both unless it is cut off."""
    x, y, z = (4.0 * (np.arange(n) - n / 2) for n in (48, 60, 64))
    x, y, z = x[None, None, :], y[None, :, None], z[:, None, None]
    brain = (x / 68) ** 2 + (y / 85) ** 2 + ((z - 45) / 62) ** 2 < 1
    outer = (x / 78) ** 2 + (y / 98) ** 2 + ((z - 40) / 75) ** 2 < 1
    front = (x / 60) ** 2 + ((y - 35) / 68) ** 2 < 1
    below = front & (z < 40) & (z > -80) & (y > 0)
    neck = (x / 55) ** 2 + (y / 60) ** 2 < 1
    whole = outer | (neck & (z < 40)) | (below if face else np.zeros_like(below))
    if not face:
        whole = whole & ~((y > 55) & (z < 30))
    samples = np.where(brain, 200, np.where(whole, 100 if skin else 0, 0)).astype(np.int16)
    placed = np.diag([4 * scale] * 3 + [1]) if matrix is None else matrix
    facts = ws.Facts(modality=modality, is_anatomical=anatomical, unit="mm")
    return ws.Volume(samples, world_from_index=placed, facts=facts)


def notes(volume, look=SKIN, view="anterior", clip=(), **options):
    picture = ws.Scene(volume, look, clip=clip).render(view, size=(16, 16), **options)
    return [note for note in picture.report.get("notes", []) if "face" in note]


def test_a_head_with_its_skin_has_a_note():
    (note,) = notes(head())
    assert "pydeface, mri_deface" in note
    assert "--cut-out" in note
    for view in ("left", "superior", "anterior"):
        assert notes(head(), view=view)
    mr = head()
    facts = ws.Facts(modality="CT", is_anatomical=True, unit="mm")
    ct = ws.Volume(10 * mr.samples - 1000, world_from_index=mr.world_from_index, facts=facts)
    assert notes(ct, "ct-skin")
    assert notes(ct, "ct-bone") == []
    assert notes(head(), composite=ws.FirstHit(50))


@pytest.mark.parametrize(
    ("volume", "options"),
    [
        (head(face=False), {}),
        (head(skin=False), {}),
        (head(), {"look": BRAIN}),
        (head(), {"view": "posterior"}),
        (head(), {"composite": "maximum"}),
        (head(), {"quality": "draft"}),
        (head(modality="PT"), {}),
        (head(anatomical=False), {}),
        (head(scale=0.3), {}),  # an animal's
        (head(scale=2.0), {}),  # a body
    ],
    ids=["defaced", "brain", "clear skin", "from behind", "maximum", "draft", "PET", "no patient", "mouse", "body"],
)
def test_without_a_face_there_is_none(volume, options):
    assert notes(volume, **options) == []


def stripped_brain(scale=1.0):
    """A brain as large as in MNI's space, 140 x 176 x 148 mm, with its cerebellum and stem, and nothing around it."""
    x, y, z = (4.0 * (np.arange(n) - n / 2) / scale for n in (46, 54, 46))
    x, y, z = x[None, None, :], y[None, :, None], z[:, None, None]
    cerebrum = ((x / 70) ** 2 + (y / 88) ** 2 + ((z - 20) / 62) ** 2 < 1) & (z > -30 - 0.2 * y)
    cerebellum = (x / 50) ** 2 + ((y + 50) / 32) ** 2 + ((z + 40) / 25) ** 2 < 1
    stem = ((x / 14) ** 2 + ((y + 18) / 14) ** 2 < 1) & (z < 0) & (z > -72)
    samples = np.where(cerebrum | cerebellum | stem, 200, 0).astype(np.int16)
    facts = ws.Facts(modality="MR", is_anatomical=True, unit="mm")
    return ws.Volume(samples, world_from_index=np.diag([4.0, 4, 4, 1]), facts=facts)


def lungs():
    """Two lungs beside the middle, as large across as a head."""
    x, y, z = (4.0 * (np.arange(n) - n / 2) for n in (70, 54, 64))
    x, y, z = x[None, None, :], y[None, :, None], z[:, None, None]
    pair = [((x - at) / 55) ** 2 + (y / 88) ** 2 + ((z + 20) / 110) ** 2 < 1 for at in (-62, 62)]
    facts = ws.Facts(is_anatomical=True, unit="mm")
    return ws.Volume((pair[0] | pair[1]).astype(np.uint8), world_from_index=np.diag([4.0, 4, 4, 1]), facts=facts)


@pytest.mark.parametrize("volume", [stripped_brain(), stripped_brain(1.1), lungs()], ids=["brain", "large", "lungs"])
def test_brains_without_a_head_and_lungs_have_no_face(volume):
    """The note was on six of seven brains without skulls, on a map of grey matter and on a mask of lungs."""
    assert notes(volume, None) == []
    assert notes(volume) == []


def pelvis(width, *, is_cut):
    """An ellipse of tissue along z, in a field of view of 240 mm, or of 320 with its front."""
    n = 60 if is_cut else 80
    across = 4.0 * (np.arange(n) - n / 2)
    y, x = across[None, :, None], across[None, None, :]
    samples = np.where(np.broadcast_to((x / (width / 2)) ** 2 + (y / 115) ** 2 < 1, (54, n, n)), 40, -1000)
    facts = ws.Facts(modality="CT", is_anatomical=True, unit="mm")
    front = samples[:, : n - 10] if is_cut else samples
    return ws.Volume(front.astype(np.int16), world_from_index=np.diag([4.0, 4, 4, 1]), facts=facts)


def test_a_pelvis_drawn_with_its_skin_has_none():
    assert notes(pelvis(300, is_cut=False), "ct-skin") == []
    assert notes(pelvis(230, is_cut=True), "ct-skin") == []
    # As wide as a head, with its front in view: it errs towards a note.
    assert notes(pelvis(180, is_cut=False), "ct-skin")


@pytest.mark.parametrize("walls", [(8, 8), (0, 12), (12, 0)])
def test_a_head_that_its_field_of_view_cuts_keeps_its_note(walls):
    """Ears, the tip of the nose, or the vertex outside of the scan."""
    whole = head()
    cut = whole.samples[: 64 - walls[1], : 60 - walls[0] // 4, walls[0] // 2 : 48 - walls[0] // 2]
    assert notes(ws.Volume(cut, world_from_index=whole.world_from_index, facts=whole.facts))


def test_the_head_that_comes_with_the_package_has_the_note():
    assert notes(ws.examples.mri_head(), None)


def test_the_axes_of_the_file_do_not_matter():
    straight = head()
    lps = np.diag([-4.0, -4, 4, 1])
    turned = ws.Volume(straight.samples[:, ::-1, ::-1], world_from_index=lps, facts=straight.facts)
    assert notes(turned)
    sagittal = np.zeros((4, 4))
    sagittal[1, 0] = sagittal[2, 1] = sagittal[0, 2] = 4.0
    sagittal[3, 3] = 1
    exchanged = ws.Volume(straight.samples.transpose(2, 0, 1), world_from_index=sagittal, facts=straight.facts)
    assert notes(exchanged)


def test_clips_that_take_the_face_away_take_the_note_away():
    volume = head()
    front = volume.world_from_index[:3, 3] + 4 * np.array([24, 38, 32])
    assert notes(volume, clip=ws.ClipPlane(tuple(front), (0, -1, 0))) == []
    box = ws.Crop((0, 120, 0), (1000, 1000, 1000))
    assert notes(volume, clip=ws.CutOut(box)) == []
    assert notes(volume, clip=ws.Crop((0, 0, 0), (1000, 110, 1000))) == []
    assert notes(volume, clip=ws.Crop((0, 0, 0), (48, 26, 64), space="index")) == []
    # What is cut off elsewhere leaves the face.
    assert notes(volume, clip=ws.ClipPlane((0, 60, 0), (0, 1, 0)))


def test_changed_curves_are_looked_at_again():
    volume = head()
    scene = ws.Scene(volume, SKIN)
    others = scene.with_(layers=[ws.Layer(volume, BRAIN)])
    told = [str(one.render("anterior", size=(16, 16)).report.get("notes")) for one in (scene, others, scene)]
    assert ["face" in notes for notes in told] == [True, False, True]
