"""The lines of the oracle: all that the program decides by itself about a volume, floats as hexadecimal texts.

Documents have what readers answer (`brain_documents.py`). `python/tests/fixtures/brain` keeps all lines, and
`python/tools/brain_oracle.py` draws them anew.
"""

from __future__ import annotations

import hashlib
import json
import lzma
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import brain_documents
import cmap
import numpy as np
from brain_phantoms import ct, flame, head, noise, phantoms, signed, spots

import wavesplat as ws
from wavesplat._looks import presets
from wavesplat._looks.curves import colormaps
from wavesplat._looks.kinds import histogram, hounsfield, kinds, overlays
from wavesplat._looks.kinds.channels import channel_window
from wavesplat._looks.look import Look
from wavesplat._model.camera.views import VIEWS
from wavesplat._render import framing, windows
from wavesplat._render.arguments import chosen_camera
from wavesplat.errors import WavesplatError

FOLDER = Path(__file__).parents[1] / "fixtures" / "brain"
#: Longest list that a line has whole: of longer ones it has some items, and the hash of all.
LONGEST, KEPT = 40, 9
#: One projection for each way to find greys: the other maxima have those of one of the first two.
PROJECTIONS = ("maximum", "depth-shaded-maximum", "minimum", "mean", "sum", "x-ray")
#: Fields with positions, which matrix products of NumPy's libraries round otherwise on other processors, and the
#: difference of two numbers there that counts as rounding, as a share of the largest number beside them.
PLACED, ROUNDING = ("points", "camera"), 1e-12
#: The same of all other numbers, as a share of the number: NumPy's own exponentials differ by last places where it has
#: AVX-512 and where it has not.
LAST_PLACES = 1e-14
#: Greys of the X-ray projection, which are sums of exponentials: as positions, and without the hash of the whole list.
SUMMED = "greys x-ray"
Line = dict[str, Any]


def exact(thing: Any) -> Any:  # noqa: PLR0911 - one for each type
    """A value as JSON that is equal only where it is equal to the bit."""
    if isinstance(thing, np.ndarray):
        return exact(thing.tolist())
    if isinstance(thing, bool | str | None):
        return thing
    if isinstance(thing, int | np.integer):
        return int(thing)
    if isinstance(thing, float | np.floating):
        return float(thing).hex()
    if isinstance(thing, ws.TransferFunction2D):
        rows = {"values": thing.values, "magnitudes": thing.magnitudes, "rows": thing.rows}
        return exact({**rows, "opacity_unit": thing.opacity_unit, "rgba": thing.rgba.reshape(-1, 4)})
    if isinstance(thing, ws.Labels):
        return {"numbers": exact(thing.numbers), "looks": exact(thing.labels), "smooth": thing.smooth}
    if is_dataclass(thing):
        kept = (field.name for field in fields(thing) if not field.name.startswith("_"))
        return {name: exact(getattr(thing, name)) for name in kept}
    if isinstance(thing, dict):
        return {str(key): exact(value) for key, value in thing.items()}
    return _shortened([exact(one) for one in thing])


def _shortened(items: list[Any]) -> Any:
    if len(items) <= LONGEST:
        return items
    places = [number * (len(items) - 1) // (KEPT - 1) for number in range(KEPT)]
    return {"n": len(items), "hash": hash_of(json.dumps(items)), "some": [items[place] for place in places]}


def hash_of(data: str | bytes) -> str:
    """A short hash of a text or of bytes."""
    return hashlib.sha256(data.encode() if isinstance(data, str) else data).hexdigest()[:16]


def hash_of_array(array: np.ndarray) -> str:
    """A short hash of shape and numbers, which do not depend on the order of bytes."""
    plain = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    return hash_of(f"{plain.shape}{plain.dtype.str}".encode() + plain.tobytes())


def found(make: Callable[[], Any]) -> Any:
    """The result of a function, or its error, with the warnings that it gives."""
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        try:
            answer = exact(make())
        except WavesplatError as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
    texts = [str(one.message) for one in given]
    return {"answer": answer, "warnings": texts} if texts else answer


def line_of_volume(make: Callable[[], ws.Volume]) -> Line:
    """All that is decided for a volume."""
    try:
        volume = make()
    except WavesplatError as error:
        return {"error": f"{type(error).__name__}: {error}"}
    asked: dict[str, Callable[[], Any]] = {
        "kind": lambda: _evidence(volume),
        "unit": lambda: kinds.unit_of_values(volume),
        "offset": lambda: kinds.offset_of(volume),
        "robust range": lambda: histogram.robust_range(volume),
        "attenuation": lambda: histogram.attenuation(volume),
        "channel window": lambda: channel_window(volume),
        "window": lambda: windows.limits(volume, None, None),
        "window of percentiles": lambda: windows.limits(volume, ("2%", "98.5%"), None),
        "presets": lambda: [one.name for one in presets.fitting(volume)],
        "side": lambda: (framing.natural_view(volume), framing.is_upright(volume), framing.is_of_patient(volume)),
        "look": lambda: Look.auto(volume),
        "surfaces": lambda: ws.TransferFunction2D.boundaries(_surfaces(volume), n_values=24),
        "over others": lambda: overlays.cleared(Look.auto(volume), volume, "over"),
        **{f"greys {name}": lambda name=name: _curves(Look.auto(volume, name)) for name in PROJECTIONS},
    }
    line = {"volume": _facts(volume), **{name: found(make) for name, make in asked.items()}}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            parts = [(volume, Look.auto(volume))]
    except WavesplatError:
        return line
    return line | {name: found(make) for name, make in _cameras(volume, parts).items()}


def _surfaces(volume: ws.Volume) -> list[tuple[Any, ...]]:
    low, high = histogram.robust_range(volume)
    return [(low + part * (high - low), 0.8, 0.02 * (high - low), "#fff2d9", 0.3 + part) for part in (0.3, 0.6)]


def _facts(volume: ws.Volume) -> Line:
    samples = volume.read().samples if hasattr(volume, "read") else volume.samples
    facts = {name: value for name, value in exact(volume.facts).items() if value not in (None, [], False)}
    placed = {"shape": list(volume.shape), "type": volume.dtype.name, "range": exact(volume.value_range)}
    return {
        **placed,
        "content": hash_of_array(samples),
        "matrix": exact(volume.world_from_index[:3]),
        "missing": int(volume.n_nonfinite),
        "facts": facts,
    }


def _evidence(volume: ws.Volume) -> Line:
    known = kinds.evidence(volume)
    seen = {"n": known.values.size, "values": hash_of_array(known.values), "fill": known.fill}
    flags = {"noise": known.has_noise, "few bright": known.has_few_bright, "guess": known.is_guess}
    offset, looks_ct = hounsfield.stored_offset(known.values), hounsfield.looks_like_hounsfield(known.values, volume)
    low, high = histogram.robust_range_of(known.values)
    parted = (low, histogram.otsu(known.values, low, high), high) if low < high else None
    more = {"stored offset": offset, "hounsfield": looks_ct, "parted": parted, "mean gradient": known.gradients.mean()}
    return {"kind": known.kind, "reason": known.reason, **flags, **seen, **more}


def _curves(look: Look) -> Line:
    function = look.transfer_function
    colors = function.color
    if all(red == green == blue for _, red, green, blue in colors):
        colors = [node[:2] for node in colors]
    return {"opacity": function.opacity, "color": colors, "name": look.name, "view": look.view}


def _cameras(volume: ws.Volume, parts: list[Any]) -> dict[str, Callable[[], Any]]:
    def shown() -> Line:
        _, points = framing.shown_points(parts)
        if points is None:
            return {"n": None}
        ends = {"least": points.min(axis=0), "most": points.max(axis=0)}
        return {"n": len(points), **ends, "hash": hash_of_array(points.astype(np.float32))}

    def whole() -> Line:
        made = {name: _lens(ws.Camera.view(volume, name)) for name in VIEWS}
        turn = {f"turn {angle}": _lens(ws.Camera.orbit(volume, angle, 15)) for angle in (0, 33)}
        wide = {"turn in perspective": _lens(ws.Camera.orbit(volume, 33, 15, view_angle=30, aspect=1.6))}
        return {**made, **turn, **wide}

    return {
        "points": shown,
        "camera": lambda: _lens(chosen_camera(None, parts, framing.EVERYTHING, 1.0)),
        "camera, wide": lambda: _lens(chosen_camera(None, parts, framing.EVERYTHING, 1.6, view_angle=30.0)),
        "camera turned": lambda: _lens(chosen_camera(None, parts, framing.EVERYTHING, 0.7, turned=(25, 10), zoom=1.3)),
        "cameras of the box": whole,
    }


def _lens(camera: ws.Camera) -> list[Any]:
    """Numbers of a camera: where, what at, up, half the height, angle."""
    lens = [camera.parallel_scale, camera.view_angle]
    return [[*camera.position, *camera.focal_point, *camera.view_up], *lens]


def lines_of_presets() -> Iterator[tuple[str, Line]]:
    """Every preset over a known volume, windows by name, overlays and changed looks."""
    by_name = phantoms()
    made = {name: by_name[name]() for name in ("ct", "mr i2", "pet", "cells", "flame f4", "signed", "ct offset 1024")}
    subjects = {
        "ct": "ct",
        "mr": "mr i2",
        "pet": "pet",
        "microscopy": "cells",
        "simulation": "flame f4",
        "any": "mr i2",
    }
    for name, entry in presets.catalogue().items():
        if entry.kind == "slicer":
            subject = "ct offset 1024" if entry.is_hounsfield else "mr i2"
        else:
            subject = "signed" if name == "signed" else subjects[entry.kind]
        yield f"preset {name}", {subject: found(lambda name=name, of=subject: Look.preset(name, made[of]))}
    for name in windows.CT_WINDOWS:
        yield f"window {name}", {of: found(lambda: windows.limits(made[of], name, None)) for of in ("ct", "mr i2")}  # noqa: B023
    for of, volume in made.items():
        yield f"overlay of {of}", {name: found(make) for name, make in _overlays(volume).items()}
        yield f"changed look of {of}", {name: found(make) for name, make in _changes(volume).items()}


def _overlays(volume: ws.Volume) -> dict[str, Callable[[], Any]]:
    def look(*args: Any, **options: Any) -> Callable[[], Any]:
        return lambda: ws.Layer.overlay(volume, *args, **options).look

    ways = {"plain": look(), "hot": look("hot"), "coolwarm": look("coolwarm", (0.3, 1)), "red": look("red", (1, 50))}
    ways |= {"percent": look("viridis", ("5%", "99%")), "threshold": look(threshold=0.5)}
    return ways | {"beyond": look("hot", (0, 5), threshold=2.0), "unknown": look("hott")}


def _changes(volume: ws.Volume) -> dict[str, Callable[[], Any]]:
    look = Look.auto(volume)

    def change(**options: Any) -> Callable[[], Any]:
        return lambda: look.changed(volume=volume, **options)

    flat = replace(look, shading=None)
    return {
        "window": change(window=(10, 70)),
        "percent": change(window=("1%", "99%")),
        "gamma": change(gamma=1.7),
        "opacity": change(opacity="sigmoid"),
        "numbers": change(opacity=[0, 0.2, 1]),
        "exposure": change(exposure=1.5),
        "exposure without light": lambda: flat.changed(exposure=1.5),
        "darker without light": lambda: flat.changed(exposure=0.6),
        "all": change(window=(10, 70), gamma=0.6, opacity=0.4, exposure=2),
    }


def lines_of_maps() -> Iterator[tuple[str, Line]]:
    """Every colour map: its colours at 17 places, the hash of its nodes, and of each fourth a curve over a range."""
    for number, name in enumerate(sorted(cmap.Catalog().short_keys())):
        yield f"map {name}", found(lambda name=name, number=number: _map(name, has_curve=number % 4 == 0))


def _map(name: str, *, has_curve: bool) -> Line:
    places, colors = colormaps.colors_of(name)
    colors = colors.round(12)  # "cubehelix" is made of sines
    at = np.linspace(0.0, 1.0, 17)
    sampled = np.stack([np.interp(at, places, part) for part in colors.T], axis=1)
    facts = {"n": len(places), "places": hash_of_array(places), "diverging": colormaps.is_diverging(name)}
    ends = {"first": sampled[0], "middle": sampled[8], "last": sampled[-1]}
    line = {**facts, "colors": hash_of_array(colors), "at 17": hash_of_array(sampled), **ends}
    if not has_curve:
        return line
    curve = ws.TransferFunction.from_colormap(name, clim=(-3.5, 12.25))
    nodes = {"opacity": curve.opacity, "color": np.array(curve.color).round(12)}
    return line | {"curve": hash_of(json.dumps(exact(nodes)))}


def lines_of_numbers() -> Iterator[tuple[str, Line]]:
    """Percentiles, medians, means and thresholds of fixed values."""
    arrays = {
        "one": np.array([2.5]),
        "two": np.array([1.0, 4.0]),
        "seven": np.array([0.1, -3.0, 7.7, 0.1, 2.0, 1e9, -1e-9]),
        "equal": np.full(50, 0.3),
        **{f"{n} noise": noise((n,), n) for n in (10, 99, 1000, 4097, 150_001)},
        **{name: make().ravel() for name, make in (("ct", ct), ("head", head), ("spots", spots), ("flame", flame))},
        "signed": signed().ravel(),
        "float32": flame().astype(np.float32).ravel(),
        "bytes": head().astype(np.uint8).ravel(),
    }
    for name, values in arrays.items():
        yield f"numbers {name}", found(lambda values=values: _statistics(values))


def _statistics(values: np.ndarray) -> Line:
    shares = [0, 0.1, 0.5, 1, 2, 10, 25, 50, 75, 90, 98, 99.5, 99.8, 99.9, 100]
    own = values.astype(np.float64)
    low, high = histogram.robust_range_of(own)
    cut = {"otsu": histogram.otsu(own, low, high), "scan": histogram.otsu_of_scan(own, low, high)} if low < high else {}
    return {
        "percentiles": np.percentile(values, shares),
        "median": np.median(values),
        "mean": own.mean(),
        "deviation": own.std(),
        "robust": (low, high),
        **cut,
        "stored offset": hounsfield.stored_offset(own),
        "histogram": np.histogram(own, bins=32, range=(low, high if low < high else low + 1))[0],
    }


def groups() -> dict[str, Callable[[], Iterable[tuple[str, Line]]]]:
    """The functions that make the lines that need no files of others, by group."""
    bundled = {"ct_pelvis": ws.examples.ct_pelvis, "mri_head": ws.examples.mri_head}

    def volumes(makers: dict[str, Callable[[], ws.Volume]]) -> Iterator[tuple[str, Line]]:
        return ((name, line_of_volume(make)) for name, make in makers.items())

    return {
        "phantoms": lambda: volumes(phantoms()),
        "bundled": lambda: volumes(bundled),
        "presets": lines_of_presets,
        "maps": lines_of_maps,
        "numbers": lines_of_numbers,
        "documents": brain_documents.lines,
    }


def kept(group: str) -> dict[str, Line]:
    """The lines of a group that the repository has, by name."""
    text = lzma.decompress((FOLDER / f"{group}.jsonl.xz").read_bytes()).decode("utf-8")
    return dict(map(json.loads, text.splitlines()))


def keep(group: str, lines: dict[str, Line]) -> None:
    """Write the lines of a group."""
    text = "".join(json.dumps(item) + "\n" for item in lines.items())
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / f"{group}.jsonl.xz").write_bytes(lzma.compress(text.encode("utf-8"), preset=9 | lzma.PRESET_EXTREME))


def differences(old: Any, new: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Path, old and new value of all that differs between two lines."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            yield from differences(old.get(key), new.get(key), f"{path}/{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for number, pair in enumerate(zip(old, new, strict=True)):
            yield from differences(*pair, f"{path}/{number}")
    elif old != new or type(old) is not type(new):
        yield path, old, new


def in_words(old: dict[str, Line], new: dict[str, Line], *, to_the_bit: bool = False, most: int = 12) -> str:
    """The differences between lines, for people; "" where nothing does, or only the rounding of positions."""
    by_line, fields_in = {}, Counter[str]()
    for name in {**old, **new}:
        found = list(differences(old.get(name), new.get(name)))
        if not to_the_bit:
            found = [one for one in found if not _is_rounding(one)]
        if found:
            by_line[name] = found
            fields_in.update({path.split("/")[1] if path else "all" for path, *_ in found})
    if not by_line:
        return ""
    many = ", ".join(f"{field} in {n}" for field, n in fields_in.most_common())
    shown = [
        f"  {name}{path}\n    was {_text(was)}\n    is  {_text(now)}"
        for name, found in by_line.items()
        for path, was, now in found[:3]
    ]
    left = [f"  and {len(shown) - most} more"] if len(shown) > most else []
    return "\n".join([f"{len(by_line)} of {len(new)} lines differ: {many}", *shown[:most], *left])


def _is_rounding(difference: tuple[str, Any, Any]) -> bool:
    path, *both = difference
    if not all(isinstance(one, str) for one in both):
        return False
    if path.startswith(f"/{SUMMED}") and path.endswith("/hash"):
        return True
    try:
        was, now = map(float.fromhex, both)
    except ValueError:
        return False
    if path.startswith(tuple(f"/{name}" for name in (*PLACED, SUMMED))):
        return abs(was - now) <= ROUNDING * max(abs(was), abs(now), 1.0)
    return abs(was - now) <= LAST_PLACES * max(abs(was), abs(now))


def _text(value: Any) -> str:
    """A value for people: numbers in decimals too."""
    try:
        return (
            f"{value} ({float.fromhex(value):.17g})" if isinstance(value, str) and "0x" in value else str(value)[:300]
        )
    except ValueError:
        return value[:300]
