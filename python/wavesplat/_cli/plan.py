"""`wavesplat plan`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from wavesplat._cli import parsers
from wavesplat._cli.crop_options import box, chosen_crop
from wavesplat._cli.geometry_options import GeometryOptions, opened_geometry, takes_geometry_options
from wavesplat._cli.printing import print_result
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.shared_options import Json

__all__ = ["plan"]


@takes_geometry_options
@takes_reader_options
def plan(
    input: Input,
    *,
    reader: ReaderOptions,
    size: Annotated[Any, typer.Option(metavar="WxH", parser=parsers.size, help="Pixels of the picture.")] = "512x512",
    workers: Annotated[int, typer.Option(metavar="N", help="Machines, or processes, that draw together.")] = 1,
    cores: Annotated[int | None, typer.Option(metavar="N", help="Cores of each; those of this machine.")] = None,
    segments: Annotated[int | None, typer.Option(metavar="N", help="Slices of a segment of the rays.")] = None,
    read_rate: Annotated[
        str | None,
        typer.Option(metavar="SIZE", help="Bytes a second that a worker reads, such as 250MB; else measured."),
    ] = None,
    draw_ns: Annotated[
        float | None, typer.Option(metavar="NS", help="Nanoseconds of a texel on a core; else measured.")
    ] = None,
    crop: Annotated[Any, box("Plan the picture of this box alone, world units.")] = None,
    crop_index: Annotated[Any, box("The same, in samples.")] = None,
    showing: GeometryOptions,
    json: Json = False,
) -> None:
    """Say what a picture of a large file costs before it is drawn: boxes, bytes, tasks, memory, time."""
    from dataclasses import replace

    from wavesplat._cli.reader_options import open_samples
    from wavesplat._model.lazy_volume import default_memory
    from wavesplat._scene.cost import plan as plan_of

    lazy = replace(reader, memory=reader.memory or str(default_memory()))
    volume = open_samples(input, lazy, quiet=True)
    cost = plan_of(
        volume,
        size=size,
        workers=workers,
        cores=cores,
        segments=segments,
        read_rate=read_rate,
        draw_ns=draw_ns,
        geometry=opened_geometry(showing, volume.facts.unit, quiet=True),
        crop=chosen_crop(crop, crop_index),
    )
    print_result(cost.as_json(), "\n".join(cost.lines()), as_json=json)
