"""`open_geometry`: every format, compared with the library that wrote it, and what is said of files that are wrong."""

from __future__ import annotations

import struct
import warnings

import numpy as np
import pytest

import wavesplat as ws

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

FileError, ArgumentError = ws.errors.FileError, ws.errors.ArgumentError


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def ball():
    trimesh = pytest.importorskip("trimesh")
    return trimesh.creation.icosphere(2, 10)


def tetrahedra(vertices, faces):
    """Triangles as sets of corners, whatever their order."""
    return np.array(
        sorted(np.sort(np.round(np.asarray(vertices)[np.asarray(faces)], 4), axis=1).reshape(-1, 9).tolist())
    )


# Meshes ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["stl", "ply", "obj", "off", "glb", "3mf"])
def test_meshes_of_trimesh(here, suffix):
    mesh = ball()
    mesh.export(f"ball.{suffix}")
    surface = ws.open_geometry(f"ball.{suffix}", color="red", opacity=0.5)
    assert isinstance(surface, ws.Surface)
    # STL repeats its vertices in each triangle; smooth normals need them once.
    assert surface.vertices.shape == (162, 3)
    assert np.abs(tetrahedra(surface.vertices, surface.faces) - tetrahedra(mesh.vertices, mesh.faces)).max() < 2e-3
    assert (surface.color, surface.opacity) == ((1, 0, 0, 1), 0.5)


def test_text_stl_and_what_slicer_says_of_its_axes(here):
    pytest.importorskip("trimesh")
    facet = "facet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 2 2 3\nvertex 1 3 3\nendloop\nendfacet\n"
    (here / "a.stl").write_text(f"solid SPACE=LPS\n{facet}endsolid\n", encoding="ascii")
    surface = ws.open_geometry("a.stl")
    assert surface.bounds.tolist() == [[-2, -3, 3], [-1, -2, 3]]
    assert surface.guesses == ("turned from LPS, as its header says, to RAS",)
    assert ws.open_geometry("a.stl", world_unit="mm").guesses[1].startswith("positions are taken in mm")


def test_values_of_a_ply_file(here):
    pyvista = pytest.importorskip("pyvista")
    pytest.importorskip("trimesh")
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    header += "property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (here / "a.ply").write_text(header + "0 0 0 1\n1 0 0 2\n0 1 0 3.5\n3 0 1 2\n", encoding="ascii")
    surface = ws.open_geometry("a.ply", values="heat")
    assert surface.values.tolist() == [1, 2, 3.5]
    assert surface.vertices.tolist() == pyvista.read("a.ply").points.tolist()
    with pytest.raises(ArgumentError, match="no values 'cold'; there are: heat: a.ply"):
        ws.open_geometry("a.ply", values="cold")


def test_gltf_in_several_files_is_refused_with_the_way_out(here):
    pytest.importorskip("trimesh")
    (here / "ball.gltf").write_text('{"asset": {"version": "2.0"}, "buffers": [{"uri": "ball.bin"}]}', encoding="ascii")
    with pytest.raises(FileError, match="its numbers lie in other files .*export it as .glb, in one file: ball.gltf"):
        ws.open_geometry("ball.gltf")


@pytest.mark.parametrize("suffix", ["vtp", "vtk", "ply", "stl"])
def test_meshes_of_pyvista(here, suffix):
    pyvista = pytest.importorskip("pyvista")
    pytest.importorskip("trimesh")
    mesh = pyvista.Sphere(theta_resolution=9, phi_resolution=7)
    mesh["height"] = mesh.points[:, 2]
    mesh.save(f"a.{suffix}")
    values = "height" if suffix.startswith("v") else None
    surface = ws.open_geometry(f"a.{suffix}", values=values)
    again = pyvista.read(f"a.{suffix}")
    faces = again.faces.reshape(-1, 4)[:, 1:]
    assert np.allclose(tetrahedra(surface.vertices, surface.faces), tetrahedra(again.points, faces))
    if values:
        assert np.array_equal(surface.values, again["height"].astype(float))


def test_lines_points_and_grids_of_vtk(here):
    pyvista = pytest.importorskip("pyvista")
    corners = np.random.default_rng(0).random((7, 3)).astype("f4")
    both = pyvista.MultipleLines(corners[:4]) + pyvista.MultipleLines(corners[4:])
    both["t"] = np.arange(7.0)
    both.save("lines.vtp")
    lines = ws.open_geometry("lines.vtp", values="t", radius=0.1)
    assert [path.tolist() for path in lines.paths] == [corners[:4].tolist(), corners[4:].tolist()]
    assert lines.values.tolist() == list(range(7))
    pyvista.PolyData(corners).save("points.vtp")
    assert ws.open_geometry("points.vtp").positions.tolist() == corners.tolist()
    grid = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    grid.save("grid.vtu")
    outer = ws.open_geometry("grid.vtu")
    assert outer.bounds.tolist() == [[0, 0, 0], [2, 2, 2]]
    assert len(outer.faces) == 6 * 4 * 2
    with pytest.raises(ArgumentError, match="has no triangles"):
        ws.open_geometry("lines.vtp", kind="surface")


# Brains ---------------------------------------------------------------------------------------------------------------

VOLUME_INFO = {
    "head": [2, 0, 20],
    "valid": "1  # volume info valid",
    "filename": "orig.mgz",
    "volume": [256, 256, 256],
    "voxelsize": [1.0, 1.0, 1.0],
    "xras": [-1.0, 0.0, 0.0],
    "yras": [0.0, 0.0, -1.0],
    "zras": [0.0, 1.0, 0.0],
    "cras": [3.0, -4.0, 5.0],
}


def pial(name="lh.pial", **changes):
    freesurfer = pytest.importorskip("nibabel.freesurfer")
    mesh = ball()
    freesurfer.write_geometry(name, mesh.vertices, mesh.faces, volume_info=VOLUME_INFO | changes)
    return mesh


def test_surfaces_of_freesurfer_lie_in_the_scanner(here):
    mesh = pial()
    surface = ws.open_geometry("lh.pial")
    assert np.abs(surface.vertices - mesh.vertices - (3, -4, 5)).max() < 1e-5
    assert np.array_equal(surface.faces, mesh.faces)
    assert surface.guesses == ("moved by c_ras (3, -4, 5) mm into the scanner's world",)
    # In micrometres, as a scene of these wants it.
    assert np.abs(ws.open_geometry("lh.pial", world_unit="um").vertices - 1e3 * surface.vertices).max() < 1e-6


def test_axes_of_freesurfers_volume_turn_the_surface(here):
    """vox2ras of the header times the inverse of tkregister's, with the slices across another axis."""
    axes = {"xras": [0.0, 0.0, 1.0], "yras": [-1.0, 0.0, 0.0], "zras": [0.0, 1.0, 0.0]}
    mesh = pial(**axes)
    own = np.eye(4)
    own[:3, :3] = np.array(list(axes.values())).T
    own[:3, 3] = np.array(VOLUME_INFO["cras"]) - own[:3, :3] @ (128, 128, 128)
    tkregister = np.array([(-1, 0, 0, 128), (0, 0, 1, -128), (0, -1, 0, 128), (0, 0, 0, 1.0)])
    matrix = own @ np.linalg.inv(tkregister)
    expected = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    assert np.abs(ws.open_geometry("lh.pial").vertices - expected).max() < 1e-4


def test_a_surface_without_its_volume_stays_where_it_is(here):
    mesh = pial(valid="0  # volume info invalid")
    surface = ws.open_geometry("lh.pial")
    assert np.abs(surface.vertices - mesh.vertices).max() < 1e-5
    assert surface.guesses[0].startswith("FreeSurfer's own coordinates")


def test_values_and_labels_beside_a_surface(here, tmp_path_factory, monkeypatch):
    freesurfer = pytest.importorskip("nibabel.freesurfer")
    mesh = pial()
    n = len(mesh.vertices)
    freesurfer.write_morph_data("lh.thickness", mesh.vertices[:, 0])
    table = np.array([(255, 0, 0, 0, 1), (0, 255, 0, 0, 2), (0, 0, 255, 0, 3)])
    freesurfer.write_annot("lh.aparc.annot", np.arange(n) % 3, table, ["a", "b", "c"], fill_ctab=True)
    np.savetxt("lh.txt", np.arange(n))
    assert np.allclose(ws.open_geometry("lh.pial", values="lh.thickness").values, mesh.vertices[:, 0], atol=1e-5)
    assert ws.open_geometry("lh.pial", values="lh.aparc.annot").color[:4, :3].tolist() == [
        *np.eye(3).tolist(),
        [1, 0, 0],
    ]
    assert ws.open_geometry("lh.pial", values="lh.txt").values[5] == 5
    # From elsewhere, by a name beside the surface.
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert ws.open_geometry(here / "lh.pial", values="lh.txt")._source["values"] == "lh.txt"
    np.savetxt(here / "few.txt", np.arange(5))
    with pytest.raises(FileError, match="values of 5 vertices, and the surface has 162"):
        ws.open_geometry(here / "lh.pial", values="few.txt")
    with pytest.raises(ArgumentError, match="values is 'lh.curv', and there is no such file"):
        ws.open_geometry(here / "lh.pial", values="lh.curv")


def test_gifti(here):
    nib = pytest.importorskip("nibabel")
    mesh = ball()

    def array(data, intent, kind, **options):
        return nib.gifti.GiftiDataArray(np.asarray(data).astype(kind), intent=intent, **options)

    faces = array(mesh.faces, "NIFTI_INTENT_TRIANGLE", "i4")
    nib.save(nib.gifti.GiftiImage(darrays=[array(mesh.vertices, "NIFTI_INTENT_POINTSET", "f4"), faces]), "a.surf.gii")
    nib.save(nib.gifti.GiftiImage(darrays=[array(mesh.vertices[:, 1], "NIFTI_INTENT_SHAPE", "f4")]), "a.shape.gii")
    surface = ws.open_geometry("a.surf.gii", values="a.shape.gii")
    assert np.abs(surface.vertices - mesh.vertices).max() < 1e-5
    assert np.abs(surface.values - mesh.vertices[:, 1]).max() < 1e-5
    with pytest.raises(
        FileError, match="it holds values and no surface; open the surface, and give this file as values=: a.shape.gii"
    ):
        ws.open_geometry("a.shape.gii")
    meta = nib.gifti.GiftiMetaData({f"VolGeomC_{axis}": str(k) for k, axis in enumerate("RAS", 1)})
    system = nib.gifti.GiftiCoordSystem(0, 0, np.eye(4))
    points = array(mesh.vertices, "NIFTI_INTENT_POINTSET", "f4", coordsys=system, meta=meta)
    nib.save(nib.gifti.GiftiImage(darrays=[points, faces]), "b.gii")
    moved = ws.open_geometry("b.gii")
    assert np.abs(moved.vertices - mesh.vertices - (1, 2, 3)).max() < 1e-5
    assert moved.guesses == ("moved by c_ras (1, 2, 3) mm into the scanner's world",)


# Tracts and neurons ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["trk", "tck"])
def test_tracts(here, suffix):
    streamlines = pytest.importorskip("nibabel.streamlines")
    tracts = [np.random.default_rng(n).random((n, 3)).astype("f4") * 20 for n in (5, 9, 2)]
    matrix = np.array([(-2, 0, 0, 30), (0, 2, 0, -5), (0, 0, 3, 7), (0, 0, 0, 1.0)])
    header = {"voxel_to_rasmm": matrix, "voxel_sizes": (2, 2, 3), "dimensions": (20, 20, 20), "voxel_order": "LAS"}
    data = {"data_per_streamline": {"fa": np.array([[0.1], [0.2], [0.3]])}} if suffix == "trk" else {}
    tractogram = streamlines.Tractogram(tracts, affine_to_rasmm=np.eye(4), **data)
    streamlines.save(tractogram, f"a.{suffix}", header=header if suffix == "trk" else None)
    lines = ws.open_geometry(f"a.{suffix}", color="direction")
    assert all(np.abs(path - tract).max() < 1e-5 for path, tract in zip(lines.paths, tracts, strict=True))
    assert lines.color == "direction"
    if suffix == "trk":
        values = ws.open_geometry("a.trk", values="fa").values
        assert np.allclose(values, np.repeat([0.1, 0.2, 0.3], [5, 9, 2]))
    with pytest.raises(ArgumentError, match="the tracts have no values 'md'"):
        ws.open_geometry(f"a.{suffix}", values="md")


def test_neurons(here):
    (here / "n.swc").write_text(
        "# a cell\n1 1 0 0 0 2 -1\n2 3 1 0 0 1 1\n3 3 2 0 0 1 2\n4 3 3 1 0 1 3\n5 3 3 -1 0 1 3\n", encoding="ascii"
    )
    neuron = ws.open_geometry("n.swc", values="type")
    paths = [path.tolist() for path in neuron.paths]
    assert paths == [[[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[2, 0, 0], [3, 1, 0]], [[2, 0, 0], [3, -1, 0]]]
    assert neuron.values.tolist() == [1, 3, 3, 3, 3, 3, 3]
    assert neuron.radius == pytest.approx(8 / 7)
    assert np.allclose(ws.open_geometry("n.swc", world_unit="mm").paths[0][2], (0.002, 0, 0))
    for rows, said in (
        ("1 1 0 0 0 1 2\n2 1 0 0 0 1 1\n", "no branch of two points|own ancestors"),
        ("1 1 0 0 0 1 1\n", "its own parent"),
        ("1 1 0 0\n", "no 7 numbers"),
        ("1 1 0 0 0 1 -1\n1 1 0 0 0 1 -1\n", "two of its points have one number"),
    ):
        (here / "bad.swc").write_text(rows, encoding="ascii")
        with pytest.raises(FileError, match=rf"({said}).*; mend the rows, or export the neuron again"):
            ws.open_geometry("bad.swc")


# Tables ---------------------------------------------------------------------------------------------------------------


def table(here, text, name="t.csv"):
    (here / name).write_text(text, encoding="utf-8")
    return name


@pytest.mark.parametrize(
    ("header", "world_unit", "expected"),
    [
        ("x,y,z", None, (1, 2, 3)),
        ("X,Y,Z", "mm", (1, 2, 3)),
        ("x_um,y_um,z_um", "mm", (1e-3, 2e-3, 3e-3)),
        ("x [mm],y [mm],z [mm]", "um", (1000, 2000, 3000)),
        ("x (µm),y (µm),z (nm)", "um", (1, 2, 0.003)),
        ("Position X,Position Y,Position Z", None, (1, 2, 3)),
        ("axis-0,axis-1,axis-2", None, (3, 2, 1)),
        ("centroid-0,centroid-1,centroid-2", None, (3, 2, 1)),
        ("z_um,y_um,x_um", "um", (3, 2, 1)),
    ],
)
def test_columns_are_known_by_name(here, header, world_unit, expected):
    points = ws.open_geometry(table(here, f"{header}\n1,2,3\n1,2,3\n"), world_unit=world_unit)
    assert isinstance(points, ws.Points)
    assert np.allclose(points.positions, [expected] * 2, rtol=1e-12)


def test_tables_of_a_plane_and_of_times(here):
    plane = ws.open_geometry(table(here, "x;y\n1;2\n"))
    assert plane.positions.tolist() == [[1, 2, 0]]
    assert plane.guesses == ("z is 0: the table has x and y alone",)
    times = ws.open_geometry(table(here, "index,axis-0,axis-1,axis-2,axis-3\n0,9,1,2,3\n"))
    assert times.positions.tolist() == [[3, 2, 1]]
    assert "axis-3 as x, axis-2 as y, axis-1 as z" in times.guesses[0]


def test_trackmate(here):
    rows = "".join(f"S{i},{i},{i % 2},1,{i},{i + 1},{i + 2},{9 - i},2.5\n" for i in range(6))
    text = (
        "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,FRAME,RADIUS\n"
        "Label,Spot ID,Track ID,Quality,X,Y,Z,Frame,Radius\n"
        "Label,Spot ID,Track ID,Quality,X,Y,Z,Frame,R\n"
        ",,,(quality),(micron),(micron),(micron),,(micron)\n"
        f"{rows}S9,9,,1,1,2,3,1,2\n"
    )
    tracks = ws.open_geometry(table(here, text), values="FRAME", world_unit="mm")
    assert isinstance(tracks, ws.Lines)
    # In the order of their frames, which here is the other way round.
    assert np.allclose(tracks.paths[0], np.array([(4, 5, 6), (2, 3, 4), (0, 1, 2)]) * 1e-3)
    assert tracks.values.tolist() == [5, 7, 9, 4, 6, 8]
    assert tracks.guesses == ("1 of 7 rows left out: x, y, z or the track is no number",)
    spots = ws.open_geometry("t.csv", kind="points", world_unit="mm")
    assert np.allclose(spots.radius, [2.5e-3] * 6 + [2e-3])
    assert ws.open_geometry("t.csv", kind="points", size=4).radius is None


def test_imaris_and_electrodes(here):
    text = "Position\n====================\n\nPosition X,Position Y,Position Z,Unit,Time,TrackID,ID,\n"
    lines = ws.open_geometry(table(here, f"{text}1,2,3,um,1,1000,0,\n2,3,4,um,2,1000,1,\n"), world_unit="mm")
    assert np.allclose(lines.paths[0], [(0.001, 0.002, 0.003), (0.002, 0.003, 0.004)])
    bids = ws.open_geometry(table(here, "name\tx\ty\tz\nA1\t1\t2\t3\nA2\tn/a\t2\t3\nA3\t4\t5\t6\n", "e.tsv"))
    assert bids.labels == ("A1", "A3")
    assert bids.positions.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert bids.guesses[0].startswith("1 of 3 rows left out")


def test_parquet(here):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({"x_um": [1.0, 4.0], "y_um": [2.0, 5.0], "z_um": [3.0, 6.0]}), "t.parquet")
    assert ws.open_geometry("t.parquet", world_unit="um").positions.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("a,b\n1,2\n", {}, "the table has no columns x, y, z; it has a, b; name them"),
        ("x,y,z\n", {}, "no row of the table has numbers as x, y and z"),
        ("x,y,z\na,b,c\n", {}, "no row of the table has numbers as x, y and z"),
        ("x,y,z\n1,2\n1,2\n", {}, "2 of 2 rows have not the 3 cells of the header"),
        ("x,y,z\n1,2,3\n", {"values": "speed"}, "no column 'speed'; its columns are x, y, z"),
        ("x,y,z,track\n1,2,3,\n", {}, "no row of the table belongs to a track"),
        ("x,y,z\n1,2,3\n", {"kind": "surface"}, "the file holds points, and a surface is asked for"),
        ("x,y,z\n1,2,3\n", {"kind": "cube"}, "kind is 'cube'; use one of: surface, lines, points"),
        ("x_mm,y_mm,z_mm\n1,2,3\n", {"unit": "um"}, "unit is 'um', and the file's own is 'mm'"),
        ("x,y,z\n1,2,3\n", {"colour": "red"}, "points has no 'colour'; it has positions, color"),
        ("x,y,z\n1,2,3\n", {"radius": -1}, "radius of the points is -1"),
        ("x,y,z,track\n1,2,3,4\n", {}, "no path of at least two positions"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(here, text, options, said):
    with pytest.raises((FileError, ArgumentError), match=said) as caught:
        ws.open_geometry(table(here, text), **options)
    assert str(caught.value).endswith("t.csv") or "kind is" in str(caught.value)


# Files that are wrong -------------------------------------------------------------------------------------------------


def test_files_that_are_not_there_or_of_no_kind(here):
    with pytest.raises(FileError, match="no such file or folder"):
        ws.open_geometry("a.stl")
    (here / "a.stl").write_bytes(b"")
    with pytest.raises(FileError, match="the file is empty"):
        ws.open_geometry("a.stl")
    (here / "a.xyz").write_bytes(b"1 2 3\n")
    with pytest.raises(FileError, match=r"the suffix '.xyz' is unknown; .*\.stl.*FreeSurfer"):
        ws.open_geometry("a.xyz")
    with pytest.raises(FileError, match="this is a folder|not a file|a directory"):
        ws.open_geometry(here)


def test_a_header_that_promises_too_much(here):
    pytest.importorskip("trimesh")
    (here / "a.stl").write_bytes(b"\0" * 80 + struct.pack("<I", 2**31) + b"\0" * 50)
    with pytest.raises(FileError, match="promises 2147483648 triangles"):
        ws.open_geometry("a.stl")


def _written(here):
    """A file of each format, small."""
    pyvista = pytest.importorskip("pyvista")
    streamlines = pytest.importorskip("nibabel.streamlines")
    mesh = ball()
    for suffix in ("stl", "ply", "obj", "off", "glb", "3mf"):
        mesh.export(f"a.{suffix}")
    sphere = pyvista.Sphere(theta_resolution=6, phi_resolution=6)
    for suffix in ("vtp", "vtk"):
        sphere.save(f"b.{suffix}")
    pial("c.pial")
    tractogram = streamlines.Tractogram([np.zeros((3, 3), "f4"), np.ones((4, 3), "f4")], affine_to_rasmm=np.eye(4))
    for suffix in ("trk", "tck"):
        streamlines.save(tractogram, f"d.{suffix}")
    table(here, "x,y,z\n" + "1,2,3\n" * 20, "e.csv")
    (here / "f.swc").write_text("1 1 0 0 0 2 -1\n2 3 1 0 0 1 1\n3 3 2 0 0 1 2\n", encoding="ascii")
    return sorted(path for path in here.iterdir() if path.is_file())


def _message(path):
    """Message of the error for a file that cannot be read; None for one that can."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            ws.open_geometry(path)
        except ws.errors.WavesplatError as error:
            return str(error)
    return None


PLY = (
    "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)


def test_meshes_of_text_that_broke_off(here):
    """Anywhere: none opens as a smaller shape, or as another kind of shape."""
    trimesh = pytest.importorskip("trimesh")
    (here / "a.ply").write_text(PLY.format(1_000_000_000))
    with pytest.raises(FileError, match="truncated: its header promises 1000000000 of vertex and 1 of face"):
        ws.open_geometry("a.ply")
    (here / "a.ply").write_text(PLY.format(3))
    assert isinstance(ws.open_geometry("a.ply"), ws.Surface)
    mesh = trimesh.creation.box()
    (here / "b.off").write_text(mesh.export(file_type="off"))
    (here / "c.stl").write_text(mesh.export(file_type="stl_ascii"))
    (here / "d.ply").write_bytes(mesh.export(file_type="ply", encoding="ascii"))
    for name in ("a.ply", "b.off", "c.stl", "d.ply"):
        assert ws.open_geometry(name)
        whole = (here / name).read_text().rstrip().removesuffix("endsolid").rstrip()
        for cut in range(len(whole) // 3, len(whole) - 9, 7):
            (here / name).write_text(whole[:cut])
            assert _message(here / name) is not None or whole[:cut].endswith("endfacet"), (name, whole[:cut][-40:])


def test_tracts_that_broke_off_behind_one_of_them(here):
    streamlines = pytest.importorskip("nibabel.streamlines")
    tracts = streamlines.Tractogram([np.ones((3, 3), "f4")] * 5, affine_to_rasmm=np.eye(4))
    streamlines.save(tracts, "a.trk")
    assert len(ws.open_geometry("a.trk").paths) == 5
    (here / "a.trk").write_bytes((here / "a.trk").read_bytes()[: 1000 + 3 * (4 + 36)])
    with pytest.raises(FileError, match="truncated: its header promises 5 tracts, and it holds 3"):
        ws.open_geometry("a.trk")


def test_counts_of_freesurfer_beyond_the_file(here):
    (here / "lh.pial").write_bytes(b"\xff\xff\xfecreated\n\n" + (2_000_000_000).to_bytes(4, "big") * 2 + bytes(100))
    with pytest.raises(FileError, match="truncated: its header promises 2000000000 vertices and 2000000000 triangles"):
        ws.open_geometry("lh.pial")


def test_damaged_files_are_errors_of_one_line_or_shapes(here):
    """Cut anywhere, and with bytes changed anywhere: nothing else is ever raised."""
    rng = np.random.default_rng(0)
    said = []
    for path in _written(here):
        whole = path.read_bytes()
        for trial in range(24):
            changed = np.frombuffer(whole, np.uint8).copy()
            if trial < 8:
                changed = changed[: len(whole) * trial // 8]
            else:
                changed[rng.integers(0, min(len(changed), 400 if trial < 16 else len(changed)), 4)] = rng.integers(
                    0, 256, 4
                )
            broken = path.with_name(f"broken{path.suffix}")
            broken.write_bytes(changed.tobytes())
            if (message := _message(broken)) is not None:
                assert "\n" not in message, path
                assert str(broken) in message, path
                said.append(message)
    assert len(said) > 100
