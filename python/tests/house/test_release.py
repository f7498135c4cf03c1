"""Releases: one version everywhere, a changelog of the notes, workflows that name recipes and files that are there."""

from __future__ import annotations

import datetime as dt
import importlib.util
import json
import re
import shutil
import tarfile
import tomllib
import zipfile

import pages
import pytest
import yaml

ROOT = pages.ROOT
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


@pytest.fixture(autouse=True)
def beside_the_tools(monkeypatch):
    """Let tools import each other, as they do when they are run."""
    monkeypatch.syspath_prepend(ROOT / "python" / "tools")


def tool(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "python" / "tools" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


VERSION, CHANGELOG = tool("version"), tool("changelog")


@pytest.fixture
def checkout(tmp_path):
    for name in [*VERSION.COPIES, "CHANGELOG.md"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "changes").mkdir()
    return tmp_path


def test_the_version_is_the_same_everywhere():
    assert re.fullmatch(r"\d+\.\d+\.\d+", VERSION.current())


def test_a_version_is_set_everywhere(checkout):
    before = VERSION.current(checkout)
    VERSION.write("7.8.9", checkout)
    assert VERSION.current(checkout) == "7.8.9"
    for name in VERSION.COPIES:
        lines = (checkout / name).read_text(encoding="utf-8").splitlines()
        old = (ROOT / name).read_text(encoding="utf-8").splitlines()
        changed = [(a, b) for a, b in zip(old, lines, strict=True) if a != b]
        assert changed
        assert all(b == a.replace(before, "7.8.9") for a, b in changed)


def test_a_copy_that_differs_is_named(checkout):
    path = checkout / "CITATION.cff"
    path.write_text(re.sub(r"\nversion: .*", "\nversion: 6.6.6", path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(SystemExit, match=r"CITATION\.cff.*6\.6\.6"):
        VERSION.current(checkout)
    with pytest.raises(SystemExit, match="three numbers"):
        VERSION.write("1.2", checkout)


def test_a_tag_of_another_version_is_refused():
    with pytest.raises(SystemExit, match="not 99"):
        VERSION.main(["--expect", "99.0.0"])


def test_all_notes_have_a_kind():
    files = {path.name for path in (ROOT / "changes").iterdir()}
    assert {path.name for paths in CHANGELOG.notes().values() for path in paths} == files - {"README.md"}


def test_the_version_of_the_checkout_has_its_section_in_the_changelog():
    assert len(CHANGELOG.of_version(VERSION.current()).splitlines()) > 50


def test_notes_become_a_section_of_the_changelog(checkout):
    (checkout / "changes" / "README.md").write_text("How notes are written.\n")
    (checkout / "changes" / "12.fixed.md").write_text("A hole is gone.\n")
    (checkout / "changes" / "3-x.added.md").write_text("Bones, as [there](../docs/x.md):\n\n- a\n- b\n")
    (checkout / "changes" / "4.added.md").write_text("- c\n- d\n  - e\n")
    CHANGELOG.release("7.8.9", dt.date(2030, 1, 2), checkout)
    assert [path.name for path in (checkout / "changes").iterdir()] == ["README.md"]
    text = (checkout / "CHANGELOG.md").read_text(encoding="utf-8")
    assert "## [7.8.9] - 2030-01-02" in text
    assert text.index("[Unreleased]") < text.index("[7.8.9]")
    assert CHANGELOG.of_version("7.8.9", checkout) == (
        "### Added\n\n- Bones, as [there](docs/x.md):\n  - a\n  - b\n- c\n- d\n  - e\n\n"
        "### Fixed\n\n- A hole is gone.\n"
    )
    with pytest.raises(SystemExit, match="nothing to release"):
        CHANGELOG.release("7.9.0", dt.date(2030, 1, 3), checkout)
    (checkout / "changes" / "5.changed.md").write_text("New colours.\n")
    CHANGELOG.release("7.9.0", dt.date(2030, 1, 3), checkout)
    assert "New colours." not in CHANGELOG.of_version("7.8.9", checkout)
    assert CHANGELOG.of_version("7.9.0", checkout) == "### Changed\n\n- New colours.\n"


def test_a_file_that_is_no_note_is_named(checkout):
    (checkout / "changes" / "5.better.md").write_text("x")
    with pytest.raises(SystemExit, match=r"5\.better\.md is no note"):
        CHANGELOG.notes(checkout)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_run_what_is_there_and_pin_what_is_not_ours(path):
    text = path.read_text(encoding="utf-8")
    workflow = yaml.safe_load(text)
    assert workflow["permissions"] == {}  # each job asks for its own
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for job in workflow["jobs"].values():
        for step in job.get("steps", [job]):
            if action := step.get("uses", ""):
                assert action.startswith("./") or re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}", action), action
                assert not action.startswith("./") or (ROOT / action).is_file()
            for recipe in re.findall(r"\bmake ([a-z-]+)", step.get("run", "")):
                assert re.search(rf"^{recipe}:", makefile, re.MULTILINE), recipe
            for script in re.findall(r"(?:python/tools|\.ci)/[\w.]+", step.get("run", "")):
                assert (ROOT / script).is_file(), script
    assert "secrets." not in text


def test_only_the_release_may_publish():
    may = {path.stem: re.findall(r"(\S+): write", path.read_text(encoding="utf-8")) for path in WORKFLOWS}
    assert {name for name, rights in may.items() if rights} == {"release"}


def test_crates_that_are_published_have_what_their_pages_show():
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
    published = []
    for path in sorted((ROOT / "crates").glob("*/Cargo.toml")):
        package = tomllib.loads(path.read_text(encoding="utf-8"))["package"]
        if package.get("publish") is False:
            continue
        published.append(package["name"])
        for name in ("version", "license", "authors", "documentation", "categories"):
            assert package[name] == {"workspace": True}
            assert workspace["package"][name]
        assert len(package["description"]) > 30
        assert 1 <= len(package["keywords"]) <= 5  # https://doc.rust-lang.org/cargo/reference/manifest.html
        assert all(re.fullmatch(r"[a-z0-9][a-z0-9_+-]{0,19}", word) for word in package["keywords"])
        readme = package["readme"]
        assert (path.parent / readme if isinstance(readme, str) else ROOT / workspace["package"]["readme"]).is_file()
        assert all((path.parent / name).is_file() for name in ("LICENSE-MIT", "LICENSE-APACHE"))
    assert len(published) == 12
    assert {"wavesplat", "wavesplat-core", "wavesplat-splat"} <= set(published)


def test_the_code_on_the_page_of_the_crate_is_the_example_that_cargo_runs():
    example = re.search(
        r"^//! ```\n(.*?)^//! ```$", (ROOT / "crates/wavesplat/src/lib.rs").read_text(), re.MULTILINE | re.DOTALL
    )[1]
    lines = [line.removeprefix("//!").removeprefix(" ") for line in example.splitlines()]
    shown = "\n".join(line for line in lines if not line.startswith("# "))
    assert f"```rust\n{shown}\n```" in (ROOT / "crates/wavesplat/README.md").read_text(encoding="utf-8")


def test_bills_of_materials_are_checked():
    sbom = tool("sbom")
    part = {"name": "NumPy", "version": "2", "licenses": [{}]}
    bill = {"bomFormat": "CycloneDX", "components": [part, {"name": "b", "version": "1"}]}
    assert sbom.faults_of(bill, {"numpy"}) == []
    assert sbom.faults_of(bill, {"numpy", "b", "c"}) == ["it lacks c", "b has no licence"]
    assert sbom.faults_of({**bill, "components": [{"name": "a"}]}, set()) == ["a has no version"]
    assert sbom.page_packages() == {"preact"}
    assert {"numpy", "simpleitk", "pillow"} <= sbom.python_packages()


def test_files_of_wheels_are_checked(tmp_path):
    check = tool("check_wheel")
    wheel = tmp_path / "a.whl"
    licences = [f"a.dist-info/licenses/{name}" for name in check.LICENCES]
    names = [*check.WANTED, "wavesplat/_native.pyi", "wavesplat/_native.abi3.so", *licences]

    def faults(names):
        with zipfile.ZipFile(wheel, "w") as file:
            for name in names:
                file.writestr(name, "x")
        return check.faults_of(wheel)

    assert faults(names) == []
    assert faults([*names, "python/tests/test_a.py"]) == ["it has python/tests/test_a.py"]
    assert faults(names[1:-1]) == ["it lacks wavesplat/__init__.py", "it lacks LICENSES-OF-OTHERS.txt"]
    assert faults([*names, "wavesplat/_native.pyd"]) == ["it has not one compiled module"]
    with zipfile.ZipFile(wheel, "w") as file:
        file.writestr("large", bytes(check.MAX_BYTES))
    assert "more than 10" in check.faults_of(wheel)[0]
    with zipfile.ZipFile(wheel, "w") as file:
        file.writestr("a.txt", f"made in {ROOT}/crates")
    assert check.faults_of(wheel)[0] == f"a.txt has the path {ROOT} in it"


def test_wheels_name_no_folder_of_the_machine_and_give_the_terms_of_others(tmp_path):
    build = tool("build_wheel")
    folder = tmp_path / "a.dist-info"
    (folder / "sboms").mkdir(parents=True)
    (folder / "licenses").mkdir()
    bill = folder / "sboms" / "a.json"
    bill.write_text(f'["path+{tmp_path.as_uri()}/crates/core"]')
    (folder / "METADATA").write_text("Name: a\nLicense-File: LICENSE-MIT\n\nText.\n")
    build.hide_path(tmp_path, tmp_path)
    build.add_licences(tmp_path, "terms of b")
    assert bill.read_text() == '["path+file:///wavesplat/crates/core"]'
    assert (folder / "licenses" / "LICENSES-OF-OTHERS.txt").read_text() == "terms of b"
    assert (
        "License-File: LICENSES-OF-OTHERS.txt\nLicense-File: LICENSE-MIT\n\nText.\n"
        in (folder / "METADATA").read_text()
    )


def test_builds_depend_neither_on_the_folder_nor_on_the_day(tmp_path, monkeypatch):
    build = tool("build_wheel")
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    monkeypatch.setenv("CARGO_TARGET_DIR", "/somewhere/target")
    monkeypatch.setenv("RUSTFLAGS", "-C target-cpu=native")
    variables = build.environment(tmp_path)
    flags = variables["CARGO_ENCODED_RUSTFLAGS"].split("\x1f")
    assert f"--remap-path-prefix={tmp_path}=/wavesplat" in flags
    assert flags.index("--remap-path-prefix=/somewhere/target=/wavesplat/target") > 0
    assert "RUSTFLAGS" not in variables
    assert int(variables["SOURCE_DATE_EPOCH"]) >= build.FIRST_DAY
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    assert build.environment(tmp_path)["SOURCE_DATE_EPOCH"] == "1000000000"


def test_what_differs_between_two_builds_is_named(tmp_path):
    differences = tool("check_repeat").differences

    def wheel(name, day, **files):
        with zipfile.ZipFile(tmp_path / name, "w") as file:
            for one, text in files.items():
                file.writestr(zipfile.ZipInfo(one, (2030, 1, day, 0, 0, 0)), text)
        return tmp_path / name

    first = wheel("first", 1, a="x", b="y")
    assert differences(first, wheel("same", 1, a="x", b="y")) == []
    assert differences(first, wheel("other", 1, a="x", b="z", c="")) == ["c", "b"]
    assert differences(first, wheel("later", 2, a="x", b="y")) == [
        "the order, the times or the compression of its files"
    ]


def test_files_of_the_package_of_the_page_are_checked(tmp_path):
    check = tool("check_page_package")
    manifest = json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8"))
    page = ["README.md", "dist/LICENSE-MIT", "dist/LICENSE-APACHE", "dist/LICENSES-OF-OTHERS.txt", "dist/widget.js"]
    page += ["dist/index.d.ts", "dist/page/index.html", "dist/page/favicon.svg", "dist/page/page-ABCD1234.js"]

    def faults(names, manifest):
        (tmp_path / "package.json").write_text(json.dumps(manifest))
        (tmp_path / "x").write_text("x")
        with tarfile.open(tmp_path / "a.tgz", "w:gz") as file:
            file.add(tmp_path / "package.json", "package/package.json")
            for name in names:
                file.add(tmp_path / "x", f"package/{name}")
        return check.faults_of(tmp_path / "a.tgz")

    assert faults(page, manifest) == []
    assert faults([*page, "src/app.tsx"], manifest) == ["it has src/app.tsx"]
    assert "it exports dist/widget.js, which it lacks" in faults([one for one in page if "widget" not in one], manifest)
    assert faults(page, {**manifest, "version": "9.9.9", "private": True}) == [
        f"its version is 9.9.9, not {VERSION.current()}",
        "it is private",
    ]


def test_the_recipe_of_conda_asks_for_what_the_package_asks_for():
    recipe = yaml.safe_load((ROOT / "packaging/conda-forge/recipe.yaml").read_text(encoding="utf-8"))
    asked = {one.lower() for one in recipe["requirements"]["run"]}
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    [listed] = re.findall(r"^dependencies = \[\n(.*?)^\]", text, re.MULTILINE | re.DOTALL)
    wanted = re.findall(r'^ +"([\w-]+)(>=[^";]+)', listed, re.MULTILINE)
    others = {"openexr": "openexr-python"}
    wanted = {f"{others.get(name.lower(), name.lower())} {version}" for name, version in wanted}
    assert asked == wanted | {"python >=3.11"}
