"""Cameras and colour maps of ParaView's states, and one reader of transfer functions (simulation, F14)."""

import json

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

X = np.linspace(0, 1, 24)
VOLUME = ws.Volume(np.tile(10 ** (3 * X), (24, 24, 1)).astype(np.float32), spacing=(0.5, 0.5, 0.5))


def prop(owner, name, *values, choices=()):
    elements = "".join(f'<Element index="{k}" value="{value}"/>' for k, value in enumerate(values))
    entries = "".join(f'<Entry text="{text}" value="{k}"/>' for k, text in enumerate(choices))
    domain = f'<Domain name="enum" id="{owner}.{name}.enum">{entries}</Domain>' if choices else ""
    return (
        f'<Property name="{name}" id="{owner}.{name}" number_of_elements="{len(values)}">{elements}{domain}</Property>'
    )


def linked(owner, name, to):
    return f'<Property name="{name}" id="{owner}.{name}" number_of_elements="1"><Proxy value="{to}"/></Property>'


def proxy(group, kind, number, *properties):
    return f'<Proxy group="{group}" type="{kind}" id="{number}" servers="21">{"".join(properties)}</Proxy>'


def view(number, position, *, parallel=0):
    return proxy(
        "views",
        "RenderView",
        number,
        prop(number, "CameraPosition", *position),
        prop(number, "CameraFocalPoint", 5.75, 5.75, 5.75),
        prop(number, "CameraViewUp", 0, 0, 1),
        prop(number, "CameraViewAngle", 25),
        prop(number, "CameraParallelScale", 8.5),
        prop(number, "CameraParallelProjection", parallel),
    )


SPACES = ("RGB", "HSV", "Lab", "Diverging")
POINTS = (1, 0, 0, 1, 1000, 1, 0, 0)
OPACITIES = (1, 0, 0.5, 0, 100, 0.25, 0.5, 0, 1000, 1, 0.5, 0)


def state(*views, log=0, space=0, more=""):
    table = proxy(
        "lookup_tables",
        "PVLookupTable",
        4504,
        prop(4504, "ColorSpace", space, choices=SPACES),
        prop(4504, "RGBPoints", *POINTS),
        prop(4504, "UseLogScale", log),
        linked(4504, "ScalarOpacityFunction", 4503),
    )
    curve = proxy("piecewise_functions", "PiecewiseFunction", 4503, prop(4503, "Points", *OPACITIES))
    drawn = proxy(
        "representations",
        "UniformGridRepresentation",
        99,
        linked(99, "LookupTable", 4504),
        prop(99, "ScalarOpacityUnitDistance", 0.75),
    )
    names = '<Item id="4504" name="1.density.PVLookupTable"/>'
    seen = '<Item id="7" name="RenderView1"/><Item id="8" name="RenderView2"/>'
    return (
        f'<ParaView><ServerManagerState version="5.11.0">{"".join(views)}{table}{curve}{drawn}{more}'
        f'<ProxyCollection name="lookup_tables">{names}</ProxyCollection>'
        f'<ProxyCollection name="views">{seen}</ProxyCollection></ServerManagerState></ParaView>'
    )


PYTHON = """# state file generated using paraview version 5.11.0
import paraview
from paraview.simple import *
renderView1 = CreateView('RenderView')
renderView1.ViewSize = [800, 600]
renderView1.CameraPosition = [30.0, -20.0, 25.0]
renderView1.CameraFocalPoint = [5.75, 5.75, 5.75]
renderView1.CameraViewUp = [0.0, 0.0, 1.0]
renderView1.CameraParallelScale = 8.5
reader = XMLImageDataReader(registrationName='d.vti', FileName=['/data/d.vti'])
densityLUT = GetColorTransferFunction('density')
densityLUT.RGBPoints = [1.0, 0.0, 0.0, 1.0, 1000.0, 1.0, 0.0, 0.0]
densityLUT.ColorSpace = 'RGB'
densityPWF = GetOpacityTransferFunction('density')
densityPWF.Points = [1.0, 0.0, 0.5, 0.0, 100.0, 0.25, 0.5, 0.0, 1000.0, 1.0, 0.5, 0.0]
display = Show(reader, renderView1, 'UniformGridRepresentation')
display.LookupTable = densityLUT
display.ScalarOpacityUnitDistance = 0.75
"""


@pytest.fixture(params=["pvsm", "py"])
def path(request, tmp_path):
    path = tmp_path / f"state.{request.param}"
    path.write_text(PYTHON if request.param == "py" else state(view(7, (30, -20, 25))))
    return path


def test_cameras(path):
    camera = ws.Camera.load(path)
    assert camera.position == (30, -20, 25)
    assert camera.focal_point == (5.75, 5.75, 5.75)
    assert camera.view_up == (0, 0, 1)
    assert camera.view_angle == (25 if path.suffix == ".pvsm" else 30)
    ws.render(VOLUME, camera=camera, size=(20, 20))


def test_parallel_projections_and_names(tmp_path):
    path = tmp_path / "two.pvsm"
    path.write_text(state(view(7, (30, -20, 25)), view(8, (0, -40, 0), parallel=1)))
    with pytest.raises(ArgumentError, match=r"2 render views; name one of: RenderView1, RenderView2.*two\.pvsm$"):
        ws.Camera.load(path)
    camera = ws.Camera.load(path, "renderview2")
    assert (camera.parallel_scale, camera.view_angle) == (8.5, None)
    with pytest.raises(ArgumentError, match="no render view 'Other'"):
        ws.Camera.load(path, "Other")


def test_maps(path):
    look = ws.Look.load(path)
    function = look.transfer_function
    assert look.name == "density"
    assert function.opacity_unit == 0.75
    np.testing.assert_allclose(
        function([1, 100, 500.5, 1000])[:, 3], [0, 0.25, 0.25 + 0.75 * 400.5 / 900, 1], atol=1e-6
    )
    np.testing.assert_allclose(function([500.5])[0, :3], [0.5, 0, 0.5], atol=1e-6)
    assert ws.TransferFunction.load(path) == function


def test_maps_without_opacities_get_a_ramp_over_their_colours(tmp_path):
    path = tmp_path / "state.py"
    path.write_text("\n".join(line for line in PYTHON.splitlines() if "PWF" not in line))
    function = ws.TransferFunction.load(path)
    np.testing.assert_allclose(function([1, 500.5, 1000])[:, 3], [0, 0.5, 1], atol=1e-6)


def test_spaces_of_colours_may_be_numbers(tmp_path):
    path = tmp_path / "lab.pvsm"
    path.write_text(state(view(7, (0, 0, 9)), space=2).replace("<Entry", "<Other"))
    assert len(ws.TransferFunction.load(path).color) > 10


def test_logarithms_are_taken_over(tmp_path):
    path = tmp_path / "log.pvsm"
    path.write_text(state(view(7, (0, 0, 9)), log=1))
    function = ws.TransferFunction.load(path)
    middle = 10**1.5
    np.testing.assert_allclose(function([middle])[0, :3], [0.5, 0, 0.5], atol=0.01)
    np.testing.assert_allclose(function([100.0])[0, 3], 0.25, atol=1e-6)
    document = [{"ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 1, 1, 1, 0, 0], "UseLogScale": 1, "Name": "fraction"}]
    (tmp_path / "log.json").write_text(json.dumps(document))
    stretched = ws.TransferFunction.load(tmp_path / "log.json", VOLUME)
    np.testing.assert_allclose(stretched([middle])[0, :3], [0.5, 0, 0.5], atol=0.02)
    with pytest.raises(ArgumentError, match="logarithmic and begins at 0"):
        ws.TransferFunction.load(tmp_path / "log.json")


def test_one_reader_of_transfer_functions(tmp_path):
    """`TransferFunction.load` called the file that `--tf` takes "not an object"."""
    document = [{"ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 1, 9, 1, 0, 0], "Name": "map"}]
    (tmp_path / "map.json").write_text(json.dumps(document))
    function = ws.TransferFunction.load(tmp_path / "map.json")
    assert function == ws.Look.load(tmp_path / "map.json").transfer_function
    ws.Look.preset("ct-bone").save(tmp_path / "look.json")
    assert ws.TransferFunction.load(tmp_path / "look.json") == ws.Look.preset("ct-bone").transfer_function
    (tmp_path / "bad.json").write_text('[{"RGBPoints": [0, 1]}]')
    with pytest.raises(ArgumentError, match="must be finite numbers, 4 for every point"):
        ws.TransferFunction.load(tmp_path / "bad.json")


#: As versions from 5.13 on write it.
NEW_PYTHON = """# state file generated using paraview version 6.0.1
import paraview
paraview.compatibility.major = 6
from paraview.simple import *
renderView1 = CreateView('RenderView')
renderView1.Set(
    ViewSize=[800, 600],
    CameraPosition=[30.0, -20.0, 25.0],
    CameraFocalPoint=[5.75, 5.75, 5.75],
    CameraViewUp=[0.0, 0.0, 1.0],
)
renderView1.AxesGrid.Set(CameraPosition=[1.0, 1.0, 1.0])
densityLUT = GetColorTransferFunction('density')
densityLUT.Set(
    RGBPoints=GenerateRGBPoints(
        range_min=1.0,
        range_max=1000.0,
    ),
    ScalarRangeInitialized=1.0,
)
densityPWF = GetOpacityTransferFunction('density')
densityPWF.Set(Points=[1.0, 0.0, 0.5, 0.0, 1000.0, 1.0, 0.5, 0.0])
display = Show(reader, renderView1, 'UniformGridRepresentation')
display.Set(
    LookupTable=densityLUT,
    ScalarOpacityUnitDistance=0.75,
)
"""


def test_states_of_new_versions_set_several_properties_at_once(tmp_path):
    """They were not seen: the camera stood at (0, 0, 1), and colours were those of another map from 0 to 1."""
    path = tmp_path / "new.py"
    path.write_text(NEW_PYTHON)
    camera = ws.Camera.load(path)
    assert (camera.position, camera.view_up) == ((30, -20, 25), (0, 0, 1))
    function = ws.TransferFunction.load(path)
    assert function.opacity_unit == 0.75
    assert function.opacity[0] == (1, 0)
    assert function.color[0] == pytest.approx((1, 0.0564, 0.0564, 0.47))
    assert function.color[-1] == pytest.approx((1000, 0.59, 0.0767, 0.119475))
    path.write_text(NEW_PYTHON.replace("range_min", "preset_name='Viridis (matplotlib)', range_min"))
    viridis = ws.TransferFunction.from_colormap("viridis", clim=(1, 1000))
    values = np.linspace(1, 1000, 40)
    np.testing.assert_allclose(ws.TransferFunction.load(path)(values)[:, :3], viridis(values)[:, :3], atol=0.005)
    path.write_text(NEW_PYTHON.replace("version 6.0.1", "version 5.13.3").replace("major = 6", "major = 5"))
    np.testing.assert_allclose(ws.TransferFunction.load(path)([1])[0, :3], (0.231373, 0.298039, 0.752941), atol=1e-6)
    path.write_text(NEW_PYTHON.replace("range_min", "preset_name='Jet', range_min"))
    with pytest.raises(ArgumentError, match=r"names the colours 'Jet' and does not write them out; save it as \.pvsm"):
        ws.TransferFunction.load(path)


def test_views_whose_camera_is_not_written_are_refused(tmp_path):
    path = tmp_path / "view.py"
    path.write_text("from paraview.simple import *\nview = GetActiveViewOrCreate('RenderView')\nResetCamera(view)\n")
    with pytest.raises(ArgumentError, match="does not say where the camera of 'view' is; save the state"):
        ws.Camera.load(path)


def test_a_state_is_never_run(tmp_path):
    path = tmp_path / "evil.py"
    mark = tmp_path / "ran"
    path.write_text(
        PYTHON + f"open({str(mark)!r}, 'w').write('x')\nrenderView1.CameraPosition = [9.0, open('x'), 1.0]\n"
    )
    with pytest.raises(ArgumentError, match="CameraPosition of 'renderView1' is None"):
        ws.Camera.load(path)
    ws.Look.load(path)
    assert not mark.exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PYTHON + "densityLUT.ApplyPreset('Viridis (matplotlib)', True)\n", "changed by ApplyPreset"),
        ("from paraview.simple import *\nx = (\n", "not Python that can be read"),
        ("from paraview.simple import *\n", "no map of colours"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><ParaView>&b;</ParaView>', "declares entities"),
        ("<ParaView><ServerManagerState>", "not XML"),
    ],
)
def test_other_states_are_refused(tmp_path, text, message):
    path = tmp_path / "bad.txt"
    path.write_text(text)
    with pytest.raises(ArgumentError, match=f"{message}.*bad.txt$"):
        ws.Look.load(path)


def test_the_command_line_takes_both(wavesplat, path, tmp_path):
    VOLUME.save(tmp_path / "volume.nrrd")
    asked = ("--tf", f"{path}#density", "--camera", f"{path}#renderView1", "--size", "40x30", "-o", tmp_path / "a.png")
    done = wavesplat("render", tmp_path / "volume.nrrd", "--report", tmp_path / "a.json", *asked)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "a.json").read_text())
    told = told.get("report", told)
    assert told["camera"]["position"] == [30, -20, 25]
    assert told["look"]["name"] == "density"
