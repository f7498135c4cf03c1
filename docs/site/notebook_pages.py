"""Notebooks as pages: run with settings of their own, and without the state of widgets, which need Python behind them.

The state holds the whole program of the viewer, 230 KB a page, which a page without a kernel cannot use.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

#: Kernels run on this machine, and messages between two of its processes need no encryption, which they warn of.
KERNEL_SETTINGS = 'get_config().IPKernelApp.log_level = "ERROR"\n'
WIDGET_STATE = "ipywidgets_state"


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to Sphinx, and keep the user's own settings of IPython out of the pages."""
    folder = Path(app.doctreedir).resolve().parent / "ipython"
    profile = folder / "profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    (profile / "ipython_kernel_config.py").write_text(KERNEL_SETTINGS, encoding="utf-8")
    os.environ["IPYTHONDIR"] = str(folder)
    app.connect("env-updated", leave_out_widget_state)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def leave_out_widget_state(_app: Sphinx, env: BuildEnvironment) -> list[str]:
    """Take the state of widgets out of all pages; no page is to be read again."""
    for metadata in getattr(env, "nb_metadata", {}).values():
        metadata.get("js_files", {}).pop(WIDGET_STATE, None)
    return []
