"""`wavesplat mesh`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from wavesplat._cli.options.crop import CropOptions, chosen_crop
from wavesplat._cli.options.groups import Input, Json, Quiet, given, option, output
from wavesplat._cli.options.reader import ProcessingOptions, ReaderOptions, processed
from wavesplat._cli.options.slices import chosen_segments
from wavesplat._cli.printing import check_outputs, print_result, warnings_as_notes
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat.errors import ArgumentError

#: Strength of smoothing of meshes of labels, as in 3D Slicer.
SMOOTHING = 0.5
EITHER = "give either --iso-value, for the surface of a value, or --labels all, for a segmentation"


@dataclass(repr=False)
class MeshOptions:
    """Which surface, and how finely and smoothly it is meshed."""

    iso_value: float | None = option("VALUE", "The surface's value.")
    labels: str | None = option(
        "all|LABEL,...",
        "Instead: a closed, smooth mesh of each of these labels of a segmentation, by number or name.",
    )
    label_table: Path | None = option(
        "FILE",
        "Names and colours of the labels, from ITK-SNAP, FreeSurfer, 3D Slicer (.ctbl), Connectome Workbench or BIDS "
        "(.tsv).",
    )
    smoothing: float = option("0..1", "How much meshes of labels are smoothed; 0 leaves the stairs.", default=SMOOTHING)
    closed: bool = option(None, "Close what the volume's faces or a box cut.", "--closed/--open", default=True)
    step: int = option("N", "Take every n-th sample: fewer triangles.", default=1)


@takes_several_inputs(".ply", own=("labels", "name", "number"))
def mesh(
    input: Input,
    output: Annotated[
        Path,
        output("Mesh to write: .ply, .stl, .obj, .glb, .gltf, .3mf; {name} or {number} for a file of each label."),
    ],
    *,
    own: MeshOptions,
    cuts: CropOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the surface of a value, or surfaces of labels, as triangle meshes in world units, and print their paths."""
    if own.labels is not None and own.iso_value is not None:
        raise ArgumentError(EITHER)
    if own.labels is not None:
        of_surface = {"--open": not own.closed, "--step": own.step != 1}
        named = [name for name, is_given in of_surface.items() if is_given] + given(cuts, reader, processing)
        if named:
            raise ArgumentError(f"--labels takes the segmentation as it is; leave out {', '.join(named)}")
        _write_labels(input, output, own.labels, own.label_table, own.smoothing, as_json=json, quiet=quiet)
        return
    if own.iso_value is None:
        raise ArgumentError(EITHER)
    if own.label_table is not None or own.smoothing != SMOOTHING:
        raise ArgumentError("--label-table and --smoothing are for meshes of labels; leave them out, or give --labels")
    check_outputs(input, output, "meshes")
    crop = chosen_crop(cuts)
    from wavesplat._mesh import meshing

    volume = processed(input, reader, processing, quiet=quiet)
    surface = meshing.mesh(volume, own.iso_value, closed=own.closed, step=own.step, crop=crop)
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
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._mesh import meshing
    from wavesplat._readers.dicom.structures import is_structure_set
    from wavesplat._storage.paths import expanded

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
