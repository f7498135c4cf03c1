"""`wavesplat tf`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from wavesplat._cli.options.groups import Input, Quiet, output
from wavesplat._cli.options.reader import ProcessingOptions, ReaderOptions, processed
from wavesplat._cli.options.transfer_function import ColorOptions, LookOptions
from wavesplat._cli.printing import check_outputs, print_lines
from wavesplat._cli.several_inputs import takes_several_inputs


@takes_several_inputs(".json")
def tf(
    input: Input,
    *,
    output: Annotated[Path | None, output("File to write: .json.")] = None,
    looks: LookOptions,
    colors: ColorOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    quiet: Quiet = False,
) -> None:
    """Print the look that `render` would draw a volume with, as JSON: edit it, and give it back with --tf."""
    looks.check(colors)
    if output is not None:
        check_outputs(input, output, "looks")
    volume = processed(input, reader, processing, quiet=quiet)
    look = looks.look(volume, input, colors, quiet=quiet)
    # Without the name "auto", since the renderer may work out anew a look of that name.
    text = replace(look, name="" if look.name == "auto" else look.name).to_json()
    if output is None:
        print_lines(text.rstrip("\n"))
        return
    from wavesplat._storage import json_texts

    json_texts.save(output, text)
    print_lines(output, written=output)
