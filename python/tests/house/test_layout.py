"""The layout of the code: which module may import which, the length of files, and unique names of Rust's types."""

import ast
from collections import Counter
from pathlib import Path

import layout_rules
import pytest

ROOT = Path(__file__).parents[3]

#: Rooms of the Python package and of crates, in order: each imports only from those before it. A crate is checked once
#: it has its first room.
ROOMS = {
    "python/wavesplat": [
        "_native",
        "errors",
        "_public",
        "_system",
        "_storage",
        "_model",
        "_readers",
        "_looks",
        "_picture",
        "examples",
        "gpu",
        "_geometry",
        "_render",
        "_cluster",
        "_scene",
        "_movie",
        "_mesh",
        "_viewer",
        "_napari",
        "napari",
        "reference",
        "study",
        "_cli",
    ],
    "crates/compute/src": ["pages", "locks", "parallel", "filled", "simd", "extent"],
    "crates/splat/src": [
        "view",
        "kernel",
        "source",
        "sheet",
        "optics",
        "shapes",
        "ray",
        "picture",
        "render",
        "quality",
    ],
    "crates/study/src": ["standard"],  # the method that ours is judged against; `reference` has its literal twin
    "crates/gpu/src": [
        "failure",
        "adapter",
        "device",
        "layout",
        "permutation",
        "pipeline",
        "buffers",
        "timer",
        "report",
        "samples",
        "band",
        "pages",
        "scene_kind",
        "volumes",
        "numbers",
        "capture",
        "stage",
        "draw",
        "self_test",
        "gpu",
        "gpus",
    ],
    "crates/wavelet/src": ["family", "error", "transform", "volume"],
    "crates/lod/src": ["sample_box", "probe_rays", "level_brightness", "level_histogram", "level_transfer_function"],
    "crates/files/src": ["length_units", "stored", "error", "nifti", "nrrd"],
    "crates/look/src": [
        "numbers",
        "texts",
        "words",
        "statistics",
        "colors",
        "channel_colors",
        "map_tables",
        "colormaps",
        "look",
        "scale",
        "presets",
        "ct_windows",
        "voxels",
        "channel_ramp",
        "changes",
        "quantities",
        "histogram",
        "hounsfield",
        "facts",
        "evidence",
        "measured_maps",
        "shares",
        "segmentation",
        "kinds",
        "scans",
        "fields",
        "light_maps",
        "projections",
        "channel_windows",
        "automatic",
        "channel_light",
        "over_others",
    ],
    "crates/view/src": [
        "rotation",
        "lens",
        "named",
        "pose",
        "path",
        "fit",
        "turn",
        "eyes",
        "panorama",
        "stack",
        "shown",
    ],
    "crates/document/src": [
        "error",
        "node",
        "fields",
        "form",
        "parts",
        "camera",
        "curves",
        "look",
        "check",
        "patch",
        "view",
        "scene",
        "schema",
        "typescript",
    ],
    "crates/wavesplat/src": [
        "error",
        "quality",
        "level_look",
        "level_volume",
        "volume_cache",
        "lazy_volume",
        "scene",
        "kind",
        "automatic",
        "placed",
        "slice",
        "device",
        "frame",
        "document_values",
        "document_labels",
        "scene_document",
        "block_state",
        "stream",
        "sample_reader",
        "bytes",
        "png",
    ],
    "crates/wasm/src": ["requests", "documents", "opened", "questions", "abi"],
}
#: Rooms beside each other after all of these; nothing imports from them. `lib` is the root of a crate with its
#: re-exports: inside a crate everything is imported from where it is defined.
LEAVES = {
    "python/wavesplat": ["__init__", "__main__"],
    "crates/compute/src": ["lib"],
    "crates/splat/src": ["slice_plane", "lib"],
    "crates/study/src": ["reference", "lib"],
    "crates/gpu/src": ["lib"],
    "crates/wavelet/src": ["lib"],
    "crates/lod/src": ["lib"],
    "crates/files/src": ["lib"],
    "crates/look/src": ["lib"],
    "crates/view/src": ["lib"],
    "crates/document/src": ["lib"],
    "crates/wavesplat/src": ["lib"],
    "crates/wasm/src": ["lib"],
}

#: Modules of Python that import each other, some of them inside functions: a class, and the files that its methods are
#: written in. No other module may join them.
CIRCLES = {
    "_looks": [
        (
            "changed",
            "curves.colormaps",
            "curves.transfer_function",
            "curves.value_scale",
            "interchange.paraview_files",
            "interchange.slicer_files",
            "kinds.automatic",
            "kinds.channels",
            "kinds.histogram",
            "look",
            "look_files",
            "presets",
        ),
        ("curves.materials", "curves.materials_fit", "curves.materials_json"),
    ],
    "_model": [
        (
            "arguments.clips",
            "lazy.parts",
            "lazy.volume",
            "volume.volume",
            "volume.volume_like",
            "volume.wavelet_volume",
        ),
        ("camera.camera", "camera.files", "camera.fit", "camera.path"),
    ],
    "_picture": [("annotating", "picture", "picture_files", "vector_files")],
    "_readers": [("dicom.header", "dicom.pixel_data", "dicom.places")],
    "_scene": [
        (
            "documents.scene_files",
            "documents.scene_json",
            "drawing.drawing",
            "drawing.drawn_frame",
            "drawing.drawn_layers",
            "drawing.looks_of_layers",
            "drawing.picture_notes",
            "drawing.reporting",
            "drawing.scene_shapes",
            "drawing.summary",
            "drawing.volumes_of_layers",
            "scene",
            "slices.cards",
            "slices.layers_on_slices",
        )
    ],
    "_viewer": [("notebook", "viewer")],
}

MAX_LINES = 600
#: Modules of a folder of the Python package, which a newcomer reads the names of.
MAX_FILES = 20
FOLDERS = ("crates", "python", "benches", "studies", "docs")
#: Files that may be longer, for now, and why.
LONG_FILES: dict[str, str] = {}

#: Names that several types share, and why.
DUPLICATES: dict[str, str] = {}


@pytest.fixture(params=ROOMS)
def imports(request):
    """The root of a package or crate, and the imports of each module below it."""
    folder = ROOT / request.param
    rooms = ROOMS[request.param]
    if not _exists(folder, rooms[0]):
        pytest.skip(f"{request.param} has no rooms yet")
    missing = [room for room in rooms if not _exists(folder, room)]
    assert missing == []
    if folder.name == "src":
        return request.param, layout_rules.rust_imports(layout_rules.rust_sources(folder))
    return request.param, layout_rules.python_imports(folder)


def _exists(folder, room):
    return any((folder / name).exists() for name in (room, f"{room}.rs", f"{room}.py", f"{room}.pyi"))


def test_rooms_import_only_from_those_before_them(imports):
    root, modules = imports
    assert layout_rules.check_order(modules, ROOMS[root], LEAVES[root]) == []


def test_no_rooms_import_each_other_in_a_circle(imports):
    assert layout_rules.circle_of_rooms(imports[1]) == []


def test_no_module_joins_a_circle():
    found = layout_rules.circles_of_modules(layout_rules.python_imports(ROOT / "python/wavesplat"))
    assert found == sorted([f"{room}.{name}" for name in names] for room in CIRCLES for names in CIRCLES[room])


#: Modules of Rust that name each other: a type, and the files that its methods are written in.
CIRCLES_OF_RUST = [
    ["lazy", "volume", "wavelet"],
    ["optics.classify", "optics.preintegrate"],
    ["picture.edge_texels", "picture.edges"],
    ["render.empty_space", "render.tile"],
    ["sheet.buffer", "sheet.missing", "sheet.upsample"],
    ["transform.norm", "transform.plan"],
]


def test_no_module_of_rust_joins_a_circle():
    crates = [layout_rules.rust_imports(layout_rules.rust_sources(src)) for src in (ROOT / "crates").glob("*/src")]
    assert sorted(circle for one in crates for circle in layout_rules.circles_of_modules(one)) == CIRCLES_OF_RUST


def test_files_are_short():
    lengths = {
        path.relative_to(ROOT).as_posix(): len(path.read_text(encoding="utf-8").splitlines())
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".rs") and path.is_file()
    }
    assert lengths
    assert layout_rules.check_exceptions(_long(lengths), LONG_FILES) == []


def test_folders_of_python_are_small():
    counts = Counter(path.parent for path in (ROOT / "python/wavesplat").rglob("*.py") if path.name != "__init__.py")
    assert {path.name: n for path, n in counts.items() if n > MAX_FILES} == {}


def _long(lengths):
    return {path: f"{n} lines; split it" for path, n in lengths.items() if n > MAX_LINES}


def test_no_two_types_of_rust_have_one_name():
    crates = {src.parent.name: layout_rules.rust_sources(src) for src in sorted((ROOT / "crates").glob("*/src"))}
    places = {
        f"{crate}::{module}": layout_rules.rust_types(code)
        for crate, sources in crates.items()
        for module, code in sources.items()
    }
    assert places
    assert layout_rules.check_exceptions(_twice(places), DUPLICATES) == []


def _twice(places):
    homes = {}
    for place, names in places.items():
        for name in names:
            homes.setdefault(name, []).append(place)
    return {name: f"defined in {', '.join(where)}" for name, where in homes.items() if len(where) > 1}


def test_the_bindings_depend_on_the_facade_and_they_alone_on_what_it_is_compared_with():
    manifests = {path.parent.name: path.read_text(encoding="utf-8") for path in (ROOT / "crates").glob("*/Cargo.toml")}
    depend = [crate for crate, manifest in manifests.items() if "\nwavesplat-study" in manifest]
    assert depend == ["python"]
    own = [line.partition(".")[0].partition(" ")[0] for line in manifests["python"].splitlines()]
    # The bindings know the renderer by the interface that Rust users have.
    assert [name for name in own if name.startswith("wavesplat")] == ["wavesplat", "wavesplat-study"]


# Tests that each check can fail.


@pytest.mark.parametrize(
    ("module", "imported", "complaint"),
    [
        ("low.a", "high.b", "low.a imports high.b, but high comes after low"),
        ("high.a", "beside.b", "high.a imports beside.b, which nothing may import"),
        ("besides.a", "beside", "besides.a imports beside, which nothing may import"),
        ("new.a", "low", "new.a: its room, new, has no place in the order"),
    ],
)
def test_imports_against_the_order_are_found(module, imported, complaint):
    found = layout_rules.check_order({module: [imported]}, ["low", "high"], ["beside", "besides"])
    assert found == [complaint]


def test_imports_in_order_are_right():
    imports = {"low.a": ["low.b"], "high": ["low.a"], "beside.a": ["high", "low.b", "beside.b"]}
    assert layout_rules.check_order(imports, ["low", "high"], ["beside"]) == []
    assert layout_rules.circle_of_rooms(imports) == []


def test_circles_are_found():
    circle = layout_rules.circle_of_rooms({"a.x": ["b"], "b.y": ["c.x", "b.z"], "c": ["a.z"]})
    assert sorted(circle[1:]) == ["a", "b", "c"]


def test_circles_of_modules_are_found():
    imports = {"a.x": ["a.y.Name"], "a.y": ["a.z"], "a.z": ["a.x.f"], "b": ["a.x"], "c": ["c"]}
    assert layout_rules.circles_of_modules(imports) == [["a.x", "a.y", "a.z"]]


def test_long_files_and_old_exceptions_are_found():
    assert layout_rules.check_exceptions(_long({"a.rs": 601, "b.rs": 600}), {}) == ["a.rs: 601 lines; split it"]
    complaint = "a.rs: all right now; take it off the list"
    assert layout_rules.check_exceptions(_long({"a.rs": 600}), {"a.rs": "grown"}) == [complaint]


def test_types_of_one_name_and_old_exceptions_are_found():
    twice = _twice({"core::a": ["Row", "Sheet"], "splat::b": ["Row"]})
    assert layout_rules.check_exceptions(twice, {}) == ["Row: defined in core::a, splat::b"]
    assert layout_rules.check_exceptions(twice, {"Row": "rows of two kinds"}) == []
    complaint = "Sheet: all right now; take it off the list"
    assert layout_rules.check_exceptions(twice, {"Row": "", "Sheet": ""}) == [complaint]


@pytest.mark.parametrize(
    ("code", "names"),
    [
        ("import wavesplat._a.b", {"wavesplat._a.b"}),
        ("from wavesplat._a import b, c", {"wavesplat._a.b", "wavesplat._a.c"}),
        ("if TYPE_CHECKING:\n    from wavesplat._a import b", {"wavesplat._a.b"}),
        ("def f():\n    from wavesplat._a import b", {"wavesplat._a.b"}),
        ('import_module("wavesplat._a")', {"wavesplat._a"}),
        ('importlib.import_module(f"wavesplat._a.{name}")', {"wavesplat._a"}),
        ('import_module(f"wavesplat.{name}")', set()),
    ],
)
def test_imports_of_python_are_found(code, names):
    assert set(layout_rules.imported_names(ast.parse(code))) == names


def test_a_public_name_is_not_imported_from_inside(tmp_path):
    package = tmp_path / "wavesplat"
    (package / "_a").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "_a" / "__init__.py").touch()
    (package / "_a" / "b.py").write_text("from wavesplat import Volume, _native, _a\n", encoding="utf-8")
    found = layout_rules.python_imports(package)
    assert found == {"__init__": set(), "_a": set(), "_a.b": {"__init__", "_native", "_a"}}


@pytest.mark.parametrize(
    ("code", "names"),
    [
        ("use crate::b::{X, c::{Y as Z}};", {"b.X", "b.c.Y"}),
        ("pub(crate) use super::super::b::X;", {"b.X"}),
        ("fn f() { crate::b::g(); super::h::<u8>() }", {"b.g", "a.h"}),
        ("use super::X;", {"a.X"}),
        ("use crate::X;", {"lib"}),
        ("use std::fmt; // use crate::b;\n/* crate::b::c */", set()),
        ("const A: &str = \"crate::b::c\"; const B: char = '\"'; fn f<'a>(x: &'a str) { crate::b::g() }", {"b.g"}),
        ('const A: &str = r#"a " crate::b::c"#;', set()),
        ("#[cfg(test)]\nmod tests { use crate::b::X; mod inner {} }\nuse super::c::Y;", {"a.c.Y"}),
        ('#[cfg(all(test, feature = "x"))]\nmod tests { use crate::b::X; }', set()),
    ],
)
def test_imports_of_rust_are_found(tmp_path, code, names):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "mod.rs").touch()
    (tmp_path / "a" / "m.rs").write_text(code, encoding="utf-8")
    (tmp_path / "lib.rs").touch()
    assert layout_rules.rust_imports(layout_rules.rust_sources(tmp_path))["a.m"] == names


def test_types_of_rust_are_found(tmp_path):
    code = """
        pub struct A<T>(T); enum B { X { a: u8 } } type C = u8;
        trait D { type No; fn f(&self) { struct E; } }
        impl D for A<u8> { type No = u8; }
        /// struct No;
        pub(crate) union F { a: u8 }
        #[cfg(test)] mod tests { struct No; }
        #[cfg(test)] mod apart;
    """
    (tmp_path / "lib.rs").write_text(code, encoding="utf-8")
    (tmp_path / "apart.rs").write_text("struct No;", encoding="utf-8")
    sources = layout_rules.rust_sources(tmp_path)
    assert list(sources) == ["lib"]
    assert layout_rules.rust_types(sources["lib"]) == ["A", "B", "C", "D", "E", "F"]
