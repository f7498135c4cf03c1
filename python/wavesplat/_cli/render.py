"""`wavesplat render`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.crop_options import box, chosen_crop
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import is_terminal, json_text, message, print_notes, print_result
from wavesplat._cli.reader_options import Input, ReaderOptions, open_any, takes_reader_options
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
    TransferFunctionFile,
    chosen_transfer_function,
    function_in_file,
    function_of_materials,
)
from wavesplat._model.options import BY_VIEW, VIEWS, Composite, Quality
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._looks.shading import Shading
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._looks.transfer_function_2d import TransferFunction2D
    from wavesplat._model.camera import Camera
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["render"]


@takes_reader_options
def render(
    input: Input,
    output: PictureOutput,
    *,
    preset: Annotated[
        str | None, typer.Option(metavar="NAME", help="Transfer function by name; auto if neither is given.")
    ] = None,
    tf: TransferFunctionFile = None,
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
            metavar="NAME", parser=parsers.one_of(tuple(VIEWS)), help=f"{', '.join(VIEWS)}; anterior if not given."
        ),
    ] = None,
    azimuth: Annotated[
        float | None, typer.Option(metavar="DEG", help="Turn the eye from the front to the patient's left.")
    ] = None,
    elevation: Annotated[float | None, typer.Option(metavar="DEG", help="Lift the eye.")] = None,
    zoom: Zoom = 1.0,
    perspective: Annotated[
        float | None, typer.Option(metavar="DEG", help="Perspective with this vertical angle.")
    ] = None,
    size: Annotated[Any, typer.Option(metavar="WxH", parser=parsers.size, help="Pixels.")] = "512x512",
    kernel: Kernel = "linear",
    composite: Annotated[Any, parsers.choice(get_args(Composite))] = "over",
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
    background: Background = "black",
    crop: Annotated[Any, box("Draw only this box, world units.")] = None,
    crop_index: Annotated[Any, box("The same, in samples.")] = None,
    shading: Annotated[bool, typer.Option(help="Light the surfaces, or draw colours as they are.")] = True,
    occlusion: Annotated[float, typer.Option(metavar="0..1", help="How much hollows darken.")] = 0.0,
    shadow: Annotated[
        float, typer.Option(metavar="0..1", help="How dark shadows are, with the light from the upper left.")
    ] = 0.0,
    bits: Bits = 8,
    threads: Threads = None,
    report: Annotated[Path | None, typer.Option(metavar="FILE.json", help="Write how the picture was made.")] = None,
    reader: ReaderOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a picture of a volume and print its path."""
    parsers.refuse_pairs(preset=preset, tf=tf)
    parsers.refuse_pairs(preset=preset, materials=materials)
    parsers.refuse_pairs(tf=tf, materials=materials)
    parsers.refuse_pairs(view=view, azimuth=azimuth)
    parsers.refuse_pairs(view=view, elevation=elevation)
    parsers.refuse_pairs(crop=crop, crop_index=crop_index)
    check_outputs(input, output, "pictures", report)
    from wavesplat._picture.picture import check_bits

    check_bits(bits)
    light = _shading(shading, occlusion, shadow)
    if surfaces is not None and materials is None:
        raise ArgumentError("--surfaces are those between materials; give it with --materials")

    volume, drop_levels = _levels(open_any(input, reader), family, threshold, levels, bands)
    transfer_function: TransferFunction | TransferFunction2D | None
    if tf is not None:
        transfer_function = function_in_file(tf, volume)
    elif materials is not None:
        transfer_function = function_of_materials(volume, materials, surfaces)
    elif composite in BY_VIEW and preset in (None, "auto"):
        transfer_function = None  # greys that depend on the view are left to the renderer
    else:
        transfer_function = chosen_transfer_function(volume, input, preset=preset, tf=None, composite=composite)
    segmentation = _labels(labels, label_table)
    camera = _camera(volume, view, azimuth, elevation, zoom=zoom, view_angle=perspective, size=size)
    if not quiet:
        _note_what_stays_hidden(volume)
    picture = _drawn(
        volume,
        transfer_function,
        camera,
        shown=not quiet and is_terminal(),
        labels=segmentation,
        size=size,
        kernel=kernel,
        composite=composite,
        iso_value=iso_value,
        local_threshold=local_threshold,
        depth_shading=depth_shading,
        attenuation=attenuation,
        shading=light,
        quality=quality,
        sheets_per_slice=sheets_per_slice,
        oversampling=oversampling,
        psnr=psnr,
        drop_levels=drop_levels,
        crop=chosen_crop(crop, crop_index),
        background=background,
        threads=threads,
    )
    if not quiet:
        print_notes(picture)
    picture.save(output, bits=bits)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    if report is not None:
        _write_report(report, facts)
    print_result(facts, output, as_json=json, written=output)


def _shading(is_lit: bool, occlusion: float, shadow: float) -> Shading | None:
    """The usual light; with shadows, one from the upper left of the eye, since those of a headlight are not seen."""
    from wavesplat._looks.shading import Light, Shading

    if not is_lit:
        if occlusion or shadow:
            raise ArgumentError("--occlusion and --shadow are light; leave out --no-shading")
        return None
    lights = [Light((-1, 1, 1.5))] if shadow else []
    return Shading(lights=lights, ambient_occlusion=occlusion, shadow=shadow)


def _labels(path: str | None, table: Path | None) -> Labels | None:
    from wavesplat._looks.labels import Labels

    if path is None:
        if table is not None:
            raise ArgumentError("--label-table names the labels of a segmentation; give it with --labels")
        return None
    return Labels.open(path, table=table)


def _levels(
    volume: Volume | WaveletVolume,
    family: str,
    threshold: float | None,
    levels: int | None,
    bands: tuple[float, ...] | None,
) -> tuple[Volume | WaveletVolume, int]:
    """What is drawn, as wavelets if any of these options asks for them, and how many levels are left out."""
    from wavesplat._model.wavelet_volume import WaveletVolume

    if isinstance(volume, WaveletVolume):
        if threshold is not None:
            raise ArgumentError(
                "--threshold is for samples; the coefficients of this file were dropped when it was made"
            )
    elif threshold is None and levels is None and bands is None:
        return volume, 0
    else:
        volume = WaveletVolume.from_volume(volume, family, threshold=threshold)
    if levels is not None and not 0 <= levels <= volume.n_levels:
        raise ArgumentError(
            f"--levels is {levels}; {volume.name!r} has {volume.n_levels}, so give 0 to {volume.n_levels}"
        )
    return volume.bands(bands), 0 if levels is None else volume.n_levels - levels


def _camera(
    volume: Volume | WaveletVolume,
    view: str | None,
    azimuth: float | None,
    elevation: float | None,
    *,
    zoom: float,
    view_angle: float | None,
    size: tuple[int, int],
) -> Camera:
    from wavesplat._model.camera import Camera

    aspect = size[0] / size[1] if min(size) > 0 else 1.0  # the renderer refuses an empty picture
    if azimuth is None and elevation is None:
        return Camera.view(volume, view or "anterior", zoom=zoom, view_angle=view_angle, aspect=aspect)
    return Camera.orbit(volume, azimuth or 0.0, elevation or 0.0, zoom=zoom, view_angle=view_angle, aspect=aspect)


def _note_what_stays_hidden(volume: Volume | WaveletVolume) -> None:
    if volume.n_nonfinite:
        message(f"note: {volume.n_nonfinite} samples are NaN or infinite; they are drawn as empty")


def _drawn(
    volume: Volume | WaveletVolume,
    transfer_function: TransferFunction | TransferFunction2D | None,
    camera: Camera,
    *,
    shown: bool,
    **options: Any,
) -> Any:
    """The picture; a bar shows how far it is, if `shown`, and Ctrl-C stops it."""
    from wavesplat._cli import progress
    from wavesplat._render.rendering import render as draw

    return progress.run(
        lambda report: draw(volume, transfer_function, camera, progress=report, **options), "drawing", shown=shown
    )


def _write_report(path: Path, facts: dict[str, Any]) -> None:
    from wavesplat._files.output import write_atomically

    write_atomically(path, lambda part: part.write_text(json_text(facts) + "\n", encoding="utf-8"))
