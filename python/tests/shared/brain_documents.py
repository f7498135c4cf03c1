"""Valid and damaged documents, and what each reader answers: the document as it is written again, or the message.

The texts are kept with the answers, so that other languages can be held to them without this file.
"""

from __future__ import annotations

import json
import random
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from damage import NESTED, ODD_VALUES, damaged_json

import wavesplat as ws
from wavesplat import _native
from wavesplat.errors import WavesplatError

SCENES = Path(__file__).parents[1] / "fixtures" / "scenes"
#: Damaged documents of each valid one; patches of one path have few fields.
N_DAMAGED, N_OF_PATHS = 60, 3
#: Values that make short messages.
VALUES = [one for one in ODD_VALUES if one != NESTED and not (isinstance(one, str | list) and len(one) > 100)]
#: A folder that is nowhere, for names of files in scenes.
NOWHERE = Path("/nowhere")


def texts() -> Iterator[tuple[str, str, str]]:
    """Name, reader and text of each document."""
    chance = random.Random(61)  # noqa: S311 - the same numbers each time
    for reader, name, document in _valid():
        yield name, reader, json.dumps(document)
        for number in range(N_OF_PATHS if name.startswith("path") else N_DAMAGED):
            yield f"{name}, damaged {number}", reader, damaged_json(document, _changes(chance))
    for path in sorted((SCENES / "bad").glob("*.json")):
        yield f"bad scene {path.stem}", "scene", path.read_text(encoding="utf-8")
    for text in ("", "[]", "null", "{", "NaN", '{"version": 1, "version": 1}', '"\\ud800"', "1e999"):
        for reader in READERS:
            yield f"{reader}: text {text}", reader, text


def _valid() -> Iterator[tuple[str, str, Any]]:
    curves = ws.TransferFunction(
        [(0, 0), (120, 0.2), (255, 0.5)], [(0, 1, 0, 0), (255, 1, 1, 1)], 0.7, [(0, 0), (9, 1)]
    )
    light = ws.Shading(lights=[ws.Light((0, 0, 1))])
    look = ws.Look(transfer_function=curves, shading=light, name="mine", view="front", background="white")
    table = ws.TransferFunction2D((0, 100, 255), (0, 5), [[(0, 0.5, 1, 0.25)] * 3] * 2)
    yield "look", "look", json.loads(look.to_json())
    yield "look", "preset", json.loads(ws.Look.preset("ct-bone").to_json())
    yield "transfer function", "curves", json.loads(curves.to_json())
    yield "transfer function 2d", "table", json.loads(table.to_json())
    yield "materials", "materials of ct", json.loads(ws.Materials.preset("ct").to_json())
    yield "camera", "orthographic", ws.Camera((1, 2, 3), (0, 0, 0), (0, 0, 1), parallel_scale=9.5).as_json()
    yield "camera", "perspective", ws.Camera((1, 2, 3), (0, 0, 0), (0, 0, 1), view_angle=30).as_json()
    for name in ("everything", "least"):
        yield "scene", name, json.loads((SCENES / "good" / f"{name}.json").read_text(encoding="utf-8"))
    state = {"a": {"b": [1, 2, {"c": None}], "x/y": "~"}, "n": 1.5}
    steps = [
        {"op": "replace", "path": "/a/b/2/c", "value": [3]},
        {"op": "add", "path": "/a/b/-", "value": {"d": 0.1}},
        {"op": "add", "path": "/a/x~1y", "value": "z"},
        {"op": "remove", "path": "/a/b/0"},
        {"op": "add", "path": "/new", "value": True},
    ]
    yield "patch", "patch", {"document": state, "operations": steps}
    for number, path in enumerate(("", "a", "/", "/a/b/01", "/a/b/9", "/a/b/-", "/n/x", "/a/~0", "/q/r", "/a/b/3")):
        for kind in ("add", "replace", "remove"):
            yield (
                "patch",
                f"path {number}, {kind}",
                {
                    "document": state,
                    "operations": [{"op": kind, "path": path, **({} if kind == "remove" else {"value": 7})}],
                },
            )


def _changes(chance: random.Random) -> list[tuple[str, int, Any]]:
    def below(n: int) -> int:
        return int(chance.random() * n)

    changes: list[tuple[str, int, Any]] = []
    for _ in range(1 + below(2)):
        kind = ("value", "value", "value of", "lose", "twice", "listed", "add")[below(7)]
        value = VALUES[below(len(VALUES))]
        what = {"value": value, "add": (("", "a", "name")[below(3)], value)}.get(kind, below(1 << 20))
        changes.append((kind, below(1 << 20), what))
    return changes


def _scene(text: str) -> str:
    return ws.Scene.from_json(text, NOWHERE).to_json()


def _patched(text: str) -> str:
    given = json.loads(text)
    if not isinstance(given, dict) or "document" not in given:
        given = {"document": {}, "operations": given}
    return json.dumps(_native.patched(given["document"], given.get("operations")))


READERS: dict[str, Callable[[str], str]] = {
    "look": lambda text: ws.Look.from_json(text).to_json(),
    "transfer function": lambda text: ws.TransferFunction.from_json(text).to_json(),
    "transfer function 2d": lambda text: ws.TransferFunction2D.from_json(text).to_json(),
    "materials": lambda text: ws.Materials.from_json(text).to_json(),
    "camera": lambda text: json.dumps(ws.Camera.from_json(text).as_json()),
    "scene": _scene,
    "patch": _patched,
}


def answer(reader: str, text: str) -> dict[str, Any]:
    """The answer of a reader to a text: the document that it writes, or its message, and warnings."""
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        try:
            found: dict[str, Any] = {"written": READERS[reader](text)}
        except WavesplatError as error:
            found = {"error": f"{type(error).__name__}: {error}"}
        except json.JSONDecodeError:
            found = {"error": "no JSON"}  # of patches alone, which come decoded
    return found | ({"warnings": [str(one.message) for one in given]} if given else {})


def lines() -> Iterator[tuple[str, dict[str, Any]]]:
    """Each document with its answer."""
    for name, reader, text in texts():
        yield f"{reader}: {name}", {"reader": reader, "text": text, "answer": answer(reader, text)}
