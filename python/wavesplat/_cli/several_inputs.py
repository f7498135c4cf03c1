"""Commands of one INPUT run on several: quoted patterns are expanded, and each result gets a name of its own.

In the name of an output, {stem} is the input's without suffix, {name} with it, {folder} the folder that it is in,
{path} what is after the folder that all inputs share, with _ between its parts, and {number} counts from 1. Of images
of a plate of OME-Zarr {well} is the well, such as A1, and {field} the image in it. Other words in braces are refused,
but for those that a command fills itself.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable
from contextlib import suppress
from difflib import get_close_matches
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.batches import Batch, BatchOptions, batch_of, is_folder, stem_of
from wavesplat._cli.options.groups import expanded, parameters_of, with_signature
from wavesplat._cli.printing import collected, message, print_lines
from wavesplat._storage.addresses import is_address, safe_address
from wavesplat._storage.paths import matching_files
from wavesplat.errors import ArgumentError, WavesplatError

_INPUTS = typer.Argument(
    metavar="INPUT...",
    help="Volumes: files, folders or URLs; with * and ? in quotes, all files that fit.",
    show_default=False,
)
Inputs = Annotated[list[str], _INPUTS]
InputsOrNone = Annotated[list[str] | None, _INPUTS]

#: A word in braces.
WORD = re.compile(r"\{([a-z]+)\}")
#: Words in braces that only images of plates have.
OF_PLATES = ("well", "field")


def takes_several_inputs(
    suffix: str | None = None, *, own: tuple[str, ...] = (), words: tuple[str, ...] = ()
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command of one `input` several of them, one after the other.

    suffix : of results, where `output` is a folder; None for a command without an output.
    own : an option, and words in braces that the command fills itself where that option is given.
    words : words in braces that the command fills itself.

    A command with a parameter `batch` is given the `Batch` of all inputs, and has its options.
    """

    def changed(plain: Callable[..., None]) -> Callable[..., None]:
        command = expanded(plain)
        signature = inspect.signature(command, eval_str=True)
        together = parameters_of(BatchOptions) if "batch" in signature.parameters else []

        @wraps(command)
        def with_several(*, input: list[str] | None = None, **options: Any) -> None:
            if not input:
                for parameter in together:
                    options.pop(parameter.name)
                command(input=None, **options)
                return
            left = (own[1:] if own and options.get(own[0]) else ()) + words
            inputs = _found(input)
            batch = batch_of(inputs, options) if together else None
            if batch is not None and batch.options.caption is not None:
                batch.captions = _captions(inputs, batch.options.caption)
            runs = _runs(inputs, options if batch is None else {**options, "batch": batch}, suffix, left)
            if batch is not None:
                batch.check_apart([run.get("output") for run in runs])
            if len(runs) == 1 and not (batch and batch.has_sheet):
                command(**runs[0])
            else:
                _run_all(command, runs, batch, titled=suffix is None)

        parameters: list[inspect.Parameter] = []
        for parameter in signature.parameters.values():
            if parameter.name == "input":
                kind = Inputs if parameter.default is parameter.empty else InputsOrNone
                parameters.append(parameter.replace(annotation=kind))
            else:
                parameters += together if parameter.name == "batch" else [parameter]
        return with_signature(with_several, parameters)

    return changed


def _found(given: list[str]) -> list[str]:
    """The inputs with patterns expanded, each once."""
    found: dict[str, None] = {}
    for text in given:
        found.update(dict.fromkeys(matching_files(text) or [text]))
    return list(found)


def _runs(
    inputs: list[str], options: dict[str, Any], suffix: str | None, left: tuple[str, ...]
) -> list[dict[str, Any]]:
    """Arguments of the command for each input. `left`: words in braces that stay."""
    runs = []
    makers: dict[Path, str] = {}
    named = " ".join(str(options.get(option)) for option in ("output", "report"))
    for input, found in zip(inputs, _all_places(inputs, named), strict=True):
        places = found | {word: f"{{{word}}}" for word in left}
        own = {
            option: Path(_filled(option, str(options[option]), places))
            for option in ("output", "report")
            if options.get(option)
        }
        # A folder of Zarr that is there is a result, not a place for results.
        is_place = suffix is not None and "output" in own and not own["output"].name.lower().endswith(".zarr")
        if is_place and is_folder(own["output"]):
            own["output"] /= f"{places['stem']}{suffix}"
        for option, path in own.items():
            if len(inputs) > 1 and path == options[option]:
                raise ArgumentError(
                    f"{len(inputs)} volumes, and --{option} names one file; write {{stem}} in its name, such as "
                    f"{path.with_name('{stem}' + path.suffix)}, or name a folder that is there"
                )
            maker = makers.setdefault(path, input)
            if maker != input:
                words = _words_that_differ(maker, input)
                raise ArgumentError(
                    f"{safe_address(maker)} and {safe_address(input)} would be one file, {path}; "
                    f"write {' or '.join(words)} in its name"
                )
        runs.append({**options, **own, "input": input})
    return runs


def _captions(inputs: list[str], caption: str) -> dict[str, str]:
    """The captions of the pictures, by input."""
    places = _all_places(inputs, caption)
    return {input: _filled("caption", caption, own) for input, own in zip(inputs, places, strict=True)}


def _all_places(inputs: list[str], text: str) -> list[dict[str, str]]:
    """Values of the words in braces for each input; words for plates only if the text has one of them."""
    asks_wells = any(f"{{{word}}}" in text for word in OF_PLATES)
    found = []
    for number, (input, path) in enumerate(zip(inputs, _paths(inputs), strict=True), 1):
        places = {**_places(input, f"{number:0{len(str(len(inputs)))}}"), "path": path}
        found.append(places | (_places_in_plate(input) if asks_wells else {}))
    return found


def _places(input: str, number: str) -> dict[str, str]:
    """Values of the words in braces, by word."""
    path = Path(input) if is_address(input) else Path(os.path.expanduser(input))  # noqa: PTH111
    folder = path.parent.name
    if not folder:
        with suppress(OSError):  # of a working folder that is gone
            folder = path.absolute().parent.name
    return {"stem": stem_of(input), "name": path.name, "folder": folder, "number": number}


def _paths(inputs: list[str]) -> list[str]:
    """Paths of the inputs below the folder that all share, with _ between their parts."""
    parts = [Path(safe_address(one) if is_address(one) else os.path.abspath(one)).parts for one in inputs]  # noqa: PTH100
    n = 0
    while n < min(map(len, parts)) - 1 and len({part[n] for part in parts}) == 1:
        n += 1
    return ["_".join(part[n:]) for part in parts]


def _places_in_plate(input: str) -> dict[str, str]:
    """Values of {well} and {field}."""
    from wavesplat._readers.zarr.layout import well_of

    found = None if is_address(input) else well_of(Path(input))
    if found is None:
        raise ArgumentError(
            "{well} and {field} name the images of a plate of OME-Zarr, such as plate.zarr/A/1/0, and this is none; "
            f"write {{path}} or {{stem}}: {safe_address(input)}"
        )
    return dict(zip(OF_PLATES, found, strict=True))


def _words_that_differ(one: str, other: str) -> list[str]:
    """Words in braces by which two inputs have different names."""
    from wavesplat._readers.zarr.layout import well_of

    first, second = (None if is_address(input) else well_of(Path(input)) for input in (one, other))
    if first is not None and second is not None:
        return ["{well}" if first[0] != second[0] else "{field}", "{path}"]
    has_own_folder = _places(one, "")["folder"] != _places(other, "")["folder"]
    return ["{folder}" if has_own_folder else "{path}", "{number}"]


def _filled(option: str, text: str, places: dict[str, str]) -> str:
    """The text with words in braces replaced by their values; an `ArgumentError` for an unknown word."""
    known = {**dict.fromkeys(OF_PLATES, ""), **places}
    # Braces in the names of folders are no placeholders.
    unknown = next((word for word in WORD.findall(Path(text).name) if word not in known), None)
    if unknown is not None:
        near = get_close_matches(unknown, known, 1)
        meant = f", is it {{{near[0]}}}?" if near else ""
        listed = ", ".join(f"{{{word}}}" for word in known)
        raise ArgumentError(f"unknown {{{unknown}}} in --{option}{meant}; words in braces are {listed}: {text}")
    return WORD.sub(lambda place: places.get(place[1], place[0]), text)


def _run_all(command: Callable[..., None], runs: list[dict[str, Any]], batch: Batch | None, *, titled: bool) -> None:
    """Run the command for each input in turn; report one that fails, and go on with the others."""
    n_failed = 0
    with collected(as_json=bool(runs[0].get("json"))):
        for number, run in enumerate(runs):
            if titled and not run.get("json"):
                print_lines(f"\n{run['input']}" if number > 0 else run["input"])
            try:
                command(**run)
            except WavesplatError as error:
                # Options that are wrong are wrong for all inputs, so the first one ends the run.
                if isinstance(error, ArgumentError) and number == 0:
                    raise
                n_failed += 1
                place = "" if safe_address(run["input"]) in str(error) else f": {safe_address(run['input'])}"
                message(f"error: {' '.join(str(error).split())}{place}")
        if batch is not None:
            batch.finish(as_json=bool(runs[0].get("json")))
    if n_failed:
        message(f"{n_failed} of {len(runs)} inputs failed")
        raise typer.Exit(1)
