"""Looks in files of 3D Slicer and ParaView. VTK's numbers were printed by VTK 9.7."""

import json

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks import presets
from wavesplat._looks.curves import colors
from wavesplat._looks.interchange import vtk_curves
from wavesplat.errors import ArgumentError, FileError

SLICER = [name for name, preset in presets.catalogue().items() if preset.kind == "slicer"]
#: A file of 3D Slicer, Modules/Loadable/VolumeRendering/Testing/Data/Input/VolumeProperty.vp, shortened.
VP = """1
1
0.42
0.44
0.46
38.5
8 -17 0 13 0 103 1 235 1
4 -17 1 235 0.5
8 -17 1 0 0.5 235 1 1 1
"""
SCENE = """<?xml version="1.0" encoding="UTF-8"?>
<MRML>
  <VolumeProperty name="One" shade="1" ambient="0.1" diffuse="0.9" specular="0.2" specularPower="10"
    scalarOpacity="4 0 0 100 0.5" gradientOpacity="4 0 1 255 1" colorTransfer="8 0 0 0 0 100 1 1 1"/>
  <VolumeProperty name="Two" shade="0" scalarOpacity="4 50 0 60 1" colorTransfer="4 0 1 0 0"/>
</MRML>
"""


@pytest.fixture
def saved(tmp_path):
    """Write a text to a file whose name does not identify its format."""

    def save(text, name="file.txt"):
        path = tmp_path / name
        path.write_text(text if isinstance(text, str) else json.dumps(text))
        return path

    return save


# 3D Slicer


@pytest.mark.parametrize("name", SLICER)
def test_presets_of_slicer_are_looks(name):
    look = ws.Look.preset(name)
    assert look.transfer_function.opacity_unit == 1.0
    assert look.shading is None or look.shading.lights == (ws.Light((0, 0, 1)),)
    again = ws.Look.preset("slicer " + name.removeprefix("slicer-").lower().replace("-", "_"))
    assert again == look


def test_points_and_terms_are_those_of_slicer():
    assert len(SLICER) == 31
    look = ws.Look.preset("CT-AAA")
    assert look.transfer_function.opacity[2] == (166.222, 0.686275)
    assert look.transfer_function.color[-1] == (3071, 0.827451, 0.658824, 1)
    assert look.transfer_function.gradient_opacity == ()  # 1 everywhere
    light = look.shading
    assert (light.ambient, light.diffuse, light.specular, light.specular_power) == (0.1, 0.9, 0.2, 10)
    assert ws.Look.preset("CT-Soft-Tissue") == ws.Look.preset("ct-soft-tissue")  # the plain name is that of our preset
    assert ws.Look.preset("slicer-ct-soft-tissue").shading is None


def test_a_smooth_bright_bone_does_not_burn_out_with_slicers_light():
    """Fault 20 of the clinic: of a hip with CT-AAA 15 % of the pixels were clipped, of this shaft more."""
    _, y, x = np.meshgrid(*[np.linspace(-1, 1, n) for n in (24, 64, 64)], indexing="ij")
    r = np.hypot(x, y)
    cortex = 1400 / (1 + np.exp((r - 0.5) / 0.02)) - 1380 / (1 + np.exp((r - 0.3) / 0.02))
    shaft = ws.Volume((cortex + 50).astype(np.int16), facts=ws.Facts(unit="mm", is_anatomical=True, modality="CT"))
    look = ws.Look.preset("CT-AAA", shaft)
    light = look.shading
    old = ws.Shading.headlight(ambient=light.ambient, diffuse=light.diffuse, specular=light.specular, specular_power=10)

    def clipped_and_mean(shading):
        rgb = ws.render(shaft, look, "front", shading=shading, size=(64, 64)).rgba[..., :3]
        seen = rgb.max(axis=2) > 0.1
        return (rgb.max(axis=2)[seen] > 253.5 / 255).mean(), np.clip(rgb, 0, 1)[seen].mean()

    burnt, bright = clipped_and_mean(old)
    assert burnt > 0.2
    share, mean = clipped_and_mean("look")
    assert share == 0
    assert 0.9 * bright < mean < bright


def test_gradients_of_slicer_are_per_mean_spacing():
    volume = ws.Volume(np.zeros((2, 2, 2)), spacing=(1, 2, 3))
    magnitudes = [magnitude for magnitude, _ in ws.Look.preset("uCT-Skull", volume).transfer_function.gradient_opacity]
    np.testing.assert_allclose(magnitudes, np.array([0, 0, 46.9644546508789, 128.360549926758, 255]) / 2)


def test_vp_files(saved):
    look = ws.Look.load(saved(VP, "mine.vp"))
    assert look.name == "mine"
    light = look.shading
    assert (light.diffuse, light.ambient, light.specular, light.specular_power) == (0.42, 0.44, 0.46, 38.5)
    assert look.transfer_function.opacity == ((-17, 0), (13, 0), (103, 1), (235, 1))
    assert look.transfer_function.gradient_opacity == ((0, 1), (235, 0.5))
    assert look.transfer_function.color == ((-17, 1, 0, 0.5), (235, 1, 1, 1))


def test_scenes_of_slicer_by_name(saved):
    path = saved(SCENE)
    two = ws.Look.load(path, name="TWO")
    assert (two.name, two.shading) == ("Two", None)
    assert two.transfer_function.opacity == ((50, 0), (60, 1))
    assert ws.Look.load(path, name="one").shading.diffuse == 0.9
    with pytest.raises(ArgumentError, match="holds 2; name one of: One, Two"):
        ws.Look.load(path)
    with pytest.raises(ArgumentError, match="no 'three'; it has One, Two"):
        ws.Look.load(path, name="three")


def test_vp_json_files(saved):
    component = {
        "shade": True,
        "lighting": {"diffuse": 1.0, "ambient": 0.2, "specular": 0.0, "specularPower": 1.0},
        "rgbTransferFunction": {
            "points": [{"x": 0.0, "color": [0.0, 0.0, 0.0]}, {"x": 220.0, "color": [0.8, 0.7, 0.6]}]
        },
        "scalarOpacityUnitDistance": 0.5,
        "scalarOpacity": {"points": [{"x": 0.0, "y": 0.0}, {"x": 120.0, "y": 0.3, "midpoint": 0.5, "sharpness": 0.0}]},
        "gradientOpacity": {"points": [{"x": 0.0, "y": 1.0}, {"x": 255.0, "y": 1.0}]},
    }
    look = ws.Look.load(saved({"@schema": "...", "volumeProperties": [{"components": [component]}]}, "some.vp.json"))
    assert look.name == "some"
    assert look.shading.ambient == 0.2
    assert look.transfer_function == ws.TransferFunction(
        [(0, 0), (120, 0.3)], [(0, 0, 0, 0), (220, 0.8, 0.7, 0.6)], 0.5
    )


@pytest.mark.parametrize(("midpoint", "sharpness"), [(0.5, 0.0), (0.3, 0.0), (0.5, 0.5), (0.7, 0.2)])
def test_bent_curves_are_those_of_vtk(midpoint, sharpness):
    vtk = {
        (0.3, 0.0): (0.43333, 0.61429, 0.75714),
        (0.5, 0.5): (0.1032, 0.5, 0.8968),
        (0.7, 0.2): (0.11482, 0.23062, 0.68238),
    }
    nodes = vtk_curves.line_nodes([(1, 0.9, 0.5, 0), (0, 0.1, midpoint, sharpness)])
    at = np.array([0.25, 0.5, 0.75])
    np.testing.assert_allclose(
        0.1 + 0.8 * vtk_curves.way_between(at, midpoint, sharpness),
        vtk.get((midpoint, sharpness), (0.3, 0.5, 0.7)),
        atol=1e-5,
    )
    values, alphas = np.array(nodes).T
    between = np.linspace(0, 1, 200)
    exact = 0.1 + 0.8 * vtk_curves.way_between(between, midpoint, sharpness)
    np.testing.assert_allclose(np.interp(between, values, alphas), exact, atol=0.02)


# ParaView


@pytest.mark.parametrize(
    ("space", "vtk"),
    [
        ("Diverging", [(0.5328, 0.6891, 0.9923), (0.8654, 0.8654, 0.8654), (0.9522, 0.6016, 0.4772)]),
        ("Lab", [(0.4537, 0.2554, 0.5932), (0.5711, 0.2051, 0.442), (0.6464, 0.1415, 0.2959)]),
        ("HSV", [(0.3375, 0.1528, 0.7375), (0.6097, 0.107, 0.725), (0.7125, 0.0628, 0.5103)]),
        ("Step", [(0.7, 0.02, 0.15)] * 3),
    ],
)
def test_colours_between_two_are_those_of_vtk(space, vtk):
    got = colors.between(space, (0.2, 0.3, 0.75), (0.7, 0.02, 0.15), np.array([0.25, 0.5, 0.75]))
    np.testing.assert_allclose(got, vtk, atol=5e-4)


def test_greys_and_hues_across_the_circle():
    spin = colors.between("Diverging", (0.865, 0.865, 0.865), (0.706, 0.0157, 0.15), np.array([0.001, 0.999]))
    np.testing.assert_allclose(spin, [(0.865, 0.865, 0.865), (0.706, 0.0157, 0.15)], atol=5e-3)
    short = colors.between("HSVWrap", (1, 0, 0.2), (1, 0.2, 0), np.array([0.5]))
    np.testing.assert_allclose(short, [(1, 0, 0)], atol=1e-9)


COLD_TO_HOT = {
    "ColorSpace": "Diverging",
    "Name": "Cool to Warm",
    "NanColor": [1, 1, 0],
    "RGBPoints": [0, 0.231, 0.298, 0.753, 0.5, 0.865, 0.865, 0.865, 1, 0.706, 0.0157, 0.149],
}
VOLUME = ws.Volume(np.linspace(10, 20, 1000).reshape(10, 10, 10))


def test_maps_from_0_to_1_are_stretched_over_a_volume(saved):
    path = saved([COLD_TO_HOT])
    curves = ws.Look.load(path).transfer_function
    assert curves.opacity == ((0, 0), (1, 1))
    np.testing.assert_allclose(curves([0.5]), [(0.865, 0.865, 0.865, 0.5)])
    fitted = ws.Look.load(path, VOLUME)
    assert fitted.name == "Cool to Warm"
    np.testing.assert_allclose([value for value, _ in fitted.transfer_function.opacity], [10.01, 19.99], atol=0.01)


def test_maps_in_values_stay_there_with_their_opacities(saved):
    points = {"RGBPoints": [5, 1, 0, 0, 25, 0, 0, 1], "ColorSpace": "RGB", "Name": "mine"}
    opacity = {"Points": [0, 0.2, 0.5, 0, 1, 0.6, 0.5, 0]}
    curves = ws.Look.load(saved([points | opacity]), VOLUME).transfer_function
    assert curves == ws.TransferFunction([(5, 0.2), (25, 0.6)], [(5, 1, 0, 0), (25, 0, 0, 1)])


def test_steps_have_the_colour_of_their_end(saved):
    points = {"RGBPoints": [0, 1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 1], "ColorSpace": "Step"}
    curves = ws.Look.load(saved([points])).transfer_function
    np.testing.assert_allclose(curves([1, 9, 11, 19])[:, :3], [(0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 0, 1)])


def test_xml_maps(saved):
    text = """<ColorMaps><ColorMap name="Rain" space="RGB">
      <Point x="-1" o="0.1" r="0" g="0" b="1"/><Point x="3" o="0.7" r="1" g="1" b="0"/><NaN r="0" g="0" b="0"/>
    </ColorMap></ColorMaps>"""
    look = ws.Look.load(saved(text))
    assert look.name == "Rain"
    assert look.transfer_function == ws.TransferFunction([(-1, 0.1), (3, 0.7)], [(-1, 0, 0, 1), (3, 1, 1, 0)])


# Ours, and none


def test_our_own_files_load_too(saved):
    look = ws.Look.preset("ct-bone")
    assert ws.Look.load(saved(look.to_json())) == look
    curves = look.transfer_function
    assert ws.Look.load(saved(curves.to_json())).transfer_function == curves
    table = ws.TransferFunction2D([0, 1], [0, 1], np.zeros((2, 2, 4)))
    assert ws.Look.load(saved(table.to_json())).transfer_function == table
    with pytest.raises(ArgumentError, match="holds one; leave out the name 'x'"):
        ws.Look.load(saved(look.to_json()), name="x")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "0 lines; a .vp file has 9"),
        ("1\n2\n3\n", "3 lines"),
        (VP.replace("0.44", "x"), "ambient is 'x'"),
        (VP.replace("8 -17 0 13", "8 -17 13"), "scalar opacity says 8 numbers, and has 7"),
        (VP.replace("8 -17 0 13", "8 -17 ? 13"), "it must be a count"),
        ("{", "not JSON"),
        ("[]", 'none has "RGBPoints"'),
        ("[1, 2]", 'none has "RGBPoints"'),
        ('{"volumeProperties": [{}]}', "not as its schema"),
        ('{"RGBPoints": [0, 1, 2]}', '"RGBPoints" must be finite numbers, 4 for'),
        ('{"RGBPoints": "none"}', '"RGBPoints" must be finite numbers'),
        ('{"RGBPoints": [0, 1, 1, 1], "ColorSpace": "Munsell"}', "'Munsell'; read are RGB"),
        ("<a>", "not XML"),
        ("<a/>", "no <VolumeProperty>"),
        ('<ColorMaps><ColorMap name="x"/></ColorMaps>', "'x' has no <Point>"),
        ("<MRML><VolumeProperty name='x'/></MRML>", "'x' has no scalarOpacity"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "declares entities"),
    ],
)
def test_other_files_are_refused(saved, text, complaint):
    with pytest.raises(ArgumentError, match=f"{complaint}.*file.txt$"):
        ws.Look.load(saved(text))


def test_missing_files_are_file_errors(tmp_path):
    with pytest.raises(FileError, match="No such file"):
        ws.Look.load(tmp_path / "none.json")


def test_the_command_line_takes_them_all(wavesplat, ramp_file, saved, tmp_path):
    out = tmp_path / "a.png"
    for name, text in {"scene.xml#two": SCENE, "a.vp": VP, "map.json": [COLD_TO_HOT]}.items():
        saved(text, name.partition("#")[0])
        done = wavesplat("render", ramp_file, "-o", out, "--size", "8x8", "--tf", tmp_path / name)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
    done = wavesplat("render", ramp_file, "-o", out, "--tf", tmp_path / "scene.xml")
    assert "name one of: One, Two" in done.stderr


@pytest.mark.parametrize("number", ["", "red", "0,5"])
def test_points_of_paraview_that_are_no_numbers(tmp_path, number):
    path = tmp_path / "a.xml"
    path.write_text(f'<ColorMaps><ColorMap><Point x="0" r="{number}" g="0" b="0" o="1"/></ColorMap></ColorMaps>')
    with pytest.raises(ArgumentError, match="'r' of a <Point> is .*it must be a number: .*a.xml$"):
        ws.Look.load(path)


@pytest.mark.parametrize("name", [5, ["a"], {"a": 1}])
def test_the_name_of_a_look_is_a_text(tmp_path, name):
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"version": 1, "opacity": [[0, 0], [1, 1]], "color": [[0, 1, 1, 1]], "name": name}))
    with pytest.raises(ArgumentError, match="name.* is .*; give a text: .*a.json$"):
        ws.Look.load(path)


@pytest.mark.parametrize(
    "changed",
    [
        {"ColorSpace": ["Lab"]},
        {"RGBPoints": [0, 0, 0, 1, 1, float("nan"), 0, 0]},
        {"Points": [0, 0, 0.5, 0, 1, 1, 0.5, 1e999]},
    ],
)
def test_maps_of_paraview_that_cannot_be(tmp_path, changed):
    path = tmp_path / "a.json"
    path.write_text(json.dumps([{"Name": "a", "ColorSpace": "Lab", "RGBPoints": [0, 0, 0, 1, 1, 1, 0, 0], **changed}]))
    with pytest.raises(ArgumentError, match="is in the space|must be finite numbers"):
        ws.Look.load(path)


def test_the_background_of_a_look_is_a_colour(tmp_path):
    path = tmp_path / "a.json"
    curves = {"opacity": [[0, 0], [1, 1]], "color": [[0, 1, 1, 1]]}
    path.write_text(json.dumps({"version": 1, "transfer_function": curves, "background": "paper"}))
    with pytest.raises(ArgumentError, match="color is 'paper'.*a.json$"):
        ws.Look.load(path)
