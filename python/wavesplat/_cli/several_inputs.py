"""Commands of one INPUT run on several: quoted patterns are expanded, and each result gets a name of its own.

In the name of an output, {stem} is the input's without suffix, {name} with it, {folder} the folder that it is in,
{path} what is after the folder that all inputs share, with _ between its parts, and {number} counts from 1. Of images
of a plate of OME-Zarr {well} is the well, such as A1, and {field} the image in it. Other braces are left as they are.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.printing import collected, message, print_lines, print_result
from wavesplat._files.addresses import is_address, safe_address
from wavesplat._files.patterns import matching_files
from wavesplat.errors import ArgumentError, WavesplatError

__all__ = ["takes_several_inputs"]

_INPUTS = typer.Argument(
    metavar="INPUT...",
    help="Volumes: files, folders or URLs; with * and ? in quotes, all files that fit.",
    show_default=False,
)
Inputs = Annotated[list[str], _INPUTS]
InputsOrNone = Annotated[list[str] | None, _INPUTS]

#: Suffixes that belong to the one after them, as in .nii.gz.
DOUBLE = re.compile(r"(\.ome)?\.zarr$|\.(nii|img|hdr|ome|seg)$", re.IGNORECASE)
PLACE = re.compile(r"\{(stem|name|folder|path|well|field|number)\}")
#: Words in braces that only images of plates have.
OF_PLATES = ("well", "field")


Sheet = Annotated[
    Path | None,
    typer.Option(
        metavar="OUT",
        help="Of several volumes: all pictures on one sheet, with their names; of a plate's wells by row and column.",
    ),
]


def takes_several_inputs(
    suffix: str | None = None, *, own: tuple[str, ...] = (), has_sheet: bool = False
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command of one `input` several of them, one after the other.

    suffix : of results, where `output` is a folder; None for a command without an output.
    own : an option, and words in braces that the command fills itself where that option is given.
    has_sheet : whether the command has an option for the pictures of all inputs on one sheet.
    """

    def changed(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command, eval_str=True)

        @wraps(command)
        def with_several(*, input: list[str] | None = None, **options: Any) -> None:
            sheet = options.pop("sheet", None)
            if not input:
                _check_sheet(sheet, [])
                command(input=None, **options)
                return
            left = own[1:] if own and options.get(own[0]) else ()
            runs = _runs(_found(input), options, suffix, left)
            _check_sheet(sheet, runs)
            if len(runs) == 1:
                command(**runs[0])
            else:
                _run_all(command, runs, titled=suffix is None, sheet=sheet)

        parameters = [
            parameter.replace(annotation=Inputs if parameter.default is parameter.empty else InputsOrNone)
            if parameter.name == "input"
            else parameter
            for parameter in signature.parameters.values()
        ]
        if has_sheet:
            parameters.append(
                inspect.Parameter("sheet", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Sheet)
            )
        # Typer reads one or the other, depending on its release.
        with_several.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        with_several.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return with_several

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
    paths = _paths(inputs)
    named = " ".join(str(options.get(option)) for option in ("output", "report"))
    asks_wells = any(f"{{{word}}}" in named for word in OF_PLATES)
    for number, input in enumerate(inputs, 1):
        places = {**_places(input, f"{number:0{len(str(len(inputs)))}}"), "path": paths[number - 1]}
        if asks_wells:
            places |= _places_in_plate(input)
        places |= {word: f"{{{word}}}" for word in left}
        own = {option: _named(options[option], places) for option in ("output", "report") if options.get(option)}
        if suffix is not None and "output" in own and _is_folder(own["output"]):
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


def _places(input: str, number: str) -> dict[str, str]:
    """Values of the words in braces, by word."""
    path = Path(input) if is_address(input) else Path(os.path.expanduser(input))  # noqa: PTH111
    folder = path.parent.name
    if not folder:
        with suppress(OSError):  # of a working folder that is gone
            folder = path.absolute().parent.name
    stem = path.name if _is_folder(path) and path.suffix.lower() != ".zarr" else path.stem
    return {"stem": DOUBLE.sub("", stem), "name": path.name, "folder": folder, "number": number}


def _paths(inputs: list[str]) -> list[str]:
    """Paths of the inputs below the folder that all share, with _ between their parts."""
    parts = [Path(safe_address(one) if is_address(one) else os.path.abspath(one)).parts for one in inputs]  # noqa: PTH100
    n = 0
    while n < min(map(len, parts)) - 1 and len({part[n] for part in parts}) == 1:
        n += 1
    return ["_".join(part[n:]) for part in parts]


def _places_in_plate(input: str) -> dict[str, str]:
    """Values of {well} and {field}."""
    from wavesplat._readers.ome_zarr_layout import well_of

    found = None if is_address(input) else well_of(Path(input))
    if found is None:
        raise ArgumentError(
            "{well} and {field} name the images of a plate of OME-Zarr, such as plate.zarr/A/1/0, and this is none; "
            f"write {{path}} or {{stem}}: {safe_address(input)}"
        )
    return dict(zip(OF_PLATES, found, strict=True))


def _words_that_differ(one: str, other: str) -> list[str]:
    """Words in braces by which two inputs have different names."""
    from wavesplat._readers.ome_zarr_layout import well_of

    first, second = (None if is_address(input) else well_of(Path(input)) for input in (one, other))
    if first is not None and second is not None:
        return ["{well}" if first[0] != second[0] else "{field}", "{path}"]
    has_own_folder = _places(one, "")["folder"] != _places(other, "")["folder"]
    return ["{folder}" if has_own_folder else "{path}", "{number}"]


def _is_folder(path: Path) -> bool:
    """Whether a path is a folder; False for impossible names, which fail where they are opened or written."""
    return os.path.isdir(path)  # noqa: PTH112


def _named(path: Path, places: dict[str, str]) -> Path:
    return Path(PLACE.sub(lambda place: places[place[1]], str(path)))


def _check_sheet(sheet: Path | None, runs: list[dict[str, Any]]) -> None:
    """Raise an `ArgumentError` if there is to be a sheet, and it could not be written, or would be of one picture."""
    if sheet is None:
        return
    from wavesplat._files.output import check_output

    if len(runs) < 2:
        raise ArgumentError("--sheet puts the pictures of several volumes side by side; name several, or a pattern")
    check_output(sheet, "pictures")
    if sheet.absolute() in [run["output"].absolute() for run in runs]:
        raise ArgumentError(f"--sheet and --output are the same file, which would be lost; change a name: {sheet}")


def _write_sheet(sheet: Path, runs: list[dict[str, Any]]) -> None:
    """Write the pictures of the inputs on one sheet."""
    from wavesplat._cli.contact_sheet import Drawn, of_files
    from wavesplat._readers.ome_zarr_layout import well_of

    wells = [None if is_address(run["input"]) else well_of(Path(run["input"])) for run in runs]
    has_fields = len({well[1] for well in wells if well is not None}) > 1
    paths = _paths([run["input"] for run in runs])
    files = []
    for run, well, path in zip(runs, wells, paths, strict=True):
        if run["output"].is_file():
            name = path if well is None else " ".join(well) if has_fields else well[0]
            place = None if well is None else Path(run["input"]).absolute().parts[-3:-1]
            files.append(Drawn(run["output"], name, None if place is None else (place[0], place[1])))
    if not files:
        raise ArgumentError("--sheet takes one picture of each volume, and there are none of these names")
    of_files(files).save(sheet)
    print_result({"sheet": str(sheet), "pictures": len(files)}, sheet, as_json=bool(runs[0].get("json")))


def _run_all(
    command: Callable[..., None], runs: list[dict[str, Any]], *, titled: bool, sheet: Path | None = None
) -> None:
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
        if sheet is not None and n_failed < len(runs):
            _write_sheet(sheet, runs)
    if n_failed:
        message(f"{n_failed} of {len(runs)} inputs failed")
        raise typer.Exit(1)
