"""`wavesplat render`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.crop_options import (
    CutOptions,
    chosen_clip,
    takes_cut_options,
)
from wavesplat._cli.figure_options import FigureOptions, annotated, check_figure, takes_figure_options
from wavesplat._cli.from_document import draw_from
from wavesplat._cli.layer_options import (
    LayerOptions,
    further_layers,
    names_of_pictures,
    takes_layer_options,
    times_of,
)
from wavesplat._cli.light_options import LightOptions, chosen_shading, takes_light_options
from wavesplat._cli.opened_layers import Channels, opened_layers
from wavesplat._cli.option_groups import given
from wavesplat._cli.outputs import check_outputs, write_report
from wavesplat._cli.printing import is_terminal, message, print_notes, print_result
from wavesplat._cli.processing_options import ProcessingOptions, takes_processing_options
from wavesplat._cli.reader_options import InputOrNone, ReaderOptions, takes_reader_options_but_channel
from wavesplat._cli.shared_options import (
    Background,
    Bits,
    Family,
    Json,
    Kernel,
    PictureOutput,
    Quiet,
    Threads,
    Threshold,
    Zoom,
)
from wavesplat._cli.transfer_function_options import (
    ColorOptions,
    TransferFunctionFile,
    function_of_materials,
    named_look,
    takes_color_options,
)
from wavesplat._model.options import BY_VIEW, COMPOSITE_SYNONYMS, VIEWS, Composite, Quality
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._looks.look import Look
    from wavesplat._model.camera import Camera
    from wavesplat._model.composites import Operator
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume
    from wavesplat._scene.scene import Scene

__all__ = ["render"]


@takes_figure_options
@takes_cut_options
@takes_light_options
@takes_reader_options_but_channel
@takes_layer_options
@takes_color_options
@takes_processing_options
def render(
    context: typer.Context,
    output: PictureOutput,
    input: InputOrNone = None,
    *,
    again: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="Draw again, instead of INPUT: a scene, a report, or a PNG file that says how it was made.",
        ),
    ] = None,
    layering: LayerOptions,
    preset: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Look by name, see `wavesplat presets`; auto if nothing is given."),
    ] = None,
    tf: TransferFunctionFile = None,
    colors: ColorOptions,
    materials: Annotated[
        str | None, typer.Option(metavar="FILE.json|ct|fit", help="Materials: a file, a preset, or from the histogram.")
    ] = None,
    surfaces: Annotated[
        float | None,
        typer.Option(metavar="0..1", help="How much of the materials' opacity only their boundaries have."),
    ] = None,
    labels: Annotated[
        str | None, typer.Option(metavar="FILE", help="A segmentation of the volume, every label in a colour.")
    ] = None,
    label_table: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Their names and colours, from ITK-SNAP, 3D Slicer (.ctbl) or BIDS (.tsv)."),
    ] = None,
    view: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(tuple(VIEWS)),
            help=f"{', '.join(VIEWS)}; the one that suits the data if not given.",
        ),
    ] = None,
    azimuth: Annotated[
        float | None, typer.Option(metavar="DEG", help="Turn the eye from the view to the patient's left.")
    ] = None,
    elevation: Annotated[float | None, typer.Option(metavar="DEG", help="Lift the eye from the view.")] = None,
    zoom: Zoom = 1.0,
    perspective: Annotated[
        float | None, typer.Option(metavar="DEG", help="Perspective with this vertical angle.")
    ] = None,
    size: Annotated[Any, typer.Option(metavar="WxH", parser=parsers.size, help="Pixels.")] = "512x512",
    kernel: Kernel = "linear",
    composite: Annotated[Any, parsers.choice((*get_args(Composite), *COMPOSITE_SYNONYMS))] = None,
    iso_value: Annotated[float | None, typer.Option(metavar="VALUE", help="Surface that first-hit shows.")] = None,
    local_threshold: Annotated[
        float | None, typer.Option(metavar="VALUE", help="Least maximum that local-maximum stops at.")
    ] = None,
    depth_shading: Annotated[
        float | None, typer.Option(metavar="0..1", help="How much depth-shaded-maximum dims the farthest; 0.6.")
    ] = None,
    attenuation: Annotated[
        Any,
        typer.Option(
            metavar="CLEAR,PER_UNIT",
            parser=parsers.numbers(2, "-1000,2.06e-5"),
            help="Of x-ray: a value that absorbs nothing, and absorption per world unit and unit above it.",
        ),
    ] = None,
    quality: Annotated[Any, parsers.choice(get_args(Quality))] = "normal",
    sheets_per_slice: Annotated[
        float | None, typer.Option(metavar="N", help="Instead of what the quality says.")
    ] = None,
    oversampling: Annotated[float | None, typer.Option(metavar="N", help="Instead of what the quality says.")] = None,
    psnr: Annotated[
        float | None, typer.Option(metavar="DB", help="Choose both for this PSNR against the converged picture.")
    ] = None,
    threshold: Threshold = None,
    levels: Annotated[
        int | None, typer.Option(metavar="N", help="Draw the wavelets' N coarsest levels, at their own resolution.")
    ] = None,
    bands: Annotated[
        Any,
        typer.Option(
            metavar="W,W,...",
            parser=parsers.weights,
            help="A weight for each level of wavelets, the finest first, and for the coarsest samples.",
        ),
    ] = None,
    family: Family = "cdf97",
    background: Background = None,
    cuts: CutOptions,
    lighting: LightOptions,
    bits: Bits = 8,
    threads: Threads = None,
    figure: FigureOptions,
    report: Annotated[Path | None, typer.Option(metavar="FILE.json", help="Write how the picture was made.")] = None,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a picture of a volume and print its path."""
    if again is not None:
        how: Any = {"figure": figure, "bits": bits, "threads": threads, "report": report, "json": json, "quiet": quiet}
        draw_from(context, again, output, **how)
        return
    if input is None:
        raise ArgumentError("INPUT is missing: name a volume, a file, folder or URL, or give --from")
    parsers.refuse_pairs(preset=preset, tf=tf)
    parsers.refuse_pairs(preset=preset, materials=materials)
    parsers.refuse_pairs(tf=tf, materials=materials)
    parsers.refuse_pairs(cmap=colors.cmap, materials=materials)
    parsers.refuse_pairs(crop=cuts.crop, crop_index=cuts.crop_index)
    check_outputs(input, output, "pictures", report)
    from wavesplat._looks.over_time import brightest
    from wavesplat._model.sampling import Sampling
    from wavesplat._model.series import Series
    from wavesplat._picture.picture import check_bits
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

    check_bits(bits)
    check_figure(figure)
    composite = COMPOSITE_SYNONYMS.get(composite, composite)
    if surfaces is not None and materials is None:
        raise ArgumentError("--surfaces are those between materials; give it with --materials")
    numbers = {
        "iso_value": iso_value,
        "local_threshold": local_threshold,
        "depth_shading": depth_shading,
        "attenuation": attenuation,
    }
    if composite is not None:
        _operator(composite, **numbers)  # or an error, before anything is read

    opened = opened_layers(input, reader, layering, processing, composite=composite, quiet=quiet)
    if isinstance(opened, Channels):
        for_one = {"preset": preset, "tf": tf, "materials": materials, "threshold": threshold, "levels": levels}
        _refuse_for_channels({**for_one, "bands": bands}, colors, len(opened.layers))
        layers, look = opened
        shading: Any = chosen_shading(lighting, None) if given(lighting) else "look"
    else:
        volume = opened if isinstance(opened, Series) else _levels(opened, family, threshold, levels, bands)
        look = _look(
            brightest(volume) if isinstance(volume, Series) else volume,
            input,
            preset=preset,
            tf=tf,
            materials=materials,
            surfaces=surfaces,
            colors=colors,
            composite=composite,
            quiet=quiet,
        )
        shading = chosen_shading(lighting, look.shading)
        if layering.layer:  # which have light of their own
            look, shading = replace(look, shading=shading), "look"
        # Greys that depend on the view are left to the renderer.
        by_view = look.name == "auto" and look.composite in BY_VIEW and not (layering.layer or layering.times)
        layers = [Layer(volume, None if by_view else look)]
    scene = Scene(
        [*layers, *further_layers(layering.layer, time=reader.time or 0, quiet=quiet)],
        labels=_labels(labels, label_table),
        shading=shading,
        clip=chosen_clip(cuts, layers[0].drawn),
        background=background or look.background or "black",
    )
    pictures = _pictures(scene, layering.times, input, output)
    camera = _camera(
        [one for one, _ in pictures], look, view, azimuth, elevation, zoom=zoom, view_angle=perspective, size=size
    )
    if not quiet:
        _note_guesses(scene, look, composite)
    made = _drawn_all(
        pictures,
        camera,
        input,
        figure=figure,
        bits=bits,
        quiet=quiet,
        size=size,
        kernel=kernel,
        composite=_operator(look.composite if composite is None else composite, **numbers),
        quality=Sampling(sheets_per_slice, oversampling, quality),
        psnr=psnr,
        threads=threads,
    )
    facts = made[0] if layering.times is None else {"pictures": made}
    if report is not None:
        write_report(report, facts)
    print_result(facts, "\n".join(str(path) for _, path in pictures), as_json=json, written=pictures[-1][1])


def _refuse_for_channels(given: dict[str, Any], colors: ColorOptions, n: int) -> None:
    """An error for options that make a look, or coefficients, of one volume."""
    names = [f"--{name}" for name, value in given.items() if value is not None]
    names += ["--cmap, --clim, --log, --opacity and --gamma"] if colors.are_given() else []
    if names:
        raise ArgumentError(
            f"{', '.join(names)}: for one volume, and the picture is of {n} channels; choose one with --channel, or "
            "say how each is shown: --channel 0:green:100,900"
        )


def _pictures(scene: Scene, times: str | None, input: str, output: Path) -> list[tuple[Scene, Path]]:
    """The scene at each time that is wanted, and the file for its picture."""
    from wavesplat._model.series import Series

    if times is None:
        return [(scene, output)]
    series = next((layer.volume for layer in scene.layers if isinstance(layer.volume, Series)), None)
    n = 1 if series is None else len(series)
    named = list(names_of_pictures(output, times_of(times, n), n))
    for _, path in named:
        check_outputs(input, path, "pictures")
    return [(scene if series is None else scene.at_time(number), path) for number, path in named]


def _look(
    volume: Volume | WaveletVolume,
    path: str,
    *,
    preset: str | None,
    tf: Path | None,
    materials: str | None,
    surfaces: float | None,
    colors: ColorOptions,
    composite: Any,
    quiet: bool,
) -> Look:
    """The look that is named, or the one that suits the data. `path`: where the volume came from, for messages."""
    from wavesplat._looks.look import Look
    from wavesplat._render.arguments import chosen_look

    if materials is not None:
        return Look(transfer_function=function_of_materials(volume, materials, surfaces), composite=composite or "over")
    opacity = 1.0 if composite not in (None, "over", "first-hit") else "linear"
    named = named_look(volume, preset=preset, tf=tf, colors=colors, opacity=opacity, quiet=quiet)
    if named is not None:
        return chosen_look(named, volume, composite)
    try:
        return Look.auto(volume, composite)
    except ArgumentError as error:
        # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
        raise FileError(f"{error}: {path}") from None


def _labels(path: str | None, table: Path | None) -> Labels | None:
    from wavesplat._looks.labels import Labels

    if path is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        return None
    return Labels.open(path, table=table)


#: The option that each operator takes a number from.
NUMBERS = {
    "iso_value": "first-hit",
    "local_threshold": "local-maximum",
    "depth_shading": "depth-shaded-maximum",
    "attenuation": "x-ray",
}


def _operator(
    composite: Composite,
    *,
    iso_value: float | None,
    local_threshold: float | None,
    depth_shading: float | None,
    attenuation: tuple[float, float] | None,
) -> Operator:
    """The operator with its number; an `ArgumentError` where a number is another one's."""
    from wavesplat._model.composites import DepthShadedMaximum, FirstHit, LocalMaximum, XRay

    given = {
        "iso_value": iso_value,
        "local_threshold": local_threshold,
        "depth_shading": depth_shading,
        "attenuation": attenuation,
    }
    for name, owner in NUMBERS.items():
        if given[name] is not None and composite != owner:
            option = f"--{name.replace('_', '-')}"
            raise ArgumentError(
                f"{option} is for --composite {owner}, not for {composite}; give that, or leave out {option}"
            )
    if composite == "first-hit":
        if iso_value is None:
            raise ArgumentError("--composite first-hit needs the value of the surface; give it as --iso-value")
        return FirstHit(iso_value)
    if composite == "local-maximum":
        return LocalMaximum(local_threshold)
    if composite == "depth-shaded-maximum":
        return DepthShadedMaximum() if depth_shading is None else DepthShadedMaximum(depth_shading)
    if composite == "x-ray":
        return XRay(*(attenuation or ()))
    return composite


def _levels(
    volume: Volume | WaveletVolume,
    family: str,
    threshold: float | None,
    levels: int | None,
    bands: tuple[float, ...] | None,
) -> Volume | WaveletVolume:
    """What is drawn, as wavelets if any of these options asks for them, without what is left out."""
    from wavesplat._model.wavelet_volume import WaveletVolume

    if isinstance(volume, WaveletVolume):
        if threshold is not None:
            raise ArgumentError(
                "--threshold is for samples; the coefficients of this file were dropped when it was made"
            )
    elif threshold is None and levels is None and bands is None:
        return volume
    else:
        volume = WaveletVolume.from_volume(volume, family, threshold=threshold)
    if levels is not None and not 0 <= levels <= volume.n_levels:
        raise ArgumentError(
            f"--levels is {levels}; {volume.name!r} has {volume.n_levels}, so give 0 to {volume.n_levels}"
        )
    weighted = volume if bands is None else volume.bands(bands)
    return weighted if levels is None else weighted.level(volume.n_levels - levels)


def _camera(
    scenes: Sequence[Scene],
    look: Look,
    view: str | None,
    azimuth: float | None,
    elevation: float | None,
    *,
    zoom: float,
    view_angle: float | None,
    size: tuple[int, int],
) -> Camera:
    """From a view, turned by the angles; without any, from the side that suits the data.

    Of several scenes, which are times, the first, the middle and the last one are in view.
    """
    from wavesplat._model.camera import check_place, checked_lens
    from wavesplat._render.framing import framed, natural_view
    from wavesplat._scene.shown import seen_parts

    scene = scenes[0]
    wanted = dict.fromkeys((0, len(scenes) // 2, len(scenes) - 1))
    parts = [part for number in wanted for part in seen_parts(scenes[number], look)]
    for volume, _ in parts:
        check_place(volume)
    turned = (azimuth or 0.0, elevation or 0.0)
    if view is None and look.view is None:
        from_view = natural_view(parts[0][0]) if azimuth is None and elevation is None else VIEWS["anterior"]
    else:
        from_view = VIEWS[view or look.view or "anterior"]
    aspect = size[0] / size[1] if min(size) > 0 else 1.0  # the renderer refuses an empty picture
    checked_lens(zoom, view_angle)
    return framed(
        parts,
        from_view[0] + turned[0],
        from_view[1] + turned[1],
        clipping=scene._clipping,
        zoom=zoom,
        view_angle=view_angle,
        aspect=aspect,
    )


def _note_guesses(scene: Scene, look: Look, composite: str | None) -> None:
    # Of the guesses the one that changes what a pixel means; all are in the report.
    if look.name == "auto" and composite is None and look.composite != "over" and look.reason.endswith("values"):
        message(f"note: taken for {look.reason}; another look is one of `wavesplat presets`")
    n_nonfinite = sum(layer.drawn.n_nonfinite for layer in scene.layers)
    if n_nonfinite:
        message(f"note: {n_nonfinite} samples are NaN or infinite; they are drawn as empty")


def _drawn_all(
    pictures: Sequence[tuple[Scene, Path]],
    camera: Camera,
    input: str,
    *,
    figure: FigureOptions,
    bits: int,
    quiet: bool,
    **options: Any,
) -> list[dict[str, Any]]:
    """Draw and write pictures; what is told of each."""
    made = []
    for scene, path in pictures:
        picture = _drawn(scene, camera, shown=not quiet and is_terminal(), **options)
        if not quiet:
            print_notes(picture)
        picture = annotated(picture, figure, quiet=quiet)
        picture.save(path, bits=bits, dpi=figure.dpi)
        made.append({"picture": str(path), "size": list(picture.size), "input": input, "report": picture.report})
    return made


def _drawn(scene: Scene, camera: Camera, *, shown: bool, **options: Any) -> Any:
    """The picture; a bar shows how far it is, if `shown`, and Ctrl-C stops it."""
    from wavesplat._cli import progress

    return progress.run(lambda report: scene.render(camera, progress=report, **options), "drawing", shown=shown)
