"""Colours of channels: the file's, else the usual ones of their wavelengths and dyes."""

from __future__ import annotations

import colorsys
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import test_bioio_files as bioio_files

import wavesplat as ws
from wavesplat import _native
from wavesplat._looks.kinds.channel_colors import color_of, usual_color
from wavesplat._readers.microscopes.bioio_files import czi_channels

BLUE, CYAN, GREEN, YELLOW, MAGENTA, WHITE = (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 1, 0), (1, 0, 1), (1, 1, 1)
HUES = {"blue": 240, "cyan": 180, "green": 120, "yellow": 60, "orange": 30, "red": 12, "magenta": 300}
#: Hue -> names of dyes, and wavelengths of light, that have it on figures of cells.
OF_LIGHT = {
    "blue": ["DAPI", "Hoechst 33342", "mTagBFP2", "405 nm", "Alexa Fluor 405", 461],
    "cyan": ["CFP", "mTurquoise2", "mCerulean3", 477],
    "green": [
        "EGFP",
        "GFP (488)",
        "FITC",
        "AF488",
        "Alexa Fluor 488",
        "mNeonGreen",
        "Confocal - 488",
        "LED470",
        509,
        525,
    ],
    "yellow": ["YFP", "mVenus", 550],
    "orange": ["TRITC", "Cy3", "tdTomato", "Alexa555", "JF549", 568],
    "red": ["mCherry", "H2B-mCherry", "actin 568", "Texas Red", "mScarlet-I", 603, 615],
    "magenta": ["Cy5", "Cy 5", "Alexa Fluor 647", "640", "SiR-tubulin", "far red", "ATTO 647N", 668],
}


def hue(color):
    return 360 * colorsys.rgb_to_hsv(*color)[0]


@pytest.mark.parametrize("wanted", OF_LIGHT)
def test_light_has_its_usual_colour(wanted):
    for light in OF_LIGHT[wanted]:
        known = {"name": light} if isinstance(light, str) else {"emission_nm": light}
        color = usual_color(ws.Channel(**known))
        assert color is not None, light
        assert abs(hue(color) - HUES[wanted]) < 1, light
    for name in ("", "channel 0", "Ch1-T1", "nuclei", "membrane", "E-cadherin", "Z500", "s00", "tile 512"):
        assert usual_color(ws.Channel(name)) is None, name
    # bioio names the channels of Leica's files after their look-up tables.
    assert [usual_color(ws.Channel(name)) for name in ("Green", "Red", "Gray")] == [GREEN, (1, 0, 0), WHITE]
    assert usual_color(ws.Channel("TL Brightfield")) == usual_color(ws.Channel("T-PMT")) == WHITE


def test_the_file_s_colour_comes_first_but_for_white_everywhere():
    white = [ws.Channel("DAPI", color=WHITE), ws.Channel("nuclei", color=WHITE, emission_nm=509)]
    assert [color_of(one, white) for one in white] == [BLUE, GREEN]
    chosen = [ws.Channel("DAPI", color=WHITE), ws.Channel("GFP", color=(0.5, 0, 0))]
    assert [color_of(one, chosen) for one in chosen] == [WHITE, (0.5, 0, 0)]
    assert color_of(white[0], white[:1]) == WHITE  # of a single channel it is the grey that many want
    assert color_of(None, []) is None


def test_channels_without_a_colour_take_none_that_another_has():
    assert _native.distinct_colors([None] * 4, [None, GREEN, None, GREEN]) == [MAGENTA, GREEN, CYAN, YELLOW]
    assert _native.distinct_colors([BLUE, None], [GREEN, BLUE]) == [BLUE, GREEN]


CZI = """<ImageDocument><Metadata><Information><Image><Dimensions><Channels>
<Channel Id="Channel:0" Name="LED555"><EmissionWavelength>568</EmissionWavelength><Color>#FFFFFFFF</Color></Channel>
<Channel Id="Channel:1" Name="DAPI"><EmissionWavelength>465</EmissionWavelength></Channel>
</Channels></Dimensions></Image></Information><DisplaySetting><Channels>
<Channel Id="Channel:1" Name="DAPI"><Color>#FF00A1FF</Color></Channel>
<Channel Id="Channel:0" Name="LED555"><Color>#FFFF7E00</Color></Channel>
</Channels></DisplaySetting></Metadata></ImageDocument>"""


def test_in_space_a_channel_without_a_colour_takes_none_of_a_later_one():
    """It took green, so that the channel that is green was drawn in magenta."""
    samples = np.random.default_rng(1).gamma(1.0, 40.0, (2, 12, 12, 12)).astype(np.uint16)
    channels = (ws.Channel("nuclei"), ws.Channel("membrane", color=GREEN))
    layers = [
        ws.Layer(ws.Volume(one, unit="um", facts=ws.Facts(channel=channel, channels=channels)))
        for one, channel in zip(samples, channels, strict=True)
    ]
    shown = ws.render(layers, composite="maximum", size=(8, 8)).report["shown"]
    of_nuclei, of_membrane = (one["transfer_function"]["color"][-1][1:] for one in shown)
    assert hue(of_membrane) == pytest.approx(120, abs=10)
    assert abs(hue(of_nuclei) - 120) > 30


def test_a_czi_has_the_colours_of_its_display(monkeypatch, tmp_path):
    """bioio gives white for all of them; OME's metadata, which have the wavelengths, may be refused."""
    path = tmp_path / "a.czi"
    path.write_bytes(b"ZISRAWFILE" + bytes(9000))
    tree = ET.fromstring(CZI)  # noqa: S314 - ours
    bioio_files.use(monkeypatch, bioio_files.Image(names=("LED555", "DAPI"), metadata=tree))
    facts = ws.open(path, channel=1, time=0).facts
    assert facts.modality == "fluorescence"
    assert facts.channels == (
        ws.Channel("LED555", (1, 126 / 255, 0), 568),
        ws.Channel("DAPI", (0, 161 / 255, 1), 465),
    )
    scene = ws.open_scene(path)
    assert [round(hue(layer.look.transfer_function.color[1][1:])) for layer in scene.layers] == [30, 202]
    # Without what was displayed: by the wavelengths.
    for one in tree.findall(".//Color"):
        one.text = None
    scene = ws.open_scene(path)
    assert [layer.drawn.facts.channel.color for layer in scene.layers] == [None, None]
    assert [round(hue(layer.look.transfer_function.color[1][1:])) for layer in scene.layers] == [30, 240]
    assert czi_channels(object(), 2) == czi_channels(ET.Element("a"), 2)


@pytest.mark.parametrize("kind", ["a.ome.tif", "a.ome.zarr", "xarray"])
def test_dyes_that_are_named_have_their_colours_in_every_format(tmp_path, kind):
    names = ["DAPI", "GFP", "mCherry", "Cy5"]
    samples = np.random.default_rng(2).poisson(40, (4, 6, 20, 20)).astype(np.uint16)
    samples[:, 2:4, 5:9, 5:9] += 900
    if kind == "xarray":
        xarray = pytest.importorskip("xarray")
        scene = ws.Scene(xarray.DataArray(samples, dims=("c", "z", "y", "x"), coords={"c": names}))
    elif kind == "a.ome.tif":
        import tifffile

        metadata = {"axes": "CZYX", "Channel": {"Name": names}, "PhysicalSizeX": 0.2, "PhysicalSizeY": 0.2}
        tifffile.imwrite(tmp_path / kind, samples, metadata=metadata)
        scene = ws.open_scene(tmp_path / kind)
    else:
        import zarr

        group = zarr.open_group(tmp_path / kind, mode="w")
        group.create_array("0", data=samples)
        axes = [{"name": "c", "type": "channel"}, *({"name": name, "type": "space"} for name in "zyx")]
        scale = [{"type": "scale", "scale": [1.0, 1.0, 1.0, 1.0]}]
        images = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": scale}]}]
        omero = {"channels": [{"label": name, "color": "FFFFFF"} for name in names]}
        group.attrs["ome"] = {"version": "0.5", "multiscales": images, "omero": omero}
        scene = ws.open_scene(tmp_path / kind)
    hues = [hue(layer.look.transfer_function.color[1][1:]) for layer in scene.layers]
    np.testing.assert_allclose(hues, [240, 120, 12, 300], atol=4)  # a little white is mixed in
