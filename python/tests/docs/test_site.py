"""The documentation site, without building it: every page is reached, and what its settings name is there."""

from __future__ import annotations

import ast
import importlib.util
import re
from pathlib import Path

import pages
import pytest

import wavesplat as ws

ROOT = pages.ROOT
SITE = ROOT / "docs" / "site"
DIRECTIVE = re.compile(r"^```\{(toctree|include)\} ?(.*?)$(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGE_ENDINGS = (".md", ".ipynb")
#: Packages of the extra `site` that notebooks import or run in; extensions are the others.
RUN_BY_NOTEBOOKS = {"anywidget", "ipykernel"}
OPTION = re.compile(r"^:([a-z-]+):\s*(.*)$")


def settings(path: Path) -> dict[str, object]:
    """The constants at the top of a file, without running it: Sphinx may not be installed here."""
    found = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
        if isinstance(target, ast.Name):
            try:
                found[target.id] = ast.literal_eval(node.value)
            except ValueError:  # it is computed
                continue
    return found


CONF = settings(SITE / "conf.py")


def source_pages() -> set[Path]:
    """The pages that Sphinx reads."""
    patterns = [pattern.replace("**.md", "**/*.md") for pattern in CONF["include_patterns"]]
    return {path for pattern in patterns for path in ROOT.glob(pattern)}


def listed_by(page: Path) -> set[Path]:
    """The pages that the tables of contents of a page name."""
    found = set()
    for name, _, body in DIRECTIVE.findall(page.read_text(encoding="utf-8")):
        lines = [line.strip() for line in body.splitlines() if line.strip()]
        names = [line for line in lines if name == "toctree" and not OPTION.match(line)]
        for one in names:
            matches = {path.resolve() for ending in PAGE_ENDINGS for path in page.parent.glob(f"{one}{ending}")}
            assert matches, f"{page.relative_to(ROOT)} lists {one}, which is no page"
            found |= matches
    return found


def reached_from(page: Path) -> set[Path]:
    """The pages that tables of contents lead to from one, that one too."""
    reached, waiting = set(), [page]
    while waiting:
        if (one := waiting.pop()) not in reached:
            reached.add(one)
            waiting += listed_by(one)
    return reached


def test_every_page_is_in_a_table_of_contents():
    all_pages = source_pages()
    assert {ROOT / "docs" / "how_to" / "figures.md", ROOT / "benches" / "README.md", SITE / "index.md"} <= all_pages
    reached = reached_from(ROOT / f"{CONF['root_doc']}.md")
    assert sorted(str(path.relative_to(ROOT)) for path in all_pages - reached) == []
    assert sorted(str(path.relative_to(ROOT)) for path in reached - all_pages) == []


@pytest.mark.parametrize("pattern", CONF["include_patterns"])
def test_patterns_of_pages_have_pages(pattern):
    assert list(ROOT.glob(pattern.replace("**.md", "**/*.md")))


def test_extensions_are_files_beside_the_settings_or_installed_by_the_extra():
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    extra = re.search(r"^site = \[(.*?)^\]", project, re.MULTILINE | re.DOTALL).group(1)
    installed = {name.replace("-", "_") for name in re.findall(r'"([a-z-]+)>=', extra)}
    packages = {name.partition(".")[0] for name in [*CONF["extensions"], CONF["html_theme"]]}
    own = {path.stem for path in SITE.glob("*.py")}
    assert packages - own == installed - RUN_BY_NOTEBOOKS
    assert own - packages == {"conf", "check_links"}


def test_templates_are_there():
    folders = [SITE / folder for folder in CONF["templates_path"]]
    assert [
        name for name in CONF["html_additional_pages"].values() if not any((f / name).is_file() for f in folders)
    ] == []
    first = (folders[0] / "first_page.html").read_text(encoding="utf-8")
    assert set(re.findall(r"[\w/]+\.html", first)) == {f"{CONF['root_doc']}.html"}


def test_links_to_folders_lead_from_folders_to_pages():
    for folder, page in settings(SITE / "site_links.py")["PAGES"].items():
        assert (ROOT / folder).is_dir(), folder
        assert page is None or (ROOT / f"{page}.md").is_file(), page


def test_included_parts_begin_and_end_at_text_that_is_there():
    included = []
    for page in SITE.glob("*.md"):
        for name, file, body in DIRECTIVE.findall(page.read_text(encoding="utf-8")):
            if name == "include":
                options = dict(OPTION.match(line).groups() for line in body.strip().splitlines())
                text = (SITE / file).read_text(encoding="utf-8")
                begin, end = (options[key].strip('"') for key in ("start-after", "end-before"))
                assert 0 <= text.find(begin) < text.find(end), (page.name, begin, end)
                included.append(file)
    assert len(included) == 4


def test_the_reference_of_python_has_every_public_name_once():
    texts = [path.read_text(encoding="utf-8") for path in sorted((SITE / "reference").glob("*.md"))]
    named = [
        name for text in texts for name in re.findall(r"^\.\. auto\w+:: (?:wavesplat\.)?(\w+)$", text, re.MULTILINE)
    ]
    assert sorted(named) == sorted(name for name in ws.__all__ if name != "__version__")


def test_pages_are_mended_for_those_who_hear_them():
    spec = importlib.util.spec_from_file_location("accessible_pages", SITE / "accessible_pages.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    page = "<dt>f(<dl>\n<dd><em>a</em>,</dd>\n<dd><em>b</em></dd>\n</dl>\n)</dt>\n<dl><dt>x</dt>\n<dd>y</dd>\n</dl>"
    assert module.mended(page) == page.replace("<dl>\n", '<dl role="list">\n').replace(
        "<dd><em>", '<dd role="listitem"><em>'
    )
    button = '<button type="button" class="btn search-button-field x" title="Search" aria-label="Search" data-x="1">'
    assert module.mended(button) == button.replace(' aria-label="Search"', "")
    assert module.mended('<button class="other" aria-label="Search">') == '<button class="other" aria-label="Search">'
