"""`wavesplat mesh`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.crop_options import box, chosen_crop
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_result
from wavesplat._cli.processing_options import ProcessingOptions, processed, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Json, Quiet

__all__ = ["mesh"]


@takes_several_inputs(".ply")
@takes_reader_options
@takes_processing_options
def mesh(
    input: Input,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="OUT", help="Mesh to write: .ply, .stl, .obj, .glb, .gltf.", show_default=False
        ),
    ],
    iso_value: Annotated[float, typer.Option(metavar="VALUE", help="The surface's value.", show_default=False)],
    *,
    closed: Annotated[bool, typer.Option("--closed/--open", help="Close what the volume's faces or a box cut.")] = True,
    step: Annotated[int, typer.Option(metavar="N", help="Take every n-th sample: fewer triangles.")] = 1,
    crop: Annotated[Any, box("Only this box, world units.")] = None,
    crop_index: Annotated[Any, box("The same, in samples.")] = None,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the surface of one value as a triangle mesh, in world units, and print its path."""
    crop_box = chosen_crop(crop, crop_index)
    check_outputs(input, output, "meshes")
    from wavesplat._mesh import meshing

    volume = processed(input, reader, processing, quiet=quiet)
    surface = meshing.mesh(volume, iso_value, closed=closed, step=step, crop=crop_box)
    surface.save(output)
    print_result(
        {"mesh": str(output), "input": input, "processing": list(volume.facts.processing), **surface.facts()},
        output,
        as_json=json,
        written=output,
    )
