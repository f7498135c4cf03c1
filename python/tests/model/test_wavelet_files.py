"""Files of wavelet coefficients: saved ones are read back the same, and damaged ones are refused."""

from __future__ import annotations

import contextlib
import errno

import numpy as np
import pytest

import wavesplat as ws
from wavesplat import _native

FAMILIES = _native.WaveletVolume.families()


@pytest.fixture
def coefficients(oblique):
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index, name="a µ-CT")
    return ws.WaveletVolume.from_volume(volume, keep=0.5)


@pytest.mark.parametrize("family", FAMILIES)
def test_what_is_saved_comes_back(tmp_path, family, oblique):
    path = tmp_path / "head.wavelets"
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index, name="a µ-CT")
    wavelets = ws.WaveletVolume.from_volume(volume, family, keep=0.5).bands([0.5, 1.5])
    wavelets.save(path)
    assert [file.name for file in tmp_path.iterdir()] == [path.name], "nothing else is left"
    again = ws.WaveletVolume.load(path)
    assert repr(again) == repr(wavelets)
    assert (again.kept_by_level, again.nbytes, again.threshold) == (
        wavelets.kept_by_level,
        wavelets.nbytes,
        wavelets.threshold,
    )
    assert np.array_equal(again.world_from_index, wavelets.world_from_index)
    transfer_function = ws.TransferFunction(
        [(-1000, 0.0), (3000, 0.5)], [(-1000, 0.2, 0.4, 1.0), (3000, 1.0, 0.5, 0.1)]
    )
    for left_out in (0, 1):
        draw = {"look": transfer_function, "size": (24, 20)}
        picture = ws.render(wavelets.level(left_out), **draw).rgba
        assert picture[..., 3].max() > 0.5
        assert ws.render(again.level(left_out), **draw).rgba.tobytes() == picture.tobytes()
    again.save(tmp_path / "again.wavelets")
    assert ws.WaveletVolume.load(tmp_path / "again.wavelets").to_volume().samples.tobytes() == (
        wavelets.to_volume().samples.tobytes()
    )


def test_the_range_is_kept_and_files_without_it_are_read(tmp_path, coefficients):
    """The range is that of decoding; an invalid range counts as damage."""
    path = tmp_path / "head.wavelets"
    coefficients.save(path)
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    samples = coefficients.to_volume().samples
    assert arrays["value_range"].tolist() == [samples.min(), samples.max()]

    def load(**changed):
        with path.open("wb") as file:
            np.savez_compressed(
                file, **{name: array for name, array in (arrays | changed).items() if array is not None}
            )
        return ws.WaveletVolume.load(path)

    assert load(value_range=None).value_range == coefficients.value_range == (samples.min(), samples.max())
    # The range in the file is trusted, so nothing is decoded for it.
    assert load(value_range=np.array([-7.0, 5000.0], np.float32)).value_range == (-7, 5000)
    for damaged in ([3.0, 1.0], [0.0, np.inf], [np.nan, 1.0], [1.0]):
        with pytest.raises(ws.errors.FileError):
            load(value_range=np.array(damaged, np.float32))


def test_a_wavelet_volume_without_coefficients_is_kept(tmp_path):
    ws.WaveletVolume.from_volume(ws.examples.ripples(8), keep=0).save(tmp_path / "empty.wavelets")
    assert ws.WaveletVolume.load(tmp_path / "empty.wavelets").kept_fraction == 0


def test_other_names_are_refused(tmp_path, coefficients):
    with pytest.raises(ws.errors.FileError, match=r"coefficients as \.npz; use one of: \.wavelets: .*head\.npz"):
        coefficients.save(tmp_path / "head.npz")
    with pytest.raises(ws.errors.FileError, match="the folder does not exist"):
        coefficients.save(tmp_path / "none" / "head.wavelets")
    assert not list(tmp_path.iterdir())


def test_suffixes_may_be_in_capitals(wavesplat, tmp_path, coefficients):
    coefficients.save(tmp_path / "HEAD.WAVELETS")
    assert wavesplat("info", tmp_path / "HEAD.WAVELETS").returncode == 0
    with pytest.raises(ws.errors.ArgumentError, match="a file of wavelet coefficients"):
        ws.open(tmp_path / "HEAD.WAVELETS")


def test_a_write_that_fails_leaves_what_was_there(tmp_path, coefficients, monkeypatch):
    path = tmp_path / "head.wavelets"
    coefficients.save(path)
    before = path.read_bytes()

    def half(file, **arrays):
        file.write(before[:100])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", half)
    with pytest.raises(ws.errors.FileError, match="No space left on device"):
        coefficients.save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def write_text(path):
    path.write_text("not coefficients", encoding="utf-8")


def write_array(path):
    with path.open("wb") as file:
        np.save(file, np.zeros((3, 3)))


def write_archive(path):
    with path.open("wb") as file:
        np.savez(file, samples=np.zeros((3, 3)))


def write_pickle(path):
    with path.open("wb") as file:
        np.savez(file, format=np.array([{}], object))


@pytest.mark.parametrize("write", [write_text, write_array, write_archive, write_pickle])
def test_other_files_are_no_coefficients(tmp_path, write):
    path = tmp_path / "other.wavelets"
    write(path)
    with pytest.raises(ws.errors.FileError, match="cannot read as wavelet coefficients"):
        ws.WaveletVolume.load(path)


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(ws.errors.FileError, match="no such file"):
        ws.WaveletVolume.load(tmp_path / "none.wavelets")
    with pytest.raises(ws.errors.FileError, match="directory"):
        ws.WaveletVolume.load(tmp_path)
    (tmp_path / "empty.wavelets").touch()
    with pytest.raises(ws.errors.FileError, match="empty"):
        ws.WaveletVolume.load(tmp_path / "empty.wavelets")


NAN_AFFINE = np.eye(4)
NAN_AFFINE[0, 0] = np.nan


@pytest.mark.parametrize(
    ("name", "wrong", "message"),
    [
        (
            "format",
            np.array(["wavesplat wavelets", "3", "cdf97", "x"]),
            "version 3; this program reads .* version 1 and 2",
        ),
        ("format", np.array(["other", "1", "cdf97", "x"]), "this is 'other'"),
        ("format", np.array(["wavesplat wavelets", "1", "db4", "x"]), "no such family"),
        ("format", np.array("x"), "damaged"),
        ("shape", np.array([1 << 62, 1, 1]), "has_block has 22 entries"),
        ("shape", np.array([1 << 40, 1, 1]), "has_block has 22 entries"),
        ("shape", np.array([1 << 30, 1 << 30, 1 << 30]), "of a volume; pass at least 1"),
        ("shape", np.array([-5, 6, 7]), "damaged"),
        ("shape", np.array([5.0, np.nan, 7.0]), "damaged"),
        ("levels_and_threshold", np.array([99.0, 1.0]), "99 levels are more than"),
        ("levels_and_threshold", np.array([np.nan, 1.0]), "damaged"),
        ("weights", np.ones(50), "weights of bands"),
        ("weights", np.array([np.inf]), "weights of bands"),
        ("weights", np.array(["a"]), "weights of bands"),
        ("world_from_index", np.eye(3), r"shape \(3, 3\)"),
        ("world_from_index", np.zeros((4, 4)), "last row"),
        ("world_from_index", np.diag([1.0, 0.0, 1.0, 1.0]), "spacing of 0"),
        ("world_from_index", NAN_AFFINE, "not finite"),
        ("n_blocks", np.array([1 << 45]), "bits for"),
        ("n_blocks", np.array([-5]), "bits for"),
        ("n_blocks", np.array([], int), "damaged"),
        ("has_block", np.zeros(3), "damaged"),
        ("masks", np.zeros(3), "damaged"),
        ("masks", np.zeros(0, np.uint64), "masks has 0 entries"),
        ("values", np.zeros(3, ">f4"), "damaged"),
        ("values", np.zeros(3, np.float32), "values has 3 entries"),
        ("values", np.full(500, np.nan, np.float32), "not a finite number"),
        ("masks", None, "masks"),
    ],
)
def test_what_does_not_fit_together_is_refused(tmp_path, coefficients, name, wrong, message):
    path = tmp_path / "head.wavelets"
    coefficients.save(path)
    with np.load(path) as archive:
        arrays = dict(archive)
    if wrong is None:
        del arrays[name]
    else:
        arrays[name] = wrong
    with path.open("wb") as file:
        np.savez(file, **arrays)
    with pytest.raises(ws.errors.FileError, match=message):
        ws.WaveletVolume.load(path)


def test_damage_anywhere_is_a_file_error(tmp_path, coefficients):
    """Damage goes unnoticed only in bytes that nobody reads, such as the date in the archive."""
    path = tmp_path / "head.wavelets"
    coefficients.save(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(3)

    def load(contents: bytes) -> bool:
        path.write_bytes(contents)
        with contextlib.suppress(ws.errors.FileError):
            ws.WaveletVolume.load(path)
            return True
        return False

    assert load(whole)
    assert not any(load(whole[:n]) for n in range(0, len(whole), 37))
    n_unnoticed = 0
    for _ in range(500):
        damaged = bytearray(whole)
        damaged[rng.integers(len(whole))] ^= int(rng.integers(1, 256))
        n_unnoticed += load(bytes(damaged))
    assert n_unnoticed < 250


def flip_bit(parts, rng):
    place = rng.integers(max(1, parts["masks"].size))
    parts["masks"][place:][:1] ^= np.uint64(1 << int(rng.integers(64)))


def toggle_block(parts, rng):
    parts["has_block"][rng.integers(parts["has_block"].size)] ^= 1


def spoil_value(parts, rng):
    parts["values"][rng.integers(max(1, parts["values"].size)) :][:1] = rng.choice([np.nan, np.inf, 3e38, 0.0])


def cut(parts, rng):
    name = rng.choice(["has_block", "masks", "values"])
    parts[name] = parts[name][: rng.integers(parts[name].size + 1)]


def lie_of_size(parts, rng):
    parts["shape"], parts["levels"] = tuple(rng.integers(0, 30, 3).tolist()), int(rng.integers(8))


@pytest.mark.parametrize("damage", [flip_bit, toggle_block, spoil_value, cut, lie_of_size])
def test_parts_at_random_are_drawn_or_refused(damage, is_night):
    rng = np.random.default_rng(5)
    curve = ws.TransferFunction([(0, 0.0), (10, 1.0)], [(0, 1.0, 1.0, 1.0)])
    n_refused = 0
    for n in range(70 if is_night else 21):
        shape, family = tuple(rng.integers(2, 30, 3).tolist()), FAMILIES[n % len(FAMILIES)]
        volume = ws.Volume(rng.normal(0, 10, shape).astype(np.float32))
        wavelets = ws.WaveletVolume.from_volume(volume, family, keep=rng.uniform(0, 0.5))
        parts = dict(zip(("has_block", "masks", "values", "value_range"), wavelets._core.parts(), strict=True))
        parts |= {"shape": shape, "family": family, "levels": wavelets.n_levels, "threshold": 1.0, "offset": 0.0}
        damage(parts, rng)
        try:
            drawn = ws.WaveletVolume(_native.WaveletVolume.from_parts(**parts), "parts", np.eye(4), family)
            for left_out in (0, drawn.n_levels):
                assert np.isfinite(ws.render(drawn.level(left_out), curve, size=(8, 8)).rgba).all()
        except ValueError:
            # A FileError is for parts that do not fit; an ArgumentError for samples that overflow, or fill no space.
            n_refused += 1
    assert n_refused > 0
