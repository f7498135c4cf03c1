"""Movies: the files, the files left when something fails, and resuming from frames that are there."""

import inspect
import sys
from io import BytesIO

import numpy as np
import pytest
from test_bad_arguments import BAD, said

import wavesplat as ws
from wavesplat._movie import encoding, movie, png_sequence
from wavesplat._render.options import DrawOptions
from wavesplat.errors import ArgumentError, CancelledError, FileError, LibraryError

av = pytest.importorskip("av")
images = pytest.importorskip("PIL.Image")

VOLUME = ws.examples.ripples(12)
LOOK = ws.TransferFunction.auto(VOLUME)
SIZE = (48, 32)
DRAW = {"look": LOOK, "size": SIZE, "fps": 10}
TURN = ws.Turn(frames=5)


def frames_of(path):
    """Pictures of a video, its stream, and its duration in seconds."""
    with av.open(str(path)) as file:
        stream = file.streams.video[0]
        return [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)], stream, file.duration / 1e6


def expected_frames(turn=TURN, size=SIZE, **options):
    scene = ws.Scene(VOLUME, LOOK, background="black")
    aspect = size[0] / size[1]
    from wavesplat._movie.turn import cameras_of

    cameras = cameras_of(turn, scene, None, aspect)
    return [np.asarray(scene.render(camera, size=size, **options))[..., :3] for camera in cameras]


@pytest.mark.parametrize(("suffix", "codec"), [(".mp4", "h264"), (".webm", "vp9")])
def test_videos(tmp_path, suffix, codec):
    path = tmp_path / f"turn{suffix}"
    assert ws.movie(VOLUME, path, TURN, crf=4, **DRAW) == path
    pictures, stream, duration = frames_of(path)
    assert stream.codec_context.codec.canonical_name == codec
    assert (stream.codec_context.pix_fmt, stream.average_rate) == ("yuv420p", 10)
    assert (stream.codec_context.colorspace, stream.codec_context.color_range) == (1, 1)
    assert duration == pytest.approx(0.5, abs=0.05)
    expected = expected_frames()
    assert len(pictures) == len(expected)
    for got, want in zip(pictures, expected, strict=True):
        # Most of the difference comes from the halved resolution of colours.
        assert np.abs(got.astype(float) - want).mean() < 6
        np.testing.assert_allclose(got.mean(axis=(0, 1)), want.mean(axis=(0, 1)), atol=2)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_odd_sides_get_one_more_pixel(tmp_path, suffix):
    path = ws.movie(VOLUME, tmp_path / f"odd{suffix}", ws.Turn(frames=2), LOOK, size=(33, 31), fps=10, crf=4)
    pictures, _, _ = frames_of(path)
    assert pictures[0].shape == (32, 34, 3)
    assert np.abs(pictures[0][:, 33].astype(float) - pictures[0][:, 32]).mean() < 6


@pytest.mark.parametrize(("suffix", "fps", "total_ms"), [(".gif", 30, 170), (".webp", 30, 167), (".gif", 10, 500)])
def test_animations_keep_their_time(tmp_path, suffix, fps, total_ms):
    path = ws.movie(VOLUME, tmp_path / f"turn{suffix}", TURN, LOOK, size=SIZE, fps=fps)
    with images.open(path) as file:
        assert file.n_frames == 5
        assert file.info["loop"] == 0
        assert file.size == SIZE
        times = []
        for number, want in enumerate(expected_frames()):
            file.seek(number)
            got = np.asarray(file.convert("RGB"))
            times.append(file.info["duration"])
            assert np.abs(got.astype(float) - want).mean() < 8
    assert sum(times) == total_ms


def test_single_frames_are_the_renders_to_the_byte(tmp_path):
    pattern = ws.movie(VOLUME, tmp_path / "frames", TURN, quality="normal", **DRAW)
    assert pattern == tmp_path / "frames" / "%04d.png"
    names = sorted(path.name for path in pattern.parent.iterdir())
    assert names == ["0000.png", "0001.png", "0002.png", "0003.png", "0004.png"]
    for name, want in zip(names, expected_frames(), strict=True):
        np.testing.assert_array_equal(np.asarray(images.open(pattern.parent / name))[..., :3], want)
    named = ws.movie(VOLUME, tmp_path / "turn_%d.png", ws.Turn(frames=2), **DRAW)
    assert named.name == "turn_%d.png"
    assert (tmp_path / "turn_1.png").exists()


def test_resume_draws_what_is_missing_damaged_or_another_picture(tmp_path):
    folder = tmp_path / "frames"
    ws.movie(VOLUME, folder, TURN, **DRAW)
    first = {path.name: path.read_bytes() for path in folder.iterdir()}
    (folder / "0001.png").unlink()
    (folder / "0003.png").write_bytes(first["0003.png"][:-40])
    (folder / "0004.png").write_bytes(BytesIO(first["0000.png"]).getvalue())
    ages = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    drawn = []
    ws.movie(VOLUME, folder, TURN, resume=True, progress=drawn.append, **DRAW)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == first
    kept = [name for name, age in ages.items() if (folder / name).stat().st_mtime_ns == age]
    assert sorted(kept) == ["0000.png", "0002.png"]
    assert drawn[-1] == 1
    # No frame of another scene is kept.
    ws.movie(VOLUME, folder, TURN, resume=True, **DRAW | {"look": "grey"})
    assert all(path.read_bytes() != first[path.name] for path in folder.iterdir())


@pytest.mark.parametrize(
    "change",
    [
        {"size": (32, 48)},
        {"look": "grey"},
        {"quality": "draft"},
        {"background": "white"},
        {"along": ws.Turn(frames=2, elevation=1)},
        {"what": ws.Volume(VOLUME.samples, spacing=(1, 1, 2))},
        {"what": ws.Volume(VOLUME.samples + np.uint8(1))},
        {"what": ws.Scene(VOLUME, LOOK, clip=ws.ClipPlane((0, 0, 5), (0, 0, 1))), "look": None},
    ],
)
def test_frames_are_kept_only_if_everything_is_the_same(tmp_path, change):
    given = {"what": VOLUME, "along": ws.Turn(frames=2), **DRAW}
    pattern = ws.movie(path=tmp_path / "frames", **given)
    path = png_sequence.frame_path(pattern, 0)
    age = path.stat().st_mtime_ns
    ws.movie(path=tmp_path / "frames", resume=True, **given)
    assert path.stat().st_mtime_ns == age
    ws.movie(path=tmp_path / "frames", resume=True, **given | change)
    assert path.stat().st_mtime_ns != age


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".gif", ".webp"])
@pytest.mark.parametrize("at", [0.0, 0.5])
@pytest.mark.every_pair
def test_a_stopped_movie_leaves_what_was_there(tmp_path, suffix, at):
    path = tmp_path / f"turn{suffix}"
    path.write_bytes(b"before")
    with pytest.raises(CancelledError):
        ws.movie(VOLUME, path, TURN, progress=lambda done: done < at, **DRAW)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_stopped_single_frames_stay(tmp_path):
    with pytest.raises(CancelledError):
        ws.movie(VOLUME, tmp_path / "frames", TURN, progress=lambda done: done < 0.5, **DRAW)
    left = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "frames").iterdir()}
    assert {"0000.png"} <= left.keys() <= {"0000.png", "0001.png", "0002.png"}
    steps = []
    ws.movie(VOLUME, tmp_path / "frames", TURN, resume=True, progress=steps.append, **DRAW)
    assert len(list((tmp_path / "frames").iterdir())) == 5
    assert all((tmp_path / "frames" / name).stat().st_mtime_ns == age for name, age in left.items())
    assert steps == sorted(steps)
    assert steps[-1] == 1


def test_an_encoder_that_fails_stops_the_drawing(tmp_path, monkeypatch):
    def fails(path, frames, n, **options):
        next(frames)
        path.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(encoding, "encode", fails)
    drawn = []
    with pytest.raises(FileError, match="No space left"):
        ws.movie(VOLUME, tmp_path / "turn.mp4", ws.Turn(frames=200), progress=drawn.append, **DRAW)
    assert max(drawn) < 0.2
    assert list(tmp_path.iterdir()) == []


def test_a_renderer_that_fails_stops_the_encoder(tmp_path):
    import threading

    def fails(done):
        if done > 0.3:
            raise RuntimeError("mine")
        return True

    with pytest.raises(RuntimeError, match="mine"):
        ws.movie(VOLUME, tmp_path / "turn.mp4", TURN, progress=fails, **DRAW)
    assert list(tmp_path.iterdir()) == []
    assert [thread.name for thread in threading.enumerate() if "movie" in thread.name] == []


@pytest.mark.parametrize(("name", "module"), [("turn.mp4", "av"), ("turn.webm", "av"), ("turn.gif", "PIL.Image")])
def test_a_missing_library_is_named_with_the_extra(tmp_path, monkeypatch, name, module):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(LibraryError, match=r'is not installed.*pip install "wavesplat\[movie\]"'):
        ws.movie(VOLUME, tmp_path / name, TURN, **DRAW)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "options", "error", "message"),
    [
        ("turn.avi", {}, FileError, "cannot write movies as .avi; use one of: .mp4, .webm, .gif, .webp"),
        ("turn.png", {}, FileError, "a PNG file is one frame; number them"),
        ("none/turn.mp4", {}, FileError, "folder does not exist"),
        ("none/there/%04d.png", {}, FileError, "folder does not exist"),
        ("turn.mp4", {"resume": True}, ArgumentError, "resume keeps frames"),
        ("turn.mp4", {"fps": 0}, ArgumentError, "fps is 0"),
        ("turn.mp4", {"fps": float("nan")}, ArgumentError, "fps is nan"),
        ("turn.gif", {"fps": 60}, ArgumentError, "fps is 60; a .gif file shows .* at most 50"),
        ("turn.mp4", {"crf": 60}, ArgumentError, "crf is 60; a .mp4 file has 0 to 51"),
        ("turn.gif", {"crf": 6}, ArgumentError, "crf is for videos"),
        ("turn.mp4", {"size": (0, 5)}, ArgumentError, "size is 0 x 5"),
        ("turn.mp4", {"along": []}, ArgumentError, "give a wavesplat.Turn"),
        ("turn.mp4", {"along": 3}, ArgumentError, "along is 3; give a wavesplat.Turn"),
        (
            "turn.mp4",
            {"along": [ws.KeyFrame(0), ws.Camera.view(VOLUME, "left")]},
            ArgumentError,
            "give a wavesplat.Turn",
        ),
    ],
)
def test_what_cannot_be(tmp_path, name, options, error, message):
    with pytest.raises(error, match=message):
        ws.movie(VOLUME, tmp_path / name, **{"along": TURN} | DRAW | options)
    assert list(tmp_path.iterdir()) == []


def test_a_movie_along_cameras_has_a_frame_of_each(tmp_path):
    keys = [ws.Camera.orbit(VOLUME, angle) for angle in (0, 90)]
    pattern = ws.movie(VOLUME, tmp_path / "way", ws.Camera.interpolate(keys, 3), quality="high", **DRAW)
    assert len(list(pattern.parent.iterdir())) == 3
    want = ws.render(VOLUME, LOOK, keys[1], size=SIZE, quality="high", background="black")
    got = np.asarray(images.open(png_sequence.frame_path(pattern, 2)))
    np.testing.assert_array_equal(got, np.asarray(want))


def test_transparent_frames_stay_so(tmp_path):
    pattern = ws.movie(VOLUME, tmp_path / "clear", ws.Turn(frames=1), background="transparent", **DRAW)
    assert np.asarray(images.open(png_sequence.frame_path(pattern, 0)))[..., 3].min() < 255


@pytest.mark.parametrize("composite", ["over", "maximum", "mean"])
def test_what_is_chosen_by_the_data_is_chosen_once(tmp_path, composite):
    """A cube that turns: greys of a projection would follow the view."""
    samples = np.zeros((16, 16, 16), np.float32)
    samples[4:12, 4:12, 6:10] = np.linspace(100, 200, 4)
    cube = ws.Volume(samples)
    scene = ws.Scene(cube, background="black")
    shots = movie._shots(scene, ws.Turn(frames=4), 30, DrawOptions(composite=composite, size=(32, 32)))
    looks = {id(shots[k].scene.layers[0].look) for k in range(4)}
    assert len(looks) == 1
    assert isinstance(shots[0].scene.layers[0].look, ws.Look)
    assert ws.movie(cube, tmp_path / "turn.gif", ws.Turn(frames=2), composite=composite, size=(16, 16)).exists()


def test_several_layers_turn_together(tmp_path):
    other = ws.Volume(np.flip(VOLUME.samples, 2).copy(), spacing=(2, 1, 1))
    scene = ws.Scene([ws.Layer(VOLUME, LOOK), ws.Layer(other, "grey", opacity=0.5)])
    pattern = ws.movie(scene, tmp_path / "both", ws.Turn(frames=3, axis=(0, 1, 0)), size=(24, 24))
    pictures = [np.asarray(images.open(png_sequence.frame_path(pattern, k)), float) for k in range(3)]
    assert all(picture.mean() > 64 for picture in pictures)  # opacity is a quarter of it


def test_a_wanted_psnr_is_measured_once(tmp_path):
    scene = ws.Scene(VOLUME, LOOK)
    shots = movie._shots(scene, ws.Turn(frames=3), 30, DrawOptions(size=(32, 32)))
    spreads = [
        shots[k].scene.render(shots[k].camera, size=(32, 32), psnr=40).report["expected_psnr_spread_db"]
        for k in range(3)
    ]
    assert spreads[0] < spreads[1]


@pytest.mark.parametrize("name", [name for name in inspect.signature(ws.movie).parameters if name != "path"])
def test_one_bad_argument_is_one_sentence(tmp_path, name):
    given = {"what": VOLUME, "path": tmp_path / "turn.mp4", "along": ws.Turn(frames=1), "size": (4, 4)}
    told = [complaint for bad in BAD if (complaint := said(ws.movie, given | {name: bad})) is not None]
    assert [text for text in told if "\n" in text or text.startswith("not ours: ")] == []
