"""`wavesplat render` of several channels, volumes and times: the syntax of the options, and the pictures."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_open_scene import DESCRIBED, cells, save

import wavesplat as ws
from wavesplat._cli.options.layers import (
    LayerText,
    channel_of,
    further_layers,
    layer_of,
    names_of_pictures,
    names_of_times,
    times_of,
)
from wavesplat.errors import ArgumentError, FileError

#: A volume that transforms of layers would map onto.
SCAN = ws.examples.ripples(8)


@pytest.mark.parametrize(
    ("text", "channel"),
    [
        ("0", (0, None, None)),
        ("0:green:100,900", (0, "green", (100, 900))),
        ("DAPI:blue", ("DAPI", "blue", None)),
        ("DAPI:-1.5,2e3", ("DAPI", None, (-1.5, 2000))),
        ("2:#ff8000", (2, "#ff8000", None)),
        ("2:1,0.5,0:3,4", (2, "1,0.5,0", (3, 4))),
        ("GFP:488:green", ("GFP:488", "green", None)),
        ("GFP:488", ("GFP:488", None, None)),
        ("green", ("green", None, None)),
        ("0:grean", ("0:grean", None, None)),  # which no file names
    ],
)
def test_channels_are_read_from_the_right(text, channel):
    assert tuple(channel_of(text)) == channel


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0:green:900,100", r"the window 900,100 of '0:green:900,100' does not grow; --channel is NUMBER\|NAME"),
        ("", "names no channel; it is NUMBER"),
        (" :green", "names no channel; it is NUMBER"),
    ],
)
def test_what_is_no_channel(text, message):
    with pytest.raises(ArgumentError, match=message):
        channel_of(text)


@pytest.mark.parametrize(
    ("look", "said"),
    [
        ("", (None, None)),
        (":hot", ("hot", None)),
        (":hot:2,8", ("hot", (2, 8))),
        (":2,8", (None, (2, 8))),
        (":cmocean:ice:0,1", ("cmocean:ice", (0, 1))),
        (":CT-AAA", ("CT-AAA", None)),
    ],
)
@pytest.mark.parametrize("name", ["pet.nii.gz", "a:b.nii", "x.nii:2,8", "c:/x/pet.npy"])
def test_files_of_layers_may_have_colons(tmp_path, monkeypatch, name, look, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).touch()
    assert layer_of(name + look) == LayerText(name, *said)


def test_layers_have_names_of_ones_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pet.nii.gz").touch()
    wanted = LayerText("pet.nii.gz", "hot", (2, 8), 3.0, "x.mat", "FDG: late")
    assert layer_of("pet.nii.gz:hot:2,8:threshold=3:reg=x.mat:name=FDG: late") == wanted


@pytest.mark.parametrize(
    ("text", "layer"),
    [
        ("https://host:8080/a.zarr", ("https://host:8080/a.zarr", None, None)),
        ("https://host:8080/a.zarr:hot:1,2", ("https://host:8080/a.zarr", "hot", (1, 2))),
        ("s3://bucket/a.zarr/:cmocean:ice", ("s3://bucket/a.zarr/", "cmocean:ice", None)),
    ],
)
def test_urls_of_layers(text, layer):
    assert layer_of(text) == LayerText(*layer)


def test_layers_that_are_not_there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        ArgumentError, match=r"begins with no file that is there; it is FILE\[#DATASET\]\[:LOOK\]\[:LOW,HIGH\]"
    ):
        layer_of("pet.nii.gz:hot")


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("all", [*range(12)]),
        ("0,5,10", [0, 5, 10]),
        ("-1", [11]),
        ("0:10", [*range(10)]),
        ("2:", [*range(2, 12)]),
        ("::5", [0, 5, 10]),
        ("-2:", [10, 11]),
    ],
)
def test_times(text, numbers):
    assert times_of(text, 12) == numbers


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("12", r"--times has 12, but the file holds 12 time points, 0\.\.11"),
        ("x", "--times is 'x'; it is all|N"),
        ("0,,1", "it is all"),
        ("", "it is all"),
        ("0:1:2:3", "it is all"),
        ("0:9:0", "step is 0"),
        ("12:", r"selects none of the time points 0\.\.11"),
    ],
)
def test_what_are_no_times(text, message):
    with pytest.raises(ArgumentError, match=message):
        times_of(text, 12)


def test_names_of_pictures(tmp_path):
    numbers = [str(number) for number in range(12)]
    named = dict(names_of_pictures(tmp_path / "a.b.png", [3, 11], numbers))
    assert named == {3: tmp_path / "a.b_03.png", 11: tmp_path / "a.b_11.png"}
    assert dict(names_of_pictures(tmp_path / "t{time}.png", [3], numbers)) == {3: tmp_path / "t03.png"}
    seconds = ["0 s", "30 s", "120 s"]
    assert dict(names_of_pictures(tmp_path / "{time}.png", [1], seconds)) == {1: tmp_path / "030s.png"}


@pytest.mark.parametrize(
    ("texts", "names"),
    [
        (["0.0 s", "0.5 s", "10.0 s"], ["00.0s", "00.5s", "10.0s"]),
        (["0 \u00b5s", "5 \u00b5s"], ["0us", "5us"]),
        (["0 /a b", "5 /a b"], ["0ab", "5ab"]),
        (["7 s", "7 s"], ["0", "1"]),
        (["0"], ["0"]),
    ],
)
def test_times_in_names_of_files_are_safe_and_distinct(texts, names):
    assert names_of_times(texts) == names


# Pictures


@pytest.fixture
def render(wavesplat, tmp_path):
    """A function that draws with options, and returns the picture's path and the finished command."""

    def run(*arguments):
        path = tmp_path / "out.png"
        done = wavesplat("render", *arguments, "-o", path, "--size", "24x24", "--composite", "maximum")
        assert done.returncode == 0, done.stderr
        return path, done

    return run


def same(path, scene, tmp_path, camera=None):
    """Whether Python draws the same pixels; the files' metadata differ by the background."""
    scene.render(camera, size=(24, 24), composite="maximum").save(tmp_path / "python.png")
    return pixels(path) == pixels(tmp_path / "python.png")


def pixels(path):
    from PIL import Image

    with Image.open(path) as image:
        return image.convert("RGBA").tobytes()


def test_all_channels_are_drawn(render, tmp_path):
    source = save(tmp_path / "a.zarr", 3, DESCRIBED)
    path, done = render(source)
    assert same(path, ws.open_scene(source, composite="maximum"), tmp_path)
    assert "note" not in done.stderr
    path, _ = render(source, "--channel", "GFP:#ff8000:150,450", "--channel", "0")
    channels = [("GFP", "#ff8000", (150, 450)), 0]
    assert same(path, ws.open_scene(source, channels=channels, composite="maximum"), tmp_path)


def test_one_channel_is_a_volume_like_any_other(render, tmp_path):
    source = save(tmp_path / "a.zarr", 3, DESCRIBED)
    path, _ = render(source, "--channel", "1", "--cmap", "inferno")
    by_number = pixels(path)
    path, _ = render(source, "--channel", "GFP", "--cmap", "inferno")
    assert pixels(path) == by_number


def test_times_share_look_and_view(wavesplat, tmp_path):
    source = save(tmp_path / "a.zarr", 2, DESCRIBED[:2], n_times=3)
    options = ["--size", "24x24", "--composite", "maximum"]
    done = wavesplat("render", source, "-o", tmp_path / "t{time}.png", "--times", "0:3:2", "--json", *options)
    assert done.returncode == 0, done.stderr
    made = json.loads(done.stdout)["pictures"]
    assert [one["picture"] for one in made] == [str(tmp_path / f"t{n}.png") for n in (0, 2)]
    first, last = (pixels(tmp_path / f"t{n}.png") for n in (0, 2))
    assert first != last
    # One time alone, which the note names.
    done = wavesplat("render", source, "-o", tmp_path / "a.png", *options)
    assert "note: the file holds 3 time points; this is --time 0" in done.stderr
    done = wavesplat("render", source, "-o", tmp_path / "b.png", "--time", "1", *options)
    assert (done.returncode, done.stderr) == (0, "")


def test_times_of_one_volume(wavesplat, tmp_path):
    np.save(tmp_path / "a.npy", cells(1, 3)[:, 0])
    done = wavesplat("render", tmp_path / "a.npy", "-o", tmp_path / "t.png", "--times", "all", "--size", "24x24", "-q")
    assert done.stdout.split() == [str(tmp_path / f"t_{n}.png") for n in range(3)]
    assert len({pixels(tmp_path / f"t_{n}.png") for n in range(3)}) == 3


def test_a_further_volume(render, tmp_path):
    base = cells(1)[0, 0]
    np.save(tmp_path / "ct.npy", base)
    np.save(tmp_path / "pet.npy", base[:, ::-1].copy())
    path, _ = render(tmp_path / "ct.npy", "--layer", f"{tmp_path / 'pet.npy'}:hot:150,450")
    both = pixels(path)
    path, _ = render(tmp_path / "ct.npy")
    assert pixels(path) != both


def test_a_further_volume_of_several_channels(tmp_path):
    source = save(tmp_path / "a.zarr", 2, DESCRIBED[:2])
    assert [layer.name for layer in further_layers([str(source)], SCAN, time=0, quiet=True)] == ["DAPI", "GFP"]
    with pytest.raises(FileError, match="holds 2 channels"):
        further_layers([f"{source}:hot"], SCAN, time=0, quiet=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--preset", "pet"], "--preset: for one volume, and the picture is of 2 channels"),
        (["--cmap", "hot"], "--cmap: for one volume"),
        (["--channel", "x:grean"], r"no channel 'x:grean'.*\(--channel is NUMBER\|NAME"),
        (["--times", "all", "--time", "0"], "--time and --times say the same thing twice"),
        (["--times", "3"], "--times has 3, but the file holds 1 time points"),
        (["--layer", "pet.nii:hot"], "begins with no file"),
    ],
)
def test_mistakes_are_said(wavesplat, tmp_path, options, message):
    source = save(tmp_path / "a.zarr", 2, DESCRIBED[:2])
    done = wavesplat("render", source, "-o", tmp_path / "a.png", *options)
    assert done.returncode == 2
    assert re.search(message, done.stderr)
    assert not (tmp_path / "a.png").exists()


def test_presets_of_layers_have_values_of_their_own(wavesplat, tmp_path):
    np.save(tmp_path / "a.npy", cells(1)[0, 0])
    done = wavesplat("render", tmp_path / "a.npy", "-o", tmp_path / "a.png", "--layer", f"{tmp_path}/a.npy:ct-bone:1,2")
    assert "the preset 'ct-bone' has values of its own, so leave out the window" in done.stderr
    done = wavesplat("render", tmp_path / "a.npy", "-o", tmp_path / "a.png", "--layer", f"{tmp_path}/a.npy:hotter")
    assert "the look of a layer is a preset, a colour or a colour map" in done.stderr


def test_a_window_far_below_the_values_of_a_layer_has_a_note(wavesplat, tmp_path):
    """A PET in Bq/ml in a window for SUV covers the scan as a white box."""
    values = 100 * np.random.default_rng(0).random((12, 12, 12), np.float32) ** 2
    ws.Volume(values + 10, facts=ws.Facts(modality="PT", value_unit="Bq/ml")).save(tmp_path / "pet.nrrd")
    ws.Volume(values).save(tmp_path / "scan.nrrd")

    def note(words):
        layer = f"{tmp_path / 'pet.nrrd'}:{words}"
        told = wavesplat("slice", tmp_path / "scan.nrrd", "--layer", layer, "-o", tmp_path / "x.png").stderr
        return next((line for line in told.splitlines() if "lie above its window" in line), "")

    assert "100 % of the values of layer 'pet.nrrd' lie above its window, which ends at 8" in note("hot:2,8")
    for words in ("hot:20,90", "hot", "hot:10%,50%", "hot:2,8:threshold=5"):
        assert bool(note(words)) == (":2,8" in words)


def test_a_word_for_the_channel_draws_each_channel_alone(tmp_path, wavesplat):
    """One file of that very name was written, braces included."""
    tifffile = pytest.importorskip("tifffile")
    samples = np.random.default_rng(2).poisson(40, (2, 6, 20, 24)).astype(np.uint16)
    samples[0, 2:4, 4:10, 4:10], samples[1, 2:4, 12:18, 12:20] = 900, 900
    channels = {"Name": ["DAPI", "a/b"]}
    source = tmp_path / "a.ome.tif"
    tifffile.imwrite(source, samples, metadata={"axes": "CZYX", "Channel": channels, "PhysicalSizeX": 1.0})
    options = ["--size", "32x24", "--quiet"]
    done = wavesplat("render", source, "-o", tmp_path / "q_{channel}.png", *options, "--json")
    assert done.returncode == 0, done.stderr
    paths = [Path(one["picture"]) for one in json.loads(done.stdout)["pictures"]]
    assert [path.name for path in paths] == ["q_DAPI.png", "q_a_b.png"]
    blue, green = (np.asarray(Image.open(path).convert("RGB")).astype(int) for path in paths)
    assert blue[..., 2].sum() > 2 * blue[..., 1].sum()
    assert green[..., 1].sum() > 2 * green[..., 2].sum()
    wrong = wavesplat("render", source, "-o", tmp_path / "q_{chan}.png", *options)
    assert "unknown {chan} in --output, is it {channel}?; words in braces are" in wrong.stderr
    assert "unknown {channel} in --output" in wavesplat("slice", source, "-o", tmp_path / "{channel}.png").stderr
