"""Trust: the citation, the statement of accuracy and the tests that it names, templates, what the front pages link."""

from __future__ import annotations

import re

import pages
import pytest
import yaml

ROOT = pages.ROOT
#: The size of the README is the reader's time.
MAX_README_BYTES = 6000
FORMS = [path for path in sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")) if path.stem != "config"]
#: Pages that the front pages link to.
LINKED = {
    "README.md": "accuracy limits privacy trust SECURITY public_api CITATION.cff CODE_OF_CONDUCT CONTRIBUTING",
    "docs/site/project.md": "CITATION.cff public_api CONTRIBUTING CODE_OF_CONDUCT",
    "docs/site/limits.md": "limits accuracy trust privacy SECURITY",
}


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


def version():
    return re.search(r'^\[workspace\.package\]\nversion = "([\d.]+)"', text_of("Cargo.toml"), re.MULTILINE).group(1)


def test_the_citation_has_what_is_cited_and_the_version_of_the_code():
    citation = yaml.safe_load(text_of("CITATION.cff"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["type"] == "software"
    assert citation["title"] == "Wavesplat"
    assert citation["message"]
    assert citation["authors"]
    assert citation["version"] == version()
    project = text_of("pyproject.toml")
    assert f'license = "{" OR ".join(citation["license"])}"' in project
    for reference in citation["references"]:
        assert {"type", "title", "authors", "year", "doi"} <= set(reference)


def test_every_statement_of_accuracy_names_tests_that_are_there():
    page = text_of("docs/accuracy.md")
    rows = [
        row for row in re.findall(r"^\| (.*) \| (.*) \|$", page, re.MULTILINE) if row[0] not in ("statement", "---")
    ]
    assert len(rows) >= 20
    for statement, held_by in rows:
        tests = re.findall(r"`([\w./]+)::(\w+)`", held_by)
        assert tests, statement
        for file, name in tests:
            path = f"python/tests/{file}" if file.endswith(".py") else file
            words = "fn" if path.endswith(".rs") else "def"
            assert re.search(rf"^\s*{words} {name}\(", text_of(path), re.MULTILINE), (file, name)


@pytest.mark.parametrize("page", LINKED)
def test_front_pages_link_what_trust_stands_on(page):
    text = text_of(page)
    linked = re.findall(r"\]\(([^)#]+)", text) + re.findall(r"^(?:\.\./)+(\S+)$", text, re.MULTILINE)
    names = {re.sub(r"^(\.\./)*(docs/)?", "", one).removesuffix(".md") for one in linked}
    assert set(LINKED[page].split()) <= names


def test_the_readme_does_not_grow():
    assert len(text_of("README.md").encode()) <= MAX_README_BYTES


@pytest.mark.parametrize("page", ["README.md", "docs/limits.md", "docs/accuracy.md", "docs/site/index.md"])
def test_pages_say_that_it_is_not_for_clinics(page):
    assert "Not for clinical use" in text_of(page)


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_templates_of_issues_are_forms(path):
    # https://docs.github.com/communities/using-templates-to-encourage-useful-issues-and-pull-requests/syntax-for-issue-forms
    form = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert {"name", "description", "body"} <= set(form)
    fields = [one for one in form["body"] if one["type"] != "markdown"]
    assert {one["type"] for one in fields} <= {"input", "textarea", "dropdown", "checkboxes"}
    names = [one["id"] for one in fields]
    assert len(set(names)) == len(names)
    assert all(one["attributes"]["label"] for one in fields)
    assert fields[0]["validations"]["required"] is True


def test_readers_and_their_libraries_are_named_by_the_page_of_security():
    # What parses files of others: the libraries of the readers that are installed by default, and those of extras.
    page = text_of("SECURITY.md")
    libraries = ["SimpleITK", "pydicom", "nibabel", "tifffile", "h5py", "zarr", "numcodecs", "fsspec"]
    project = text_of("pyproject.toml")
    assert [name for name in libraries if f'"{name}' not in project or name not in page] == []
    extras = {"trimesh", "VTK", "segyio", "tensorstore", "bioio", "h5netcdf", "pyarrow"}
    assert [name for name in extras if name not in page] == []


def test_recipes_that_the_contributing_guide_names_are_there():
    makefile = text_of("Makefile")
    named = set(re.findall(r"`make (?:[A-Z]+=\S+ )?([a-z-]+)", text_of("CONTRIBUTING.md")))
    named |= set(re.findall(r"^\$ make ([a-z-]+)", text_of("CONTRIBUTING.md"), re.MULTILINE))
    assert len(named) > 30
    assert [name for name in named if not re.search(rf"^{name}:", makefile, re.MULTILINE)] == []
