"""Settings of the documentation site, which `make site` builds by Sphinx.

The source folder is the checkout, so that the pages of `docs`, the README and the records of `benches` and `studies`
are read where they lie, and their links to each other hold on the site as they do in the checkout.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import sys
from pathlib import Path

import wavesplat

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))  # the extensions that lie beside this file

project = "Wavesplat"
author = "the authors of Wavesplat"
version = release = wavesplat.__version__
language = "en"
needs_sphinx = "8.1"

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "myst_nb",
    "sphinx_copybutton",
    "sphinx_design",
    "accessible_pages",
    "command_line_reference",
    "notebook_pages",
    "python_reference",
    "schema_reference",
    "site_links",
    "unreleased_changes",
]

# Files

root_doc = "docs/site/index"
include_patterns = [
    "README.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CODE_OF_CONDUCT.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "benches/README.md",
    "benches/records/*.md",
    "docs/**.md",
    "docs/notebooks/*.ipynb",
    "studies/*/RESULTS.md",
]
exclude_patterns = [".*", "target", "out", "dist", "crates", "fuzz", "goldens", "python", "web"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}

# Markdown

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4  # as web pages of repositories make them from headings, so that `page.md#heading` leads there
smartquotes = False  # what stands in quotes is mostly to be typed
suppress_warnings = ["myst.header"]  # `studies` and records begin some sections at a third level

# Notebooks: run once, and again when they change. A page has the still picture that the viewer gives beside its widget,
# which needs a kernel, and loads nothing from elsewhere. What notebooks write stays out of the checkout.
nb_execution_in_temp = True
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / ".cache" / "notebooks")
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_mime_priority_overrides = [("html", "image/png", 0)]
nb_ipywidgets_js: dict[str, dict[str, str]] = {}

# Python

autodoc_default_options = {"members": True}
autodoc_member_order = "alphabetical"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "py:obj"
add_module_names = False
maximum_signature_line_length = 88
toc_object_entries_show_parents = "hide"

# Pages

html_theme = "pydata_sphinx_theme"
html_title = f"Wavesplat {release}"
html_logo = html_favicon = "../face/logo.svg"
html_additional_pages = {"index": "first_page.html"}
templates_path = ["templates"]
# Sections of a single page have nothing to list.
html_sidebars: dict[str, list[str]] = {"docs/concepts": [], "docs/gallery": [], "docs/glossary": []}
html_copy_source = False
html_show_copyright = False
html_theme_options = {
    "logo": {"text": html_title, "alt_text": "Wavesplat: front page"},
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "show_prev_next": True,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["sphinx-version"],
    "footer_end": ["theme-version"],
}
copybutton_prompt_text = "$ "
