"""The scenes of the golden pictures, from the bundled volumes, and the comparison of a picture with its golden.

Few and small: what a formula can say is in other tests, goldens notice what nobody thought of. All curves are given
here, so that presets may get better, and what is fitted to a histogram may change, without changing a golden.
`python/tools/make_goldens.py` draws them.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

ROOT = Path(__file__).parents[3]
GOLDENS = ROOT / "goldens"
FAILURES = ROOT / "target" / "golden-failures"

SIZE = (96, 96)
#: Largest side of a golden in pixels, and largest file in bytes.
MAX_PIXELS, MAX_BYTES = 128, 16 * 1024
#: Largest difference, levels of 255: pictures of a build have the same bits; other compilers may round otherwise.
MAX_LEVELS = 1

BONE = [(-1000, 0.0, 0.2, 0.3), (200, 0.9, 0.6, 0.4), (1000, 1.0, 1.0, 0.95)]
HEAD = [(0, 0.0, 0.2, 0.3), (44, 0.9, 0.6, 0.4), (66, 1.0, 0.95, 0.85), (110, 1.0, 1.0, 1.0)]
#: Transfer function for skin, muscle and bone, in Hounsfield units.
SOFT = ws.TransferFunction(
    [
        *[(-600, 0), (-400, 0.012), (-150, 0.003), (-30, 0.003), (40, 0.012)],
        *[(110, 0.012), (160, 0.08), (260, 0.35), (500, 0.7), (1200, 0.85)],
    ],
    [
        *[(-600, 1, 0.8, 0.68), (-150, 1, 0.84, 0.68), (-30, 0.98, 0.66, 0.48), (40, 0.92, 0.38, 0.28)],
        *[(110, 0.92, 0.4, 0.3), (180, 0.98, 0.84, 0.66), (350, 1, 0.95, 0.84), (800, 1, 0.99, 0.95)],
    ],
    opacity_unit=1.0,
)


def soft_ct() -> ws.Picture:
    """Skin over bones."""
    ct = ws.examples.ct_pelvis()
    return ws.render(ct, SOFT, ws.Camera.orbit(ct, 25, 15, fit="view"), size=SIZE, background="black", keep_table=True)


def hard_mri_in_perspective() -> ws.Picture:
    """A surface without thickness, in perspective, by a cubic B-spline."""
    mri = ws.examples.mri_head()
    step = ws.TransferFunction([(21, 0), (22, 1)], HEAD)
    eye = ws.Camera.orbit(mri, 50, 15, view_angle=40, zoom=1.3, fit="view")
    return ws.render(mri, step, eye, size=SIZE, kernel="bspline3", background="black")


def maximum() -> ws.Picture:
    """A maximum projection of the head, from its left."""
    greys = ws.TransferFunction([(0, 1)], [(10, 0, 0, 0), (150, 1, 1, 1)])
    return ws.render(ws.examples.mri_head(), greys, "left", size=SIZE, composite="maximum", background="black")


def labels() -> ws.Picture:
    """The body with one half hidden by a label, and the bones of that half in a solid colour."""
    ct = ws.examples.ct_pelvis()
    segmentation = np.zeros(ct.shape, np.uint8)
    segmentation[:, :, : ct.shape[2] // 2] = 1
    segmentation[(segmentation == 1) & (ct.samples > 220)] = 2
    looks = {1: ws.Label("grey", 0, scan=0), 2: ws.Label("#40a0e0", 0.9, name="bone")}
    view = ws.Camera.orbit(ct, 25, 15, fit="view")
    of_scene = {"labels": ws.Labels(segmentation, looks), "background": "black", "keep_table": True}
    return ws.render(ct, SOFT, view, size=SIZE, **of_scene)


def two_dimensional() -> ws.Picture:
    """Skin and bone, by value and gradient; cut open by a plane, seen from behind."""
    ct = ws.examples.ct_pelvis()
    skin, bone = (-400, 1.5, 40, "#c08060", 0.1), (300, 1.0, 30, "#fff2d9", 0.7)
    surfaces = ws.TransferFunction2D.boundaries([skin, bone])
    middle = np.mean(ct.bounds, axis=0)
    view = ws.Camera.orbit(ct, 150, 10, fit="view")
    of_scene = {"clip": ws.ClipPlane(middle, (-1, -0.5, 0)), "background": "black", "keep_table": True}
    return ws.render(ct, surfaces, view, size=SIZE, **of_scene)


def coarse_wavelet_level() -> ws.Picture:
    """The head without the two finest levels of details, which is as bright as the whole."""
    mri = ws.examples.mri_head()
    wavelets = ws.WaveletVolume.from_volume(mri, "cdf53", threshold=4)
    soft = ws.TransferFunction([(20, 0), (45, 0.05), (110, 0.4)], HEAD)
    return ws.render(
        wavelets.level(2), soft, ws.Camera.orbit(mri, 50, 15, zoom=1.2, fit="view"), size=SIZE, background="black"
    )


SCENES: dict[str, Callable[[], ws.Picture]] = {
    scene.__name__: scene
    for scene in (soft_ct, hard_mri_in_perspective, maximum, labels, two_dimensional, coarse_wavelet_level)
}


def path_of(name: str) -> Path:
    """Path of the golden picture of a scene."""
    return GOLDENS / f"{name}.png"


def png(picture: ws.Picture) -> bytes:
    """PNG file of a picture, with 8 bits per channel."""
    return picture._repr_png_()


def difference(name: str, want: bytes | None, got: bytes, failures: Path) -> str | None:
    """Compare a picture with its golden; on a difference save both to `failures`, and return a message with numbers."""
    want_levels, got_levels = (None if content is None else _levels(content) for content in (want, got))
    if want_levels is None:
        problem = "there is no golden picture; if it is to be one, `make golden` draws it"
    elif want_levels.shape != got_levels.shape:
        problem = f"the golden picture has shape {want_levels.shape}, this one {got_levels.shape}"
    else:
        apart = np.abs(want_levels.astype(int) - got_levels)
        worst = int(apart.max())
        if worst <= MAX_LEVELS:
            return None
        y, x = (int(place) for place in np.unravel_index(apart.max(axis=2).argmax(), apart.shape[:2]))
        n_wrong = (apart.max(axis=2) > MAX_LEVELS).sum()
        gain = 255 // worst
        problem = (
            f"{n_wrong} of {apart[..., 0].size} pixels differ by more than {MAX_LEVELS} of 255 levels, "
            f"by {worst} at row {y}, column {x}: {got_levels[y, x].tolist()} instead of {want_levels[y, x].tolist()}; "
            f"by {apart.mean():.3f} on average (the picture of the difference shows {gain} times as much)"
        )
    failures.mkdir(parents=True, exist_ok=True)
    for old in failures.glob(f"{name}.*.png"):
        old.unlink()
    (failures / f"{name}.got.png").write_bytes(got)
    if want is not None:
        (failures / f"{name}.want.png").write_bytes(want)
        if want_levels.shape == got_levels.shape:
            _save(apart[..., :3] * gain, failures / f"{name}.difference.png")
    return f"{name}: {problem}; see {failures}"


def _levels(content: bytes) -> NDArray[np.uint8]:
    from PIL import Image

    with Image.open(io.BytesIO(content)) as image:
        return np.asarray(image.convert("RGBA"))


def _save(levels: NDArray[np.int_], path: Path) -> None:
    from PIL import Image

    Image.fromarray(levels.astype(np.uint8)).save(path)
