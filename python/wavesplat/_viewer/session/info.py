"""The first message to a page, and facts of what is open: volumes, presets, standard views."""

from __future__ import annotations

import hashlib
from typing import Any, get_args

import numpy as np

from wavesplat import _native
from wavesplat._looks import presets
from wavesplat._looks.kinds.histogram import robust_range
from wavesplat._looks.kinds.kinds import Found, found_in, unit_of_values
from wavesplat._model.arguments.sampling import Composite, Kernel
from wavesplat._model.camera.camera import Camera
from wavesplat._model.camera.fit import axes_of
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.series import Series, time_texts
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render.windows import CT_WINDOWS
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._viewer.page_requests.under_pointer import color_fields_of
from wavesplat._viewer.server.messages import PROTOCOL
from wavesplat._viewer.session.state import ViewerState

VIEWS = ("front", "back", "left", "right", "top", "bottom")
#: Labels of the ends of -x, +x, -y, +y, -z, +z: for bodies, and for other data.
BODY_ENDS = ("L", "R", "P", "A", "I", "S")
AXIS_ENDS = ("-x", "+x", "-y", "+y", "-z", "+z")
#: Number of samples of a volume that a fingerprint is made of, about.
N_SAMPLES = 4096
#: Units of lengths as people write them.
SYMBOLS = {"um": "µm", "angstrom": "Å"}


def welcome_of(state: ViewerState) -> dict[str, Any]:
    """The first message to a page: the fields of `Welcome` in `web/src/engine/engine.ts`."""
    return {
        "protocol": PROTOCOL,
        "program": f"wavesplat {_native.__version__}",
        "state": state.document,
        **data_of(state),
    }


def data_of(state: ViewerState) -> dict[str, Any]:
    """Facts of what is open, which change with it: the fields of `Data` in `web/src/engine/engine.ts`."""
    scene = state.scene
    first = scene.layers[0].drawn
    fitting = [{preset.name for preset in presets.fitting(layer.drawn)} for layer in scene.layers]
    return {
        "volumes": [
            {**_volume(layer), "color_field": field}
            for layer, field in zip(scene.layers, color_fields_of(scene), strict=True)
        ],
        "bounds": scene.bounds.tolist(),
        "presets": [
            {
                "name": one.name,
                "description": one.description,
                "kind": one.kind,
                "layers": [n for n, names in enumerate(fitting) if one.name in names],
            }
            for one in sorted(presets.catalogue().values(), key=lambda one: one.name not in fitting[0])
        ],
        "composites": list(get_args(Composite)),
        "kernels": list(get_args(Kernel)),
        "window_names": {name: list(window) for name, window in CT_WINDOWS.items()},
        "standard_views": {
            # From below, data that are no body's are as an array is shown, row 0 on top.
            name: Camera.view(
                scene,
                "xy" if name == "bottom" and not first.is_anatomical else name,
                view_angle=state.camera.view_angle,
            ).as_json()
            for name in VIEWS
        },
        "upright": _upright(state.first_view.camera),
        "axis_ends": list(BODY_ENDS if first.is_anatomical else AXIS_ENDS),
        "fingerprint": fingerprint_of(scene),
    }


def fingerprint_of(scene: Scene) -> str:
    """A hash that distinguishes data: shapes, places and some samples of the volumes."""
    digest = hashlib.sha256()
    for layer in scene.layers:
        volume = layer.drawn
        digest.update(repr((volume.shape, volume.world_from_index.tolist())).encode())
        if isinstance(volume, LazyVolume):
            survey = volume.survey(volume._surveyed_level(), "linear")
            digest.update(repr((survey.value_range, survey.n_nonfinite)).encode())
            digest.update(survey.looks.coarsest.tobytes())
        elif isinstance(volume, Volume):
            samples = volume.samples.reshape(-1) if volume.samples.flags.c_contiguous else volume.samples.flat
            step = max(1, volume.samples.size // N_SAMPLES)
            digest.update(np.asarray(samples[::step]).tobytes())
    return f"sha256:{digest.hexdigest()}"


def _upright(camera: Camera) -> list[float]:
    """The axis of the world, a unit vector, that is nearest to the upward direction of a camera's picture."""
    _, up, _ = axes_of(camera)
    axis = int(np.abs(up).argmax())
    return [float(np.sign(up[axis])) if n == axis else 0.0 for n in range(3)]


def _volume(layer: Layer) -> dict[str, Any]:
    volume = layer.drawn
    found = found_in(volume)
    low, high = robust_range(volume)
    least, most = (low, high)
    if isinstance(volume, LazyVolume):
        least, most = volume.value_range
    elif isinstance(volume, Volume):
        finite = volume.samples[np.isfinite(volume.samples)] if volume.n_nonfinite else volume.samples
        if finite.size:
            least, most = float(finite.min()), float(finite.max())
    return {
        "name": layer.name,
        "shape": list(reversed(volume.shape)),
        "spacing": list(volume.spacing),
        "unit": SYMBOLS.get(volume.unit, volume.unit) if volume.unit else volume.unit,
        "value_unit": unit_of_values(volume) or "",
        "kind": found.kind,
        "dtype": str(volume.dtype) if isinstance(volume, Volume) else "wavelets",
        "orientation": volume.orientation if volume.is_anatomical else None,
        "notes": _notes(volume, found),
        "range": [least, most],
        "robust_range": [low, high],
        "bounds": volume.bounds.tolist(),
        "is_anatomical": volume.is_anatomical,
        "n_times": len(layer.volume) if isinstance(layer.volume, Series) else 1,
        "times": _times(layer.volume),
        "affine": volume.world_from_index.tolist(),
    }


def _times(volume: Any) -> list[str]:
    """Texts of the times of a series, such as "30 s"; none where their unit is not known."""
    is_known = isinstance(volume, Series) and volume.time_unit is not None
    return list(time_texts(volume.times, volume.time_unit)) if is_known else []


def _notes(volume: Volume | WaveletVolume, found: Found) -> list[str]:
    """Guesses about a volume, and faults of its samples, as sentences for people."""
    kind = f"taken for {found.reason}" if found.is_guess else found.reason
    missing = volume.n_nonfinite if isinstance(volume, Volume) else 0
    holes = [f"{missing} samples are NaN or infinite: they are missing, and matter around them is fainter"]
    return [kind, *volume.facts.guesses, *(holes if missing else [])]
