"""`wavesplat slice`."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.figure_options import FigureOptions, annotated, check_figure, takes_figure_options
from wavesplat._cli.label_options import LabelsFile, LabelTable, Segments, opened_labels
from wavesplat._cli.layer_options import FurtherLayers, further_layers
from wavesplat._cli.line_options import ContoursFile, IsolinesTexts, opened_contours, opened_isolines
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import print_notes, print_result, warnings_as_notes
from wavesplat._cli.processing_options import ProcessingOptions, processed, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Background, Bits, Json, Kernel, PictureOutput, Quiet, Threads, Zoom
from wavesplat._cli.transfer_function_options import (
    ColorOptions,
    TransferFunctionFile,
    function_of_histogram,
    named_look,
    takes_color_options,
)
from wavesplat._cli.uptake import check_uptake, in_uptake
from wavesplat._model.options import PLANES, Slab
from wavesplat.errors import ArgumentError

__all__ = ["slice"]


@takes_several_inputs(".png")
@takes_figure_options
@takes_reader_options
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
            parser=parsers.one_of((*PLANES, "all")),
            help=f"{', '.join(PLANES)}; all three on one sheet: all; else axial.",
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
        typer.Option(metavar="WxH", parser=parsers.size, help="Pixels; those of the finest spacing if not given."),
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
    layer: FurtherLayers = None,
    labels: LabelsFile = None,
    label_table: LabelTable = None,
    segment: Segments = None,
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
    is_sheet = positions is not None or plane == "all"
    if plane == "all":
        parsers.refuse_pairs(plane=plane, position=position)
        parsers.refuse_pairs(plane=plane, positions=positions)
    if columns is not None and not is_sheet:
        raise ArgumentError("--columns is for several slices on one sheet; give --positions, or --plane all")
    if (point is None) != (normal is None):
        raise ArgumentError("--point and --normal belong together; give both, or a --plane")
    check_outputs(input, output, "pictures")
    from wavesplat._picture.picture import check_bits
    from wavesplat._scene.lightbox import lightbox
    from wavesplat._scene.scene import Scene
    from wavesplat._scene.slicing import slice as cut

    check_bits(bits)
    check_figure(figure)
    volume = in_uptake(
        lambda suv: processed(input, replace(reader, suv=suv), processing, quiet=quiet),
        lambda one: one.modality,
        suv=reader.suv,
        is_alone=not (layer or isolines),
    )
    # A window or a range alone maps to greys.
    is_grey = colors == ColorOptions(clim=colors.clim, window=colors.window)
    look = named_look(volume, preset=preset, tf=tf, colors=None if is_grey else colors, opacity=1.0, quiet=quiet)
    transfer_function: Any = look and look.transfer_function
    if preset == "auto":
        transfer_function = function_of_histogram(volume, input)
    options: Any = {
        "size": size,
        "zoom": zoom,
        "center": center,
        "kernel": kernel,
        "thickness": thickness,
        "slab": slab,
        "window": colors.window if is_grey else None,
        "clim": colors.clim if is_grey else None,
        "transfer_function": transfer_function,
        "background": background,
        "threads": threads,
    }
    with warnings_as_notes(quiet=quiet):
        further = further_layers(layer, time=reader.time or 0, quiet=quiet, suv=reader.suv)
        # Segments may be of the contours alone.
        own_segment = segment if labels or not contours else None
        scene = Scene([volume, *further], labels=opened_labels(labels, label_table, own_segment, volume, quiet=quiet))
        of_plane: Any = (plane or "axial") if normal is None else (point, normal)
        lines = opened_isolines(isolines, time=reader.time or 0, quiet=quiet, suv=reader.suv)
        check_uptake(scene, suv=reader.suv, others=[one.volume for one in lines or ()])
        options |= {"contours": opened_contours(contours, segment, quiet=quiet), "isolines": lines}
        if is_sheet:
            bar: Any = figure.scale_bar if figure.bar_length is None else figure.bar_length
            picture = lightbox(scene, of_plane, positions, columns=columns, scale_bar=bar, **options)
            # Each slice has its letters, and one of them the bar.
            figure = replace(figure, letters=False, scale_bar=False, bar_length=None)
        else:
            picture = cut(scene, of_plane, position, **options)
    if not quiet:
        print_notes(picture)
    picture = annotated(picture, figure, quiet=quiet)
    picture.save(output, bits=bits, dpi=figure.dpi)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    print_result(facts, output, as_json=json, written=output)
