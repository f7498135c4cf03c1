"""The first view of simulations: three-quarter, from above, whatever a header says of a patient (simulation, 8.12)."""

import gzip

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._model.camera.views import VIEWS
from wavesplat._render.framing import natural_view

N = 32
Z, Y, X = np.indices((N, N, N)) / (N / 2) - 1
FIELD = np.exp(-4 * (X * X + Y * Y + Z * Z)).astype(np.float32)
SIGNED = (np.sin(4 * X) * np.cos(3 * Y) * np.cos(Z)).astype(np.float32)
BLOCK = np.abs(np.random.default_rng(2).normal(0, 5, (N, N, N)))
BLOCK[6:26, 4:28, 3:29] += 150
NOISE = np.random.default_rng(4).normal(0, 0.5, (N, N, N)).astype(np.float32)
TYPES = {"uint8": "unsigned char", "int16": "short", "float32": "float"}


def nrrd(path, samples, directions="(1,0,0) (0,1,0) (0,0,1)", origin="(0,0,0)", extra=""):
    sizes = " ".join(map(str, samples.shape[::-1]))
    header = (
        f"NRRD0004\ntype: {TYPES[samples.dtype.name]}\ndimension: 3\nspace: left-posterior-superior\nsizes: {sizes}\n"
        f"space directions: {directions}\nkinds: domain domain domain\nendian: little\nencoding: gzip\n"
        f"space origin: {origin}\n{extra}\n"
    )
    path.write_bytes(header.encode() + gzip.compress(samples.tobytes()))
    return ws.open(path)


@pytest.mark.parametrize("samples", [FIELD, SIGNED, np.round(255 * FIELD).astype(np.uint8), BLOCK.astype(np.uint8)])
def test_a_space_of_nrrd_alone_is_no_patient(tmp_path, samples):
    volume = nrrd(tmp_path / "a.nrrd", samples)
    assert volume.is_anatomical
    assert natural_view(volume) == VIEWS["isometric"]
    assert any("as by default" in told for told in volume.facts.conventions)


@pytest.mark.parametrize("noisy", [FIELD + np.abs(NOISE), SIGNED + NOISE, np.abs(NOISE)])
def test_noise_does_not_make_a_patient_of_a_header_without_a_place(tmp_path, noisy):
    """The vorticity of a simulation, as programs that know ITK write it; whole numbers may be of a head."""
    import SimpleITK

    image = SimpleITK.GetImageFromArray(noisy)
    SimpleITK.WriteImage(image, tmp_path / "a.mha")
    SimpleITK.WriteImage(image, tmp_path / "b.nrrd")
    volumes = [nrrd(tmp_path / "a.nrrd", noisy), ws.open(tmp_path / "a.mha"), ws.open(tmp_path / "b.nrrd")]
    for volume in (*volumes, ws.Volume(image)):
        assert volume.is_anatomical
        assert natural_view(volume) == VIEWS["isometric"]
        assert kind_of(volume) in ("field", "signed field")
    image.SetOrigin((-90.5, -126, -72))
    assert natural_view(ws.Volume(image)) == VIEWS["anterior"]
    hounsfield = np.where(FIELD > 0.3, 40.0, -1000.0) + 20 * NOISE  # air around soft tissue, in fractions
    assert natural_view(nrrd(tmp_path / "ct.nrrd", hounsfield.astype(np.float32))) == VIEWS["anterior"]


def test_scans_of_patients_are_seen_from_the_front(tmp_path):
    head = (100 * (FIELD > 0.3) + np.abs(np.random.default_rng(1).normal(0, 9, FIELD.shape))).astype(np.int16)
    bytes_of_head = head.astype(np.uint8)
    placed = {"origin": "(-90.5,-126,-72)"}
    assert natural_view(nrrd(tmp_path / "mr.nrrd", head)) == VIEWS["anterior"]
    assert natural_view(nrrd(tmp_path / "placed.nrrd", bytes_of_head, **placed)) == VIEWS["anterior"]
    said = nrrd(tmp_path / "said.nrrd", bytes_of_head, extra="modality:=MR\n")
    assert natural_view(said) == VIEWS["anterior"]
    finer = nrrd(tmp_path / "finer.nrrd", bytes_of_head, directions="(0.9,0,0) (0,0.9,0) (0,0,1.2)")
    assert natural_view(finer) == VIEWS["anterior"]
    assert natural_view(ws.Volume(bytes_of_head, anatomical=True)) == VIEWS["anterior"]
    # A statistic in the space of a template.
    template = np.diag([2.0, 2.0, 2.0, 1.0])
    template[:3, 3] = -90, -126, -72
    statistic = ws.Volume(SIGNED, world_from_index=template, anatomical=True, unit="mm")
    assert natural_view(statistic) == VIEWS["anterior"]
    noise = np.random.default_rng(4).normal(0, 3, SIGNED.shape).astype(np.float32)
    assert natural_view(ws.Volume(noise, anatomical=True, unit="mm")) == VIEWS["anterior"]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_flat_fields_turn_their_broad_face_to_the_eye(axis):
    shape = [60, 60, 60]
    shape[axis] = 24
    k, j, i = np.meshgrid(*[np.linspace(-1, 1, n) for n in shape], indexing="ij")
    vortices = (np.sin(9 * i) * np.cos(8 * j) * np.sin(7 * k + 0.5)).astype(np.float32)
    picture = ws.render(ws.Volume(vortices, anatomical=True, unit="mm"), size=(96, 96))
    # Edge on a field of this shape fills 35 % of the picture at most.
    assert (picture.rgba[..., 3] > 0.02).mean() > 0.4


@pytest.mark.parametrize(("axis", "right", "up"), [(0, 1, 2), (1, 0, 2), (2, 0, 1)])
def test_thin_fields_are_seen_as_plots_are(axis, right, up):
    """Axes of the world to the right and up; only rows of images grow downwards."""
    shape = [60, 60, 60]
    shape[2 - axis] = 12
    k, j, i = np.meshgrid(*[np.linspace(-1, 1, n) for n in shape], indexing="ij")
    wave = (np.sin(9 * i) * np.cos(8 * j) * np.sin(7 * k + 0.5)).astype(np.float32)
    camera = ws.render(ws.Volume(wave), size=(48, 48)).camera
    points = np.tile(np.array(camera.focal_point), (3, 1))
    points[1, right] += 5
    points[2, up] += 5
    (middle, along, above), _ = camera.project(points, size=(48, 48))
    assert along[0] > middle[0] + 1
    assert abs(along[1] - middle[1]) < 0.5
    assert above[1] < middle[1] - 1
    scan = ws.Volume(np.random.default_rng(0).integers(0, 255, shape).astype(np.uint8))
    assert natural_view(scan) == VIEWS[("yz", "xz", "xy")[axis]]


@pytest.mark.parametrize(("air", "deviation"), [(18, 3), (40, 6), (60, 8)])
def test_air_that_was_reconstructed_around_a_thing_is_no_wall(air, deviation):
    """The box of a reconstruction was brown, or a blue drum, where what is outside of it has one value."""
    rng = np.random.default_rng(3)
    samples = np.clip(air + rng.normal(0, deviation, (64, 64, 64)), 0, 255)
    k, j, i = np.indices(samples.shape) - 31.5
    distance = np.hypot(k, np.hypot(j, i))
    samples[(distance < 16) & (distance > 14)] = 150
    samples[(np.hypot(j, i) > 28) | (np.abs(k) > 28)] = 0
    volume = ws.Volume(samples.astype(np.uint8))
    alpha = ws.render(volume, size=(96, 96)).rgba[..., 3]
    # The ball fills the picture, nine tenths of its height, and nothing is around it.
    rows = np.flatnonzero((alpha > 0.3).any(axis=1))
    assert np.ptp(rows) > 0.8 * 96
    around = np.hypot(*(np.indices(alpha.shape) - 47.5)) > 0.5 * 96
    assert alpha[around].max() < 0.05
