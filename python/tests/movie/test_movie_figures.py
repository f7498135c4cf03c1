"""Movies with marks of figures, and turns through times."""

import json

import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat._movie import movie, png_sequence
from wavesplat._movie.movie import FrameFigure
from wavesplat._render.options import DrawOptions
from wavesplat.errors import ArgumentError

av = pytest.importorskip("av")
images = pytest.importorskip("PIL.Image")

SIZE = (120, 100)
DRAWN = DrawOptions(size=SIZE)
LOOK = ws.Look(
    transfer_function=ws.TransferFunction([(0, 0), (900, 0.8)], [(0, 1, 0.5, 0), (900, 1, 1, 1)]), shading=None
)


def volume(time, brightness=None):
    """A cube that stays as it is, and one that moves with time, or becomes brighter."""
    samples = np.zeros((16, 24, 24), np.float32)
    samples[4:8, 3:9, 3:9] = 500
    place = 10 + 4 * time if brightness is None else 14
    samples[8:12, 16:22, place : place + 6] = brightness or 800
    samples *= np.linspace(1, 0.9, 24, dtype=np.float32)  # else they are a segmentation
    return ws.Volume(samples, spacing=(0.5, 0.5, 0.5), unit="um")


def series(n=3, **options):
    return ws.Series([volume(time, **options) for time in range(n)], times=[30 * k for k in range(n)], time_unit="s")


def frames_of(pattern, n):
    return [np.asarray(images.open(png_sequence.frame_path(pattern, k)).convert("RGB"), int) for k in range(n)]


def test_frames_are_figures_of_their_pictures(tmp_path):
    """Frames with marks are `annotated` of each picture, to the byte."""
    scene = ws.Scene(ws.Layer(series(), LOOK), background="black")
    turn = ws.Turn(frames=3, times=range(3))
    marks = {"scale_bar": True, "orientation": "cube", "colorbar": True, "values": "light", "font_size": 12}
    pattern = ws.movie(scene, tmp_path / "f", turn, size=SIZE, quality="draft", title="t = {time}", **marks)
    shots = movie._shots(scene, turn, 30, DRAWN)
    cameras = [shots[k].camera for k in range(len(shots))]
    for k, (frame, title) in enumerate(zip(frames_of(pattern, 3), ("\u20070 s", "30 s", "60 s"), strict=True)):
        picture = scene.at_time(k).render(cameras[k], size=SIZE, quality="draft")
        figure = picture.annotated(title=f"t = {title}", **marks)
        np.testing.assert_array_equal(frame, np.asarray(figure)[..., :3])


def test_marks_do_not_move(tmp_path):
    """Bar, names and title of a turning orthographic camera are the same pixels in every frame."""
    scene = ws.Scene([ws.Layer(series(), LOOK, name="a"), ws.Layer(volume(0), LOOK, name="b")], background="black")
    turn = ws.Turn(frames=6, elevation=20, zoom=0.7, times=range(3))
    pattern = ws.movie(scene, tmp_path / "f", turn, size=SIZE, title="t = {time}", scale_bar=True, legend=True)
    frames = frames_of(pattern, 6)
    height, width = frames[0].shape[:2]
    top = height - SIZE[1]
    assert width > SIZE[0] + 10
    assert top > 10
    for frame in frames[1:]:
        np.testing.assert_array_equal(frame[:, SIZE[0] :], frames[0][:, SIZE[0] :])  # the legend beside
        np.testing.assert_array_equal(frame[-14:, :40], frames[0][-14:, :40])  # the bar
    # "t = " and " s" stay, and only the digits between change.
    heads = [frame[:top, : SIZE[0]] for frame in frames]
    changed = np.unique(np.nonzero(np.any([head != heads[0] for head in heads], axis=(0, 3)))[1])
    written = np.unique(np.nonzero(heads[0].sum(axis=2))[1])
    assert written.min() < changed.min()
    assert changed.max() < written.max()
    np.testing.assert_array_equal(heads[0], heads[1])


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".gif", ".webp"])
def test_files_are_as_large_as_their_figures(tmp_path, suffix):
    path = ws.movie(
        volume(0), tmp_path / f"a{suffix}", ws.Turn(frames=2), LOOK, size=(101, 81), title="a title", fps=10
    )
    figure = ws.render(volume(0), LOOK, size=(101, 81), background="black").annotated(title="a title")
    if suffix in (".mp4", ".webm"):
        with av.open(str(path)) as file:
            pictures = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
        sizes = [(picture.shape[1], picture.shape[0]) for picture in pictures]
    else:
        with images.open(path) as file:
            sizes = [file.size] * file.n_frames
            pictures = [np.asarray(file.convert("RGB"))]
    assert sizes == [figure.size] * 2
    top = figure.size[1] - 81
    assert pictures[0][:top].max() > 150  # the title


def test_resume_knows_marks_and_titles(tmp_path):
    scene = ws.Scene(ws.Layer(series(), LOOK))
    given = {"size": (60, 50), "quality": "draft", "resume": True}
    keys = [ws.KeyFrame(k, time=k) for k in range(3)]

    def ages(**options):
        pattern = ws.movie(scene, tmp_path / "f", keys, fps=1, **given, **options)
        return [png_sequence.frame_path(pattern, k).stat().st_mtime_ns for k in range(3)]

    first = ages(title="t = {time}")
    assert ages(title="t = {time}") == first
    other = ages(title="{time}")
    assert all(a != b for a, b in zip(first, other, strict=True))
    assert all(a != b for a, b in zip(other, ages(title="{time}", scale_bar=True), strict=True))


def test_names_of_a_legend_may_come_once(tmp_path):
    scene = ws.Scene([ws.Layer(volume(0), LOOK, name="a"), ws.Layer(volume(1), LOOK, name="b")])
    assert ws.movie(scene, tmp_path / "a.gif", ws.Turn(frames=3), legend=iter(["b"]), size=(60, 50)).exists()


def test_a_colour_bar_is_of_one_look(tmp_path):
    keys = [ws.KeyFrame(0, look=LOOK), ws.KeyFrame(1, look="grey")]
    with pytest.raises(ArgumentError, match="a colour bar shows one look, and key frames change it"):
        ws.movie(volume(0), tmp_path / "a.gif", keys, colorbar=True)
    small, large = (ws.Picture(np.zeros((9, side, 4), np.float32)) for side in (8, 9))
    figure = FrameFigure({}, is_still=True)
    figure.drawn(small, None)
    with pytest.raises(ArgumentError, match="a frame has 9 x 9 pixels, and another one 8 x 9"):
        figure.drawn(large, None)
    assert list(tmp_path.iterdir()) == []


def test_a_mark_that_cannot_be_is_no_fault_of_the_file(tmp_path):
    with pytest.raises(ArgumentError, match="^this picture has no letters"):
        ws.movie(volume(0), tmp_path / "a.gif", ws.Turn(frames=1), orientation="letters", size=(40, 40))


# Turns through times.


@pytest.mark.parametrize(
    ("frames", "times", "shown"),
    [(6, range(3), [0, 0, 1, 1, 2, 2]), (5, [2, 0], [2, 2, 2, 0, 0]), (2, range(4), [0, 2]), (1, [1], [1])],
)
def test_a_turn_shows_its_times_in_equal_shares(frames, times, shown):
    """Fault 6.7: a turn and times were said to be the same thing twice."""
    turn = ws.Turn(frames=frames, times=times)
    assert turn.time_of_frames == shown
    scene = ws.Scene(ws.Layer(series(4), LOOK))
    shots = movie._shots(scene, turn, 24, DRAWN)
    assert [shots[k].scene.layers[0].time for k in range(len(shots))] == shown
    still = movie._shots(scene.at_time(0), ws.Turn(frames=frames), 24, DRAWN)
    for k in range(frames):
        angle = np.subtract(shots[k].camera.position, shots[k].camera.focal_point)
        same = np.subtract(still[k].camera.position, still[k].camera.focal_point)
        np.testing.assert_allclose(angle / np.linalg.norm(angle), same / np.linalg.norm(same), atol=1e-9)


def test_a_turn_has_all_of_its_times_in_view():
    moved = ws.Series(
        [volume(0), ws.Volume(volume(0).samples, world_from_index=np.diag([1.0, 1.0, 2.0, 1.0]), unit="um")]
    )
    scene = ws.Scene(ws.Layer(moved, LOOK))
    scales = [
        movie._shots(scene.at_time(k), ws.Turn(frames=2, times=times), 30, DRAWN)[0].camera.parallel_scale
        for k, times in ((0, None), (1, None), (0, (0, 1)))
    ]
    assert scales[0] < 0.7 * scales[1]
    assert scales[2] >= 0.99 * scales[1]
    # So has a movie of key frames without a camera.
    shots = movie._shots(scene, [ws.KeyFrame(0, time=0), ws.KeyFrame(1, time=1)], 1, DRAWN)
    assert shots[0].camera == shots[1].camera
    assert shots[0].camera.parallel_scale > 1.3 * scales[0]


@pytest.mark.parametrize(
    ("times", "message"),
    [([], "times of the turn is a list"), (3, "times of the turn is 3"), ([0.5], "times of the turn is a list")],
)
def test_times_that_cannot_be(times, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Turn(times=times)


def test_times_that_are_not_there(tmp_path):
    with pytest.raises(ArgumentError, match="time point 9, but series 'series' holds 3"):
        ws.movie(ws.Scene(ws.Layer(series(), LOOK)), tmp_path / "a.gif", ws.Turn(frames=2, times=[0, 9]))
    with pytest.raises(ArgumentError, match="has no layer with several times"):
        ws.movie(volume(0), tmp_path / "a.gif", ws.Turn(frames=2, times=[0]))


@pytest.mark.parametrize("composite", ["over", "maximum", "mean"])
@pytest.mark.parametrize("start", [0, 2])
def test_the_look_is_one_for_all_times(tmp_path, composite, start):
    """A cube that does not change keeps its pixels while one beside it becomes four times as bright."""
    growing = ws.Series([volume(0, brightness=b) for b in (300, 600, 1200)])
    # Without light, since matter that becomes denser shades the cube beside it, and at one sampling for all frames.
    scene = ws.Scene(ws.Layer(growing, time=start), background="black", shading=None)
    camera = ws.Camera.view(volume(0), "xy")
    keys = [ws.KeyFrame(k, camera=camera, time=k) for k in range(3)]
    how = {"composite": composite, "quality": "normal", "device": "cpu"}
    pattern = ws.movie(scene, tmp_path / "f", keys, fps=1, size=(48, 48), **how)
    frames = frames_of(pattern, 3)
    changed = np.any(frames[0] != frames[2], axis=2)
    columns = np.nonzero(changed.any(axis=0))[0]
    still = ~changed & (frames[0].max(axis=2) > 8)
    assert still.sum() > 40  # the cube that does not change
    assert columns.size > 8
    np.testing.assert_array_equal(frames[0][still], frames[1][still])
    assert frames[2].max() > frames[0][changed].max()


def test_the_command_line_turns_through_times(wavesplat, tmp_path):
    """Fault 6.7: `movie t.ome.tif --times all --turn 30`."""
    samples = np.stack([volume(time).samples for time in range(3)]).astype(np.uint16)
    metadata = {"axes": "TZYX", "TimeIncrement": 30.0, "TimeIncrementUnit": "s"}
    sizes = {f"PhysicalSize{axis}": 0.5 for axis in "XYZ"}
    tifffile.imwrite(tmp_path / "t.ome.tif", samples, metadata=metadata | sizes)
    options = ("--turn", 6, "--times", "all", "--title", "t = {time}", "--scale-bar", "--size", "120x100", "--json")
    done = wavesplat("movie", tmp_path / "t.ome.tif", "-o", tmp_path / "f", *options, "--quality", "draft")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert facts["frames"] == 6
    assert facts["look"]["name"] == "auto"
    scene = ws.open_scene(tmp_path / "t.ome.tif")
    look = ws.Look.auto(scene.layers[0].looked_at)
    own = ws.movie(
        scene.with_(layers=[ws.Layer(scene.layers[0].volume, look)], background="black"),
        tmp_path / "own",
        ws.Turn(frames=6, times=range(3)),
        size=SIZE,
        quality="draft",
        title="t = {time}",
        scale_bar=True,
    )
    for got, want in zip(frames_of(tmp_path / "f" / "%04d.png", 6), frames_of(own, 6), strict=True):
        np.testing.assert_array_equal(got, want)
