"""`wavesplat tf`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_lines
from wavesplat._cli.processing_options import ProcessingOptions, processed, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Quiet
from wavesplat._cli.transfer_function_options import (
    ColorOptions,
    LookOptions,
    takes_color_options,
    takes_look_options,
)


@takes_several_inputs(".json")
@takes_reader_options
@takes_color_options
@takes_look_options
@takes_processing_options
def tf(
    input: Input,
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="OUT", help="File to write: .json.", show_default=False)
    ] = None,
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
    from wavesplat._files import json_object

    json_object.save(output, text)
    print_lines(output, written=output)
