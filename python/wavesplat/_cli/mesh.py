"""`wavesplat mesh`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.crop_options import box, chosen_crop
from wavesplat._cli.label_options import LabelTable, chosen_segments
from wavesplat._cli.option_groups import given
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_result, warnings_as_notes
from wavesplat._cli.processing_options import ProcessingOptions, processed, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Json, Quiet
from wavesplat.errors import ArgumentError

#: Strength of smoothing of meshes of labels, as in 3D Slicer.
SMOOTHING = 0.5
EITHER = "give either --iso-value, for the surface of a value, or --labels all, for a segmentation"


@takes_several_inputs(".ply", own=("labels", "name", "number"))
@takes_reader_options
@takes_processing_options
def mesh(
    input: Input,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="Mesh to write: .ply, .stl, .obj, .glb, .gltf, .3mf; {name} or {number} for a file of each label.",
            show_default=False,
        ),
    ],
    iso_value: Annotated[
        float | None, typer.Option(metavar="VALUE", help="The surface's value.", show_default=False)
    ] = None,
    *,
    labels: Annotated[
        str | None,
        typer.Option(
            metavar="all|LABEL,...",
            help="Instead: a closed, smooth mesh of each of these labels of a segmentation, by number or name.",
        ),
    ] = None,
    label_table: LabelTable = None,
    smoothing: Annotated[
        float, typer.Option(metavar="0..1", help="How much meshes of labels are smoothed; 0 leaves the stairs.")
    ] = SMOOTHING,
    closed: Annotated[bool, typer.Option("--closed/--open", help="Close what the volume's faces or a box cut.")] = True,
    step: Annotated[int, typer.Option(metavar="N", help="Take every n-th sample: fewer triangles.")] = 1,
    crop: Annotated[Any, box("Only this box, world units.")] = None,
    crop_index: Annotated[Any, box("The same, in samples.")] = None,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the surface of a value, or those of labels, as triangle meshes in world units, and print their paths."""
    crop_box = chosen_crop(crop, crop_index)
    if labels is not None and iso_value is not None:
        raise ArgumentError(EITHER)
    if labels is not None:
        of_surface = {"--open": not closed, "--step": step != 1, "--crop": crop_box is not None}
        named = [name for name, is_given in of_surface.items() if is_given] + given(reader) + given(processing)
        if named:
            raise ArgumentError(f"--labels takes the segmentation as it is; leave out {', '.join(named)}")
        _write_labels(input, output, labels, label_table, smoothing, as_json=json, quiet=quiet)
        return
    if iso_value is None:
        raise ArgumentError(EITHER)
    if label_table is not None or smoothing != SMOOTHING:
        raise ArgumentError("--label-table and --smoothing are for meshes of labels; leave them out, or give --labels")
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


def _write_labels(
    input: str, output: Path, wanted: str, table: Path | None, smoothing: float, *, as_json: bool, quiet: bool
) -> None:
    from wavesplat._files.paths import expanded
    from wavesplat._looks.labels import Labels
    from wavesplat._mesh import meshing
    from wavesplat._readers.dicom_structures import is_structure_set

    if is_structure_set(expanded(input)):
        raise ArgumentError(
            "a structure set (RTSTRUCT) has no samples; in Python: "
            f"wavesplat.mesh(wavesplat.Labels.open(path, scan=scan), labels='all'): {input}"
        )
    names = None if wanted.strip() == "all" else chosen_segments([one.strip() for one in wanted.split(",")])
    with warnings_as_notes(quiet=quiet):
        # Chosen segments of a file are whole, also where others cover them.
        labels = Labels.open(input, table=table, segments=names)
    meshes = meshing.mesh(labels, labels="all" if names is None else list(labels.labels), smoothing=smoothing)
    for path in meshes.paths(output):
        check_outputs(input, path, "meshes")
    paths = meshes.save(output)
    of_parts = paths if len(paths) == len(meshes) else paths * len(meshes)
    parts = [
        {"label": number, "name": part.name, "mesh": str(path), **part.facts()}
        for number, part, path in zip(meshes.numbers, meshes, of_parts, strict=True)
    ]
    listed = "\n".join(str(path) for path in paths)
    print_result({"meshes": parts, "input": input}, listed, as_json=as_json, written=paths[-1])
