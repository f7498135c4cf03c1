"""`Surface`, `Lines`, `Points`, `SlicePlane`, `Frame`: what they take, and what they say of what they do not take."""

from __future__ import annotations

import pickle
from types import SimpleNamespace

import foreign_fakes
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._geometry.frame import ticks_of
from wavesplat._geometry.paint import table_of
from wavesplat._geometry.positions import chains_of
from wavesplat._geometry.shape_arrays import ShapeArrays, as_shapes, positions_in_view
from wavesplat._geometry.surface import smooth_normals
from wavesplat._looks.curves.colormaps import colors_of

ArgumentError = ws.errors.ArgumentError
SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
FACES = np.array([(0, 1, 2), (0, 2, 3)])


def octahedron(radius=1.0):
    vertices = radius * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    faces = [(a, b, c) if (a + b + c) % 2 == 0 else (b, a, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    return vertices, np.array(faces)


# Surfaces -------------------------------------------------------------------------------------------------------------


def test_a_surface_keeps_what_it_is_given_and_no_one_can_write_to_it():
    vertices, faces = SQUARE.copy(), FACES.copy()
    surface = ws.Surface(vertices, faces)
    vertices[:] = 9
    assert np.array_equal(surface.vertices, SQUARE)
    assert surface.faces.dtype == np.uint32
    assert np.array_equal(surface.faces, FACES)
    assert surface.bounds.tolist() == [[0, 0, 0], [1, 1, 0]]
    with pytest.raises(ValueError, match="read-only"):
        surface.vertices[0, 0] = 1


def test_smooth_normals_are_means_by_area_and_point_outwards():
    vertices, faces = octahedron()
    normals = smooth_normals(vertices, faces)
    assert np.abs(normals - vertices).max() < 1e-6
    # A vertex of a small face and of one a hundred times as large: nearly the large one's normal.
    corner = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, -0.01), (0, 0.01, 0)], float)
    (x, y, z) = smooth_normals(corner, np.array([(0, 1, 2), (0, 4, 3)]))[0]
    assert z > 0.9999
    assert abs(x) < 1e-3
    assert y == 0


@pytest.mark.parametrize("scale", [1e-160, 1e-9, 1.0, 1e9, 1e150])
def test_normals_do_not_depend_on_the_unit(scale):
    vertices, faces = octahedron()
    assert np.abs(smooth_normals(scale * vertices + scale, faces) - vertices).max() < 1e-5


def test_vertices_without_area_have_some_normal():
    normals = smooth_normals(np.array([*SQUARE, (7, 7, 7)]), FACES)
    assert np.abs(normals - (0, 0, 1)).max() < 1e-6


@pytest.mark.parametrize(
    ("arguments", "options", "said"),
    [
        ((SQUARE,), {}, r"faces is missing"),
        ((SQUARE, [(0, 1, 4)]), {}, r"faces\[0\] of the surface is \(0, 1, 4\), and there are 4 vertices"),
        ((SQUARE, [(0, 1, 2), (0, -1, 2)]), {}, r"faces\[1\] of the surface is \(0, -1, 2\)"),
        ((SQUARE, [(0, 1, 2, 3)]), {}, r"int64 of shape \(1, 4\).*quadrilaterals are two triangles"),
        ((SQUARE, np.array([(0.0, 1, 2)])), {}, r"faces of the surface is float64"),
        ((SQUARE, np.empty((0, 3), int)), {}, r"faces of the surface is empty"),
        ((SQUARE[:, :2], FACES), {}, r"vertices of the surface has shape \(4, 2\)"),
        ((np.empty((0, 3)), FACES), {}, r"vertices of the surface is empty"),
        (
            (np.where(SQUARE == 1, np.nan, SQUARE), FACES),
            {},
            r"vertices\[1\] of the surface is \(nan, 0, 0\), and 3 of 4",
        ),
        (("liver.stl",), {}, r"vertices is 'liver.stl'"),
        ((SQUARE, FACES), {"color": "reddish"}, r"color of the surface: color is 'reddish'"),
        ((SQUARE, FACES), {"color": np.zeros((3, 3))}, r"color of the surface has shape \(3, 3\)"),
        (
            (np.broadcast_to(0.0, (10**9, 3)), FACES),
            {},
            "vertices of the surface has 1,000,000,000 rows, and a shape has",
        ),
        ((SQUARE, np.broadcast_to(0, (10**9, 3))), {}, "faces of the surface has 1,000,000,000 rows"),
        ((SQUARE, FACES), {"color": [(0, 0, 0)] * 3 + [(0, 2, 0)]}, r"color\[3\] of the surface is \(0.0, 2.0, 0.0\)"),
        ((SQUARE, FACES), {"color": "red", "values": range(4)}, r"color and values of the surface both"),
        ((SQUARE, FACES), {"values": range(5)}, r"values of the surface has shape \(5,\), and there are 4"),
        ((SQUARE, FACES), {"values": [np.nan] * 4}, r"values of the surface are all NaN"),
        (
            (SQUARE, FACES),
            {"values": range(4), "cmap": "virdis"},
            r"cmap of the surface: unknown colour map 'virdis'.*virid",
        ),
        (
            (SQUARE, FACES),
            {"values": range(4), "clim": (3, 1)},
            r"clim of the surface is \(3, 1\).*smaller number first",
        ),
        ((SQUARE, FACES), {"clim": (1, 3)}, r"clim of the surface colours values; give values="),
        ((SQUARE, FACES), {"opacity": 1.5}, r"opacity of the surface is 1.5; give a number 0..1"),
        ((SQUARE, FACES), {"normals": "round"}, r"normals of the surface is 'round'"),
        ((SQUARE, FACES), {"normals": np.ones((3, 3))}, r"normals of the surface has shape \(3, 3\)"),
        ((SQUARE, FACES), {"lit": "yes"}, r"lit of the surface is 'yes'"),
        ((SQUARE, FACES), {"name": 5}, r"name of the surface is 5"),
        ((SQUARE, FACES), {"name": "wall", "opacity": "much"}, r"opacity of the surface 'wall' is 'much'"),
    ],
)
def test_what_is_wrong_with_a_surface_is_said(arguments, options, said):
    with pytest.raises(ArgumentError, match=said):
        ws.Surface(*arguments, **options)


def test_values_take_colours_of_a_map_and_nan_none():
    surface = ws.Surface(SQUARE, FACES, values=[10, 20, np.inf, 40], cmap="hot")
    assert surface.clim == (10, 40)
    assert np.isnan(surface.values).tolist() == [False, False, True, False]
    places, limits, table = surface._arrays()["paint"]["mapped"]
    assert limits == (0, 1)
    assert np.allclose(places[[0, 1, 3]], [0, 1 / 3, 1])
    assert np.abs(table[:, :3] - colors_of("hot")[1]).max() < 1e-6
    # Values whose difference float32 does not hold.
    late = ws.Surface(SQUARE, FACES, values=1.7e9 + np.arange(4))
    assert np.allclose(late._arrays()["paint"]["mapped"][0], np.arange(4) / 3)
    share = ws.Surface(SQUARE, FACES, values=range(4), clim=("10%", "90%"))
    assert np.allclose(share.clim, (0.3, 2.7))


def test_one_value_for_all_has_the_middle_of_the_map():
    surface = ws.Surface(SQUARE, FACES, values=[5.0] * 4)
    assert np.allclose(surface._arrays()["paint"]["mapped"][0], 0.5)


def test_tables_of_categories_have_steps():
    table = table_of("tab10")
    assert len(np.unique(table, axis=0)) == 10
    assert np.abs(table[0, :3] - colors_of("tab10")[1][0]).max() < 1e-6


def test_colours_by_vertex_may_be_bytes_and_translucent():
    surface = ws.Surface(SQUARE, FACES, color=np.array([(255, 0, 0, 51)] * 4, np.uint8))
    assert np.allclose(surface._arrays()["paint"]["rgba"], (1, 0, 0, 0.2))
    one = ws.Surface(SQUARE, FACES, color=(1, 0, 0, 0.5), opacity=0.5)._arrays()
    assert one["paint"]["rgb"] == (1, 0, 0)
    assert one["style"][0] == 0.25


def test_copies_have_other_fields():
    surface = ws.Surface(SQUARE, FACES, color="red")
    changed = surface.with_(opacity=0.5, color=None, values=range(4))
    assert (changed.opacity, changed.color) == (0.5, None)
    assert surface.opacity == 1
    with pytest.raises(ArgumentError, match="the surface has no 'colour' to change; it has vertices, faces, color"):
        surface.with_(colour="red")


# Lines ----------------------------------------------------------------------------------------------------------------


def test_lines_are_one_array_or_several():
    one, two = SQUARE, SQUARE[:3] + 5
    assert [len(path) for path in ws.Lines(one).paths] == [4]
    lines = ws.Lines([one, two, np.empty((0, 3))])
    assert [path.tolist() for path in lines.paths] == [one.tolist(), two.tolist()]
    assert lines.paths.starts.tolist() == [0, 4, 7]
    assert lines.bounds.tolist() == [[0, 0, 0], [6, 6, 5]]
    assert np.array_equal(ws.Lines(one.tolist()).paths[0], one)
    assert repr(lines) == "<Lines: 2 paths, 7 positions>"


def test_directions_are_colours():
    """Tractography's convention: red is left and right, green front and back, blue up and down."""
    path = np.array([(0, 0, 0), (5, 0, 0), (9, 0, 0)], float)
    back = np.array([(0, 0, 3), (0, 0, 1)], float)
    rgba = ws.Lines([path, back], color="direction")._arrays()["paint"]["rgba"]
    assert rgba.tolist() == [[1, 0, 0, 1]] * 3 + [[0, 0, 1, 1]] * 2
    turn = chains_of(np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0)], float), "paths").directions()
    assert np.allclose(turn, [(1, 0, 0), (0.5**0.5, 0.5**0.5, 0), (0, 1, 0)])


def test_values_are_by_position_or_by_path():
    paths = [SQUARE, SQUARE[:2]]
    assert ws.Lines(paths, values=[1, 2]).values.tolist() == [1, 1, 1, 1, 2, 2]
    assert ws.Lines(paths, values=[np.arange(4), np.arange(2)]).values.tolist() == [0, 1, 2, 3, 0, 1]
    assert ws.Lines(paths, color=[(1, 0, 0), (0, 0, 1)]).color[3:5, 0].tolist() == [1, 0]


def test_thickness_is_in_pixels_or_in_the_world():
    assert ws.Lines(SQUARE)._arrays()["width_px"] == 2
    arrays = ws.Lines(SQUARE, radius=0.5)._arrays()
    assert (arrays["radius"], arrays["width_px"]) == (0.5, None)
    assert ws.Lines(SQUARE, radius=0.5).bounds.tolist() == [[-0.5] * 3, [1.5, 1.5, 0.5]]


@pytest.mark.parametrize(
    ("paths", "options", "said"),
    [
        (5, {}, r"paths of the lines is 5"),
        ("a.trk", {}, r"paths of the lines is 'a.trk'"),
        ([], {}, r"paths of the lines has no path of at least two positions"),
        (SQUARE[:1], {}, r"no path of at least two positions"),
        ([SQUARE, SQUARE[:, :2]], {}, r"paths\[1\] of the lines has shape \(4, 2\)"),
        (
            [SQUARE, np.where(SQUARE == 1, np.inf, SQUARE)],
            {},
            r"paths\[1\] of the lines has \(inf, 0.0, 0.0\) as position 1",
        ),
        (SQUARE, {"radius": 1, "width": 2}, r"radius and width of the lines both"),
        (SQUARE, {"radius": -1}, r"radius of the lines is -1"),
        (SQUARE, {"width": [1, 2]}, r"width of the lines has shape \(2,\)"),
        (SQUARE, {"color": "direction", "values": range(4)}, r"color and values of the lines both"),
        (SQUARE, {"values": range(3)}, r"values of the lines has shape \(3,\), and there are 4"),
    ],
)
def test_what_is_wrong_with_lines_is_said(paths, options, said):
    with pytest.raises(ArgumentError, match=said):
        ws.Lines(paths, **options)


# Points ---------------------------------------------------------------------------------------------------------------


def test_points_have_sizes_in_pixels_or_radii():
    assert ws.Points(SQUARE)._arrays()["diameters_px"].tolist() == [6] * 4
    arrays = ws.Points(SQUARE, radius=[1, 2, 3, 4])._arrays()
    assert arrays["radii"].tolist() == [1, 2, 3, 4]
    assert arrays["diameters_px"] is None
    assert ws.Points(SQUARE, radius=[1, 2, 3, 4]).bounds.tolist() == [[-4, -3, -4], [4, 5, 4]]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"radius": [1, 2, 3]}, r"radius of the points has shape \(3,\)"),
        ({"radius": [1, 2, 3, 0]}, r"radius\[3\] of the points is 0"),
        ({"size": "big"}, r"size of the points is 'big'"),
        ({"radius": 1, "size": 2}, r"radius and size of the points both"),
        ({"labels": ["a", "b"]}, r"labels of the points has 2 names, and there are 4 points"),
        ({"labels": "abcd"}, r"labels of the points is 'abcd'"),
        ({"labels": ["a", "b", "c", "d\n"]}, r"labels\[3\] of the points is 'd\\n'"),
    ],
)
def test_what_is_wrong_with_points_is_said(options, said):
    with pytest.raises(ArgumentError, match=said):
        ws.Points(SQUARE, **options)


# Slices and frames ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: ws.SlicePlane(plane="oblique"), r"unknown plane 'oblique'"),
        (lambda: ws.SlicePlane(plane=((0, 0, 0), (0, 0, 0))), r"a normal that is not zero"),
        (lambda: ws.SlicePlane(plane=5), r"plane is 5"),
        (lambda: ws.SlicePlane(index=3, position=2.0), r"position and index of the slice plane both"),
        (lambda: ws.SlicePlane(index=1.5), r"index of the slice plane is 1.5; give a whole number"),
        (lambda: ws.SlicePlane(plane=((0, 0, 0), (0, 1, 1)), index=3), r"an oblique plane has none"),
        (lambda: ws.SlicePlane(cmap="virdis"), r"unknown colour map"),
        (lambda: ws.SlicePlane("ct.nii"), r"open it first"),
        (lambda: ws.Frame((0, 0, 0)), r"box of the frame is \(0, 0, 0\)"),
        (lambda: ws.Frame(((0, 0, 0), (1, 1, -1))), r"each number of the second larger"),
        (lambda: ws.Frame(ticks=1), r"ticks of the frame is 1; give True or False"),
        (lambda: ws.Frame(width=0), r"width of the frame is 0"),
        (lambda: ws.Frame(color="reddish"), r"color of the frame"),
    ],
)
def test_what_is_wrong_with_slices_and_frames_is_said(make, said):
    with pytest.raises(ArgumentError, match=said):
        make()


def test_ticks_are_round():
    assert ticks_of(0, 10) == [0, 2, 4, 6, 8, 10]
    assert ticks_of(-0.3, 1.1) == [-0.2, 0, 0.2, 0.4, 0.6, 0.8, 1.0]
    assert ticks_of(12345, 12346) == [12345, 12345.2, 12345.4, 12345.6, 12345.8, 12346]
    assert ticks_of(1, 1) == []


def test_a_slice_stands_where_its_samples_lie():
    samples = np.arange(4 * 5 * 6, dtype=np.float32).reshape(4, 5, 6)
    matrix = np.array([(1, 0, 0, 10), (0, 2, 0, 20), (0, 0, 3, 30), (0, 0, 0, 1.0)])
    volume = ws.Volume(samples, world_from_index=matrix)
    scene = ws.Scene(volume, geometry=[ws.SlicePlane(plane="xy", index=2, clim=(0, 119))])
    scene.render(size=(8, 8))
    (arrays,) = [made for _, made in scene._cache.shapes.values()]
    (card,) = arrays.cards
    # Half a pixel beyond the first and last samples, in the plane of slice 2.
    assert card["rgba"].shape == (9, 6, 4)
    assert np.allclose(card["corner"], (9.5, 19.5, 36))
    assert np.allclose(card["along_x"], (6, 0, 0))
    assert np.allclose(card["along_y"], (0, 9, 0))
    assert np.allclose(card["rgba"][::2, :, 0], samples[2] / 119, atol=1e-6)
    with pytest.raises(ArgumentError, match="index of the slice plane is 4, and there are 4 slices"):
        ws.Scene(volume, geometry=[ws.SlicePlane(plane="xy", index=4)]).render(size=(8, 8))


# Other libraries ------------------------------------------------------------------------------------------------------


def test_meshes_of_ours_bring_colour_name_and_normals():
    segmentation = np.zeros((9, 9, 9), np.uint8)
    segmentation[2:7, 2:7, 2:5], segmentation[2:7, 2:7, 5:7] = 1, 2
    looks = {1: ws.Label("red", name="a"), 2: ws.Label("blue", name="b")}
    meshes = ws.mesh(ws.Labels(segmentation, looks), labels="all")
    scene = ws.Scene(ws.Volume(segmentation), geometry=[meshes, ws.Surface(meshes["a"], color="green", opacity=0.5)])
    assert [(shape.name, shape.color[:3]) for shape in scene.geometry] == [
        ("a", (1, 0, 0)),
        ("b", (0, 0, 1)),
        ("a", (0, 1, 0)),
    ]
    assert np.abs(np.linalg.norm(scene.geometry[0].normals, axis=1) - 1).max() < 1e-5
    assert ws.Surface(meshes["a"], normals="flat")._arrays()["normals"] is None


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((1, 2, 3))
    assert np.array_equal(ws.Surface(box).vertices, box.vertices)
    box.visual.vertex_colors = np.tile(np.array([255, 0, 0, 255], np.uint8), (len(box.vertices), 1))
    assert ws.Surface(box).color[0].tolist() == [1, 0, 0, 1]
    cloud = trimesh.PointCloud(box.vertices)
    (points,) = as_shapes([cloud])
    assert isinstance(points, ws.Points)


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    sphere = pyvista.Sphere(theta_resolution=8, phi_resolution=8)
    sphere["height"] = sphere.points[:, 2]
    surface = ws.Surface(sphere, values="height")
    assert np.array_equal(surface.vertices, sphere.points.astype(float))
    assert np.array_equal(surface.faces, sphere.faces.reshape(-1, 4)[:, 1:])
    assert np.allclose(surface.values, sphere.points[:, 2])
    with pytest.raises(ArgumentError, match="no array 'width'; there are: Normals, height"):
        ws.Surface(sphere, values="width")
    quads = pyvista.Plane(i_resolution=1, j_resolution=1)
    assert ws.Surface(quads).faces.shape == (2, 3)
    strip = pyvista.Plane(i_resolution=4, j_resolution=4).triangulate().strip()
    area = np.linalg.norm(
        np.cross(*np.diff(ws.Surface(strip).vertices[ws.Surface(strip).faces], axis=1).swapaxes(0, 1)), axis=1
    )
    assert np.isclose(area.sum() / 2, 1)
    lines = pyvista.MultipleLines(SQUARE) + pyvista.MultipleLines(SQUARE + 3)
    (made,) = as_shapes(lines)
    assert [len(path) for path in made.paths] == [4, 4]
    (cloud,) = as_shapes(pyvista.PolyData(SQUARE))
    assert isinstance(cloud, ws.Points)
    with pytest.raises(ArgumentError, match="has no triangles; draw its lines with"):
        ws.Surface(lines)


def test_nibabel():
    streamlines = pytest.importorskip("nibabel.streamlines")
    tracts = [SQUARE.astype("f4"), SQUARE[:2].astype("f4")]
    tractogram = streamlines.Tractogram(tracts, affine_to_rasmm=np.eye(4))
    for given in (tractogram, tractogram.streamlines):
        (lines,) = as_shapes([given])
        assert [path.tolist() for path in lines.paths] == [tract.tolist() for tract in tracts]


class _Layer(SimpleNamespace):
    """A layer of napari: scaled by 2, 3 and 4 along z, y and x."""

    def data_to_world(self, point):
        scale = np.array([1, 1, 2, 3, 4.0])[-len(point) :]
        return scale * point


def _layer(kind, **fields):
    made = type(kind, (_Layer,), {})
    return foreign_fakes.of_library("napari")(made)(name="mine", **fields)


def test_napari():
    points = ws.Points(_layer("Points", data=np.array([(1, 2, 3.0)])))
    assert points.positions.tolist() == [[12, 6, 2]]
    assert points.name == "mine"
    surface = ws.Surface(_layer("Surface", data=(SQUARE, FACES, np.arange(4.0))))
    assert surface.vertices.tolist() == (SQUARE[:, ::-1] * (4, 3, 2)).tolist()
    assert surface.values.tolist() == [0, 1, 2, 3]
    plain = ws.Surface((SQUARE, FACES))
    assert plain.vertices.tolist() == SQUARE[:, ::-1].tolist()
    tracks = np.array([(7, 1, 0, 0, 1), (7, 0, 0, 0, 0), (8, 0, 1, 1, 1), (8, 1, 2, 2, 2.0)])
    lines = ws.Lines(_layer("Tracks", data=tracks))
    assert [path.tolist() for path in lines.paths] == [[[0, 0, 0], [4, 0, 0]], [[4, 3, 2], [8, 6, 4]]]
    corners = np.array([(0, 0), (0, 2), (2, 2), (2, 0.0)])
    shapes = _layer("Shapes", data=[corners, corners[:2], corners], shape_type=["rectangle", "line", "ellipse"])
    rectangle, line, ellipse = ws.Lines(shapes).paths
    assert rectangle.tolist() == [[0, 0, 0], [8, 0, 0], [8, 6, 0], [0, 6, 0], [0, 0, 0]]
    assert len(line) == 2
    assert np.allclose(((ellipse - (4, 3, 0)) / (4, 3, 1) ** np.array(1.0))[:, :2] ** 2 @ (1, 1), 1)
    with pytest.raises(ArgumentError, match="a layer of Points has no lines"):
        ws.Lines(_layer("Points", data=np.zeros((1, 3))))


# Scenes ---------------------------------------------------------------------------------------------------------------


def volume():
    return ws.Volume(np.random.default_rng(0).random((8, 9, 10), np.float32), spacing=(1, 1, 1))


def test_geometry_stands_among_layers_or_apart():
    ball, line = ws.Points([(1, 1, 1)]), ws.Lines(SQUARE)
    scene = ws.Scene([volume(), ball], geometry=line)
    assert scene.geometry == (ball, line)
    assert len(scene.layers) == 1
    assert scene.with_(background="white").geometry == (ball, line)
    assert scene.with_(geometry=()).geometry == ()
    again = pickle.loads(pickle.dumps(scene))  # noqa: S301 - our own
    assert np.array_equal(again.geometry[0].positions, ball.positions)
    report = ws.render(scene, size=(8, 8), geometry=ws.Frame()).report
    assert [shape["kind"] for shape in report["geometry"]] == ["points", "lines", "frame"]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: ws.Scene(ws.Points([(1, 1, 1)])), "stands in space with volumes; give one too"),
        (lambda: ws.Scene([ws.Points([(1, 1, 1)])]), "the scene has geometry and no volume"),
        (lambda: ws.Scene(volume(), geometry=[5]), "geometry has 5; give wavesplat.Surface"),
        (lambda: ws.Scene(volume(), geometry="liver.stl"), "geometry has 'liver.stl'"),
    ],
)
def test_what_is_wrong_with_geometry_is_said(make, said):
    with pytest.raises(ArgumentError, match=said):
        make()


def test_arrays_are_made_once_for_a_scene():
    scene = ws.Scene([volume(), ws.Surface(*octahedron(3)), ws.Frame()])
    scene.render("front", size=(8, 8))
    ((_, made),) = scene._cache.shapes.values()
    scene.with_(background="white").render("left", size=(8, 8))
    ((_, again),) = scene._cache.shapes.values()
    assert again is made
    assert made.core is again.core
    scene.with_(geometry=scene.geometry[:1]).render("left", size=(8, 8))
    ((_, other),) = scene._cache.shapes.values()
    assert other is not made


def test_grids_are_kept_for_each_side_that_they_lie_on():
    scene = ws.Scene([volume(), ws.Frame(grid=True)])
    for view in ("front", "front", "back"):
        scene.render(ws.Camera.view(scene, view).turned(20, 20), size=(8, 8))
    assert len(scene._cache.shapes) == 2
    front, back = (made.paths[1]["positions"] for _, made in scene._cache.shapes.values())
    assert not np.array_equal(front, back)


def test_arrays_travel():
    scene = ws.Scene([volume(), ws.Surface(*octahedron(3), values=range(6)), ws.Points(SQUARE), ws.Lines(SQUARE)])
    scene.render(size=(8, 8))
    ((_, made),) = scene._cache.shapes.values()
    again = pickle.loads(pickle.dumps(made))  # noqa: S301 - our own
    assert isinstance(again, ShapeArrays)
    assert again._core is None
    assert again.n_bytes == made.n_bytes > 0
    assert again.core.bounds() == made.core.bounds()


def test_cameras_are_fitted_to_what_lies_beside_the_volume_but_not_far_from_it():
    box = volume()
    camera = ws.Scene(box).render("front", size=(40, 40)).camera
    beside = ws.Scene([box, ws.Points([(18, 4, 4)], radius=1)]).render("front", size=(40, 40)).camera
    far = ws.Scene([box, ws.Points([(1e6, 4, 4)])]).render("front", size=(40, 40)).camera
    assert far.parallel_scale == camera.parallel_scale
    assert beside.parallel_scale > 1.5 * camera.parallel_scale
    (pixel,), _ = beside.project([(18, 4, 4)], size=(40, 40))
    assert (pixel > 0).all()
    assert (pixel < 39).all()
    bounds = np.array([(0, 0, 0), (9, 8, 7)])
    many = ws.Points(np.random.default_rng(0).random((100_000, 3)) * 9, radius=0.5)
    seen = positions_in_view([many], bounds, box)
    assert len(seen) < 130_000
    assert np.allclose([seen.min(axis=0), seen.max(axis=0)], many.bounds)
