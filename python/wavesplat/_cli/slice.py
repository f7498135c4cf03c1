"""`wavesplat slice`."""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.comparison_options import Checkerboard, Difference, Tiles, opened_comparison
from wavesplat._cli.figure_options import FigureOptions, annotated, check_figure, takes_figure_options
from wavesplat._cli.label_options import LabelsFile, LabelTable, Segments, opened_labels
from wavesplat._cli.layer_options import FurtherLayers, ShownChannels, further_layers
from wavesplat._cli.line_options import ContoursFile, IsolinesTexts, opened_contours, opened_isolines
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_notes, print_result, warnings_as_notes
from wavesplat._cli.processing_options import ProcessingOptions, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options_but_channel
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Background, Bits, Json, Kernel, PictureOutput, Quiet, Threads, Zoom
from wavesplat._cli.slice_input import FirstLayers, first_layers
from wavesplat._cli.transfer_function_options import (
    ColorOptions,
    LookOptions,
    TransferFunctionFile,
    takes_color_options,
)
from wavesplat._cli.uptake import check_uptake
from wavesplat._model.options import Slab
from wavesplat._model.views import PLANES
from wavesplat.errors import ArgumentError

__all__ = ["slice"]

#: Sheets of the three planes.
OF_THREE = ("all", "ortho")
#: Least number of pixels along the longer side of a patient's slice that is not given a size.
MIN_SIDE_PX = 512
#: Minimum pixels along the longer side of a picture of a single plane with several levels, if no size is given.
PLANE_PX = 2048
#: A plane counts as "xy", "xz" or "yz" if the cosine of its normal and the axis differs from 1 by at most this.
ON_AXIS = 1e-9


@takes_several_inputs(".png")
@takes_figure_options
@takes_reader_options_but_channel
@takes_color_options
@takes_processing_options
def slice(
    input: Input,
    output: PictureOutput,
    *,
    plane: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of((*PLANES, *OF_THREE)),
            help=f"{', '.join(PLANES)}; all three on one sheet: all in a row, ortho aligned; else axial or xy.",
        ),
    ] = None,
    position: Annotated[
        float | None,
        typer.Option(metavar="MM", help="Where the plane crosses its axis, or how far from the point; world units."),
    ] = None,
    positions: Annotated[
        Any,
        typer.Option(
            metavar="START:STOP:STEP|N",
            parser=parsers.positions,
            help="Several slices on one sheet: positions such as 10:80:10 or 10,20,35, or how many.",
        ),
    ] = None,
    columns: Annotated[int | None, typer.Option(metavar="N", help="Slices in a row of the sheet.")] = None,
    reference_lines: Annotated[
        bool | None,
        typer.Option(
            "--reference-lines/--no-reference-lines",
            help="On a sheet: lines where the other planes lie, if not given on three planes; of --positions on a "
            "scout, a slice at right angles.",
            show_default=False,
        ),
    ] = None,
    point: Annotated[
        Any,
        typer.Option(
            metavar="X,Y,Z", parser=parsers.numbers(3, "0,0,50"), help="Any plane: a point on it, world units."
        ),
    ] = None,
    normal: Annotated[
        Any,
        typer.Option(metavar="X,Y,Z", parser=parsers.numbers(3, "0,0.3,1"), help="Any plane: at right angles to this."),
    ] = None,
    size: Annotated[
        Any,
        typer.Option(
            metavar="WxH",
            parser=parsers.size,
            help="Pixels; if not given, one per sample of the finest spacing, and 512 or more of a patient's slice.",
        ),
    ] = None,
    zoom: Zoom = 1.0,
    center: Annotated[
        Any,
        typer.Option(
            metavar="X,Y,Z", parser=parsers.numbers(3, "0,0,50"), help="World position in the picture's middle."
        ),
    ] = None,
    kernel: Kernel = "linear",
    thickness: Annotated[float, typer.Option(metavar="MM", help="Of a slab around the plane, world units.")] = 0.0,
    slab: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(get_args(Slab)),
            help=f"What is kept across it: {', '.join(get_args(Slab))}.",
        ),
    ] = "maximum",
    preset: Annotated[str | None, typer.Option(metavar="NAME", help="Colours: a transfer function by name.")] = None,
    tf: TransferFunctionFile = None,
    channel: ShownChannels = None,
    layer: FurtherLayers = None,
    labels: LabelsFile = None,
    label_table: LabelTable = None,
    segment: Segments = None,
    checkerboard: Checkerboard = None,
    tiles: Tiles = None,
    difference: Difference = None,
    contours: ContoursFile = None,
    isolines: IsolinesTexts = None,
    colors: ColorOptions,
    figure: FigureOptions,
    background: Background = "black",
    bits: Bits = 8,
    threads: Threads = None,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a slice through a volume, thin or thick, or several on one sheet, and print the picture's path."""
    parsers.refuse_pairs(preset=preset, tf=tf)
    parsers.refuse_pairs(plane=plane, normal=normal)
    parsers.refuse_pairs(position=position, positions=positions)
    is_sheet = positions is not None or plane in OF_THREE
    if plane in OF_THREE:
        parsers.refuse_pairs(plane=plane, position=position)
        parsers.refuse_pairs(plane=plane, positions=positions)
    for option, value in (("--columns", columns), ("--reference-lines", reference_lines)):
        if value is not None and not is_sheet:
            raise ArgumentError(f"{option} is for several slices on one sheet; give --positions, or --plane all")
    if (point is None) != (normal is None):
        raise ArgumentError("--point and --normal belong together; give both, or a --plane")
    check_outputs(input, output, "pictures")
    from wavesplat._picture.picture import check_bits
    from wavesplat._scene.lightbox import lightbox
    from wavesplat._scene.scene import Scene
    from wavesplat._scene.slicing import slice as cut

    check_bits(bits)
    check_figure(figure)
    look = LookOptions(preset=preset, tf=tf)
    first = first_layers(
        input,
        reader,
        channel,
        look=look,
        colors=colors,
        processing=processing,
        is_alone=not (layer or isolines or checkerboard or difference),
        n_pixels=zoom * (max(size) if size else PLANE_PX),
        quiet=quiet,
    )
    if difference is not None:
        _check_colors(first, tf)
    of_plane: Any = plane or _only_plane(first.volume) if normal is None else (point, normal)
    if size is None and not is_sheet:
        size = _size(first.volume, of_plane)
    options: Any = {
        "size": size,
        "zoom": zoom,
        "center": center,
        "kernel": kernel,
        "thickness": thickness,
        "slab": slab,
        "window": colors.window if first.is_grey else None,
        "clim": colors.clim if first.is_grey else None,
        "transfer_function": first.transfer_function,
        "background": background,
        "threads": threads,
    }
    with warnings_as_notes(quiet=quiet):
        further = further_layers(layer, first.volume, time=reader.time or 0, quiet=quiet, suv=reader.suv)
        # Segments, and the table, may be of the contours alone.
        of_labels = (None, None) if contours and not labels else (label_table, segment)
        shown_labels = opened_labels(labels, *of_labels, first.volume, quiet=quiet)
        scene = Scene([*first.layers, *further], labels=shown_labels)
        lines = opened_isolines(isolines, first.volume, time=reader.time or 0, quiet=quiet, suv=reader.suv)
        compared = opened_comparison(
            checkerboard, tiles, difference, first.volume, time=reader.time or 0, quiet=quiet, suv=reader.suv
        )
        check_uptake(scene, suv=reader.suv, others=[*(one.volume for one in lines or ()), *compared.volumes])
        regions = opened_contours(contours, None if labels else label_table, segment, first.volume, quiet=quiet)
        options |= {"contours": regions, "isolines": lines, **compared.arguments}
        if is_sheet:
            bar: Any = figure.scale_bar if figure.bar_length is None else figure.bar_length
            options |= {"columns": columns, "reference_lines": reference_lines, "scale_bar": bar}
            picture = lightbox(scene, of_plane, positions, **options)
            # Each slice has its letters, and one of them the bar.
            figure = replace(figure, figure=False, letters=False, scale_bar=False, bar_length=None)
        else:
            picture = cut(scene, of_plane, position, **options)
    if not quiet:
        print_notes(picture)
    picture = annotated(picture, figure, scene, quiet=quiet)
    picture.save(output, bits=bits, dpi=figure.dpi)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    print_result(facts, output, as_json=json, written=output)


def _only_plane(volume: Any) -> Any:
    """The plane of a file with a single plane: a name, or point and normal if it is oblique; None for volumes."""
    import numpy as np

    from wavesplat._readers.single_planes import is_single_plane

    if not is_single_plane(volume):
        return None
    across = 2 - volume.shape.index(min(volume.shape))
    along = [volume.world_from_index[:3, number] for number in range(3) if number != across]
    normal = np.cross(*along) / np.linalg.norm(np.cross(*along))
    axis = int(np.abs(normal).argmax())
    if abs(normal[axis]) < 1 - ON_AXIS:
        return volume.bounds.mean(axis=0).tolist(), normal.tolist()
    names = ("sagittal", "coronal", "axial") if volume.is_anatomical else ("yz", "xz", "xy")
    return names[axis]


def _check_colors(first: FirstLayers, tf: object) -> None:
    """Refuse colours of the volume's values for a difference."""
    if not (first.is_grey or tf):
        raise ArgumentError("--difference has its own colours; give their ends as --clim LOW,HIGH, or others as --tf")


def _size(volume: Any, plane: Any) -> tuple[int, int]:
    """Pixels of a slice that is not given a size: a whole number from sample to sample.

    A patient's slices have `MIN_SIDE_PX` or more, to be read; other data a pixel per sample, to be worked on.
    """
    from wavesplat._render.slicing import sides_of

    steps = [max(1, round(side / min(volume.spacing))) for side in sides_of(volume, plane)]
    times = ceil((MIN_SIDE_PX - 1) / max(steps)) if volume.is_anatomical else 1
    return times * steps[0] + 1, times * steps[1] + 1
