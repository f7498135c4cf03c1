"""Fixtures that test files share: a small oblique volume, and the command line as a function."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from cases_of_the_day import mark_the_rest
from command_server import CommandServer, can_fork
from hypothesis import HealthCheck, settings
from references import References

# Other processes may hold the cores at any moment: how long an example takes says nothing about what it tests.
for name, n in (("day", 30), ("night", 300)):
    settings.register_profile(name, max_examples=n, deadline=None, suppress_health_check=[HealthCheck.too_slow])
# The cache of lazy volumes, and the list of recent files, must not come from, or go to, the user's own folder.
os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp(prefix="wavesplat-tests-")
os.environ["XDG_STATE_HOME"] = os.environ["XDG_CACHE_HOME"]
atexit.register(shutil.rmtree, os.environ["XDG_CACHE_HOME"], ignore_errors=True)

# Shells let processes in the background ignore Ctrl-C, and `nohup` the end of a terminal. Their children inherit it, so
# that tests of these signals would wait for minutes, and fail.
for name_of_signal in ("SIGINT", "SIGHUP"):
    number = getattr(signal, name_of_signal, None)
    if number is not None and signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)

# Tests compare bytes of pictures, which are the same on every machine only if the CPU draws.
os.environ.setdefault("WAVESPLAT_DEVICE", "cpu")

SPACING = (0.7, 0.8, 1.5)


@pytest.fixture(scope="session", autouse=True)
def documents_keep_to_their_schemas():
    """Hold every scene, saved state and report of all tests to the schemas that the package ships."""
    import jsonschema

    from wavesplat._picture.report import FIELDS, Report
    from wavesplat._scene.documents import scene_json

    schema = Path(scene_json.__file__).with_name("scene.schema.json")
    scenes = jsonschema.Draft202012Validator(json.loads(schema.read_text(encoding="utf-8")))
    reports = jsonschema.Draft202012Validator(Report.schema())
    write, to_json = scene_json.write, Report.to_json

    def checked_write(document):
        text = write(document)
        scenes.validate(json.loads(text))
        return text

    def made(report, *args, **fields):
        dict.__init__(report, *args, **fields)
        assert set(report) <= set(FIELDS)

    def checked_report(report, *args, **options):
        text = to_json(report, *args, **options)
        reports.validate(json.loads(text))
        return text

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scene_json, "write", checked_write)
        patch.setattr(Report, "__init__", made)
        patch.setattr(Report, "to_json", checked_report)
        yield


def pytest_addoption(parser):
    """Add the option of `python/tools/make_references.py`."""
    parser.addoption("--make-references", action="store_true", help="write the converged pictures that tests keep")


def pytest_make_parametrize_id(val, argname):
    """Name bytes by their parameter: packed bytes hold the time, and all processes must collect the same names."""
    return argname if isinstance(val, bytes) else None


class Oblique(NamedTuple):
    """Samples [z, y, x] and their place in the RAS world."""

    samples: np.ndarray
    world_from_index: np.ndarray

    @property
    def lps_from_index(self):
        return np.diag([-1.0, -1.0, 1.0, 1.0]) @ self.world_from_index


@pytest.fixture
def oblique():
    """A volume that is anisotropic, rotated about two axes and off the origin, with three different sizes."""
    a, b = np.radians(20), np.radians(-35)
    turn_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    turn_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    world_from_index = np.eye(4)
    world_from_index[:3, :3] = turn_z @ turn_x * SPACING
    world_from_index[:3, 3] = (10.0, -20.0, 30.0)
    samples = np.random.default_rng(7).integers(-1000, 3000, (5, 6, 7)).astype(np.int16)
    return Oblique(samples, world_from_index)


@pytest.fixture
def ramp_file(tmp_path):
    """A NIfTI file that any preset fitted to the volume shows."""
    import nibabel

    ramp = np.linspace(0, 255, 16**3).reshape(16, 16, 16).astype(np.uint8)
    path = tmp_path / "ramp.nii.gz"
    nibabel.save(nibabel.Nifti1Image(ramp.T, np.eye(4)), path)
    return path


def pytest_configure(config):
    """Run what is named case by case, `file::test`, also where it is of the night."""
    if config.option.markexpr == "not nightly" and config.args and all("::" in name for name in config.args):
        config.option.markexpr = "nightly or not nightly"
    settings.load_profile("night" if of_night(config) else "day")


def of_night(config):
    """Whether tests of the night run too, or alone."""
    return config.option.markexpr in ("", "nightly")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Before cases are left out by their marks, mark those that are of the night."""
    if config.option.markexpr != "":
        mark_the_rest(items)


@pytest.fixture(scope="session")
def is_night(request):
    """Whether tests of the night run too: what takes long has more steps then."""
    return of_night(request.config)


@pytest.fixture(scope="session")
def references(request, is_night):
    """Converged pictures: read by day, drawn anew and compared where tests of the night run too."""
    is_made = request.config.option.make_references
    return References("made" if is_made else "compared" if is_night else "kept")


@pytest.fixture
def kept_picture(request, references):
    """The converged picture of a name, and what draws it: `kept_picture("soft ct", draw)`."""
    return partial(references.picture, request.path.stem)


@pytest.fixture(scope="session")
def command_server():
    """The process that forks for commands, of this worker."""
    server = CommandServer()
    yield server
    server.close()


@pytest.fixture
def wavesplat(command_server):
    """Run the command line in a process of its own; return its exit code, stdout and stderr."""

    def run(*arguments, cwd=None, **environment):
        arguments = [*map(str, arguments)]
        if can_fork(environment):
            return command_server.run(arguments, cwd, environment, timeout=120)
        return subprocess.run(
            [sys.executable, "-m", "wavesplat", *arguments],
            capture_output=True,
            encoding="utf-8",  # libraries in this process may have changed its locale
            timeout=120,
            check=False,
            cwd=cwd,
            env={**os.environ, "PYTHONUTF8": "1", **environment},
        )

    return run
