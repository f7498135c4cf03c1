"""Pictures of several inputs as a whole: one look for all of them, a sheet of all, and a note where windows differ."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._cli.options.groups import option
from wavesplat._cli.printing import check_outputs, message, print_result
from wavesplat._storage.addresses import is_address, safe_address
from wavesplat.errors import ArgumentError, WavesplatError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wavesplat._cli.options.scene import ChosenScene
    from wavesplat._looks.look import Look
    from wavesplat._picture.picture import Picture
    from wavesplat._scene.layer import Layer

#: Opens an input, with the looks that its layers shall have, or its own looks; the last argument: say nothing.
Choose = Callable[[str, "Sequence[Look] | None", bool], "ChosenScene"]
FIRST, BRIGHTEST = "first", "brightest"
#: Bytes of a pixel while a sheet is made: the picture itself, and its place on the sheet.
BYTES_OF_PIXEL = 32
#: Suffixes that belong to the one after them, as in .nii.gz.
DOUBLE = re.compile(r"(\.ome)?\.zarr$|\.(nii|img|hdr|ome|seg)$", re.IGNORECASE)


@dataclass(repr=False)
class BatchOptions:
    """Options of several pictures that are to be compared."""

    TITLE: ClassVar = "Several inputs"

    same_look: str | None = option(
        "first|brightest|FILE",
        "Draw all inputs with one look, colours and windows included: the look of the first or the brightest of them, "
        "or of another volume.",
    )
    sheet: Path | None = option(
        "OUT", "Also put all pictures on one sheet, each with the name of its input, or the number of a patient's."
    )
    caption: str | None = option(
        "TEXT", "What stands below each picture of the sheet; {stem}, {number}, ... as in --output."
    )


def batch_of(inputs: Sequence[str], options: dict[str, Any]) -> Batch:
    """The batch of some inputs; takes its options out of the options of the command."""
    own = BatchOptions(**{one.name: options.pop(one.name) for one in fields(BatchOptions)})
    if own.sheet is not None:
        for input in inputs:
            check_outputs(input, own.sheet, "pictures", option="--sheet")
    elif own.caption is not None:
        raise ArgumentError("--caption stands below the pictures of a sheet; give it with --sheet")
    return Batch(list(inputs), own, is_quiet=bool(options.get("quiet")))


@dataclass
class Batch:
    """Inputs of a command, and what is known of their pictures so far."""

    inputs: list[str]
    options: BatchOptions = field(default_factory=BatchOptions)
    is_quiet: bool = False
    #: Captions that the user gave, by input.
    captions: Mapping[str, str] = field(default_factory=dict)
    _looks: tuple[Look, ...] | None = None
    #: Lowest and highest values that the layers of each input show, by input.
    _windows: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    _panels: list[tuple[str, NDArray[np.float32]]] = field(default_factory=list)
    #: Row and column on a plate of each panel that is of a well.
    _wells: list[tuple[str, str]] = field(default_factory=list)

    @property
    def has_sheet(self) -> bool:
        """Whether a sheet is asked for."""
        return self.options.sheet is not None

    def check_apart(self, outputs: Sequence[Any]) -> None:
        """Raise an `ArgumentError` where the sheet would replace a picture."""
        if self.has_sheet and self.options.sheet in outputs:
            raise ArgumentError(f"--output and --sheet are the same file; change a name: {self.options.sheet}")

    def chosen(self, input: str, choose: Choose, settled: Callable[[ChosenScene], ChosenScene]) -> ChosenScene:
        """The scene of an input, in the look that all inputs share, if they do.

        settled : writes out looks that are left to the renderer.
        """
        wanted = self.options.same_look
        if wanted is None:
            return choose(input, None, self.is_quiet)
        if self._looks is None:
            if wanted == FIRST:
                own = settled(choose(input, None, self.is_quiet))
                self._looks = own.looks
                return own
            self._looks = self._found(wanted, lambda path: settled(choose(path, None, True)))
        return choose(input, self._looks, self.is_quiet)

    def _found(self, wanted: str, choose: Callable[[str], ChosenScene]) -> tuple[Look, ...]:
        if wanted != BRIGHTEST:
            try:
                return choose(wanted).looks
            except WavesplatError as error:
                raise ArgumentError(f"--same-look is {FIRST}, {BRIGHTEST} or a volume: {error}") from error
        from wavesplat._looks.over_time import bright_end

        found: list[tuple[float, Look]] = []
        for path in self.inputs:
            try:
                chosen = choose(path)
            except WavesplatError:
                continue  # the fault is reported when it is drawn
            ends = [bright_end(layer.looked_at) for layer in chosen.scene.layers]
            ours = list(zip(ends, chosen.looks, strict=False))
            if not found:
                found = ours
            found = [max(pair, key=lambda one: one[0]) for pair in zip(found, ours, strict=False)]
        return tuple(look for _, look in found)

    def add(self, input: str, label: str | None, picture: Picture, first: Layer) -> None:
        """Record the windows of a picture and put it on the sheet. `label`: its time and channel, if it has several."""
        self._windows.setdefault(input, _windows_of(picture))
        if self.has_sheet:
            from wavesplat._render.arguments import check_picture_memory

            if not self._panels:
                width, height = picture.size
                check_picture_memory((width, height * max(len(self.inputs), 1)), BYTES_OF_PIXEL)
            name, well = self._name_of(input, first)
            if well is not None:
                self._wells.append(well)
            alone = [label] if len(self.inputs) == 1 and label and not self.captions else [name, label]
            self._panels.append((", ".join(text for text in alone if text), picture.rgba))

    def finish(self, *, as_json: bool) -> None:
        """Write the sheet, and say where windows differ."""
        if self.options.sheet is not None and self._panels:
            from wavesplat._cli.contact_sheet import sheet_of

            sheet = sheet_of(self._panels, self._wells if len(self._wells) == len(self._panels) else None)
            sheet.save(self.options.sheet)
            facts = {"sheet": str(self.options.sheet), "size": list(sheet.size), "names": [n for n, _ in self._panels]}
            print_result(facts, self.options.sheet, as_json=as_json, written=self.options.sheet)
        if self.options.same_look is None and not self.is_quiet:
            self._note_windows()

    def _name_of(self, input: str, first: Layer) -> tuple[str, tuple[str, str] | None]:
        """The name of an input on the sheet, and row and column of the well that it is of, on a plate.

        Scans of patients have the names of their first layers, and numbers, since their files may have the patients'.
        """
        from wavesplat._looks.layer_names import is_of_patient
        from wavesplat._readers.zarr.layout import well_of

        if self.captions:
            return self.captions[input], None
        found = [None if is_address(one) else well_of(Path(one)) for one in self.inputs]
        own = found[self.inputs.index(input)]
        if own is None and is_of_patient(first.drawn):
            number = f" {self.inputs.index(input) + 1}" if len(self.inputs) > 1 else ""
            return f"{first.name}{number}", None
        if own is None:
            return _distinct_names(self.inputs)[self.inputs.index(input)], None
        has_fields = len({one[1] for one in found if one is not None}) > 1
        row, column = Path(input).absolute().parts[-3:-1]
        return " ".join(own) if has_fields else own[0], (row, column)

    def _note_windows(self) -> None:
        (first, shown), *others = self._windows.items() or [("", [])]
        other = next((one for one in others if one[1] != shown), None)
        if other is not None:
            message(
                f"note: the inputs are shown over values of their own ({_text(first, shown)}; {_text(*other)}), so "
                f"that brightness cannot be compared; --same-look {FIRST}, or {BRIGHTEST}, shows all alike"
            )


def _windows_of(picture: Picture) -> list[tuple[float, float]]:
    """Values of the first and the last colour of each layer that is shown."""
    functions = [layer.get("transfer_function") for layer in picture.report.get("shown") or []]
    return [(one["color"][0][0], one["color"][-1][0]) for one in functions if one is not None]


def _text(input: str, windows: Sequence[tuple[float, float]]) -> str:
    listed = ", ".join(f"{low:.4g} to {high:.4g}" for low, high in windows)
    return f"{Path(safe_address(input)).name}: {listed or 'none'}"


def _distinct_names(inputs: Sequence[str]) -> list[str]:
    """Names of inputs without their suffixes, with as few folders before them as make them different."""
    paths = [Path(safe_address(input)) for input in inputs]
    stems = [stem_of(input) for input in inputs]
    for n_folders in range(max(len(path.parts) for path in paths)):
        names = [
            "/".join([*path.parent.parts[max(len(path.parent.parts) - n_folders, 0) :], stem])
            for path, stem in zip(paths, stems, strict=True)
        ]
        if len(set(names)) == len(set(inputs)):
            return names
    return [path.name for path in paths]


def stem_of(input: str) -> str:
    """Name of an input without its suffixes."""
    path = Path(input) if is_address(input) else Path(os.path.expanduser(input))  # noqa: PTH111
    stem = path.name if is_folder(path) and path.suffix.lower() != ".zarr" else path.stem
    return DOUBLE.sub("", stem)


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; False for impossible names, which fail where they are opened or written."""
    return os.path.isdir(path)  # noqa: PTH112
