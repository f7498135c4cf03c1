"""The command line: `wavesplat` render, slice, mesh, wavelet, info, demo.

Results go to stdout; messages, errors and the progress bar to stderr.
Everything but argument parsing is imported inside the commands, so that `--help` and mistakes answer at once.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn, get_args

import typer

from wavesplat.errors import ArgumentError, FileError, WavesplatError
from wavesplat.options import PLANES, VIEWS, Composite, Kernel, Quality, Slab

if TYPE_CHECKING:
    from wavesplat.camera import Camera
    from wavesplat.materials import Materials
    from wavesplat.transfer_function import TransferFunction
    from wavesplat.volume import Volume
    from wavesplat.wavelet_volume import WaveletVolume

__all__ = ["app", "main"]

EXIT_OK, EXIT_FAILED, EXIT_USAGE, EXIT_INTERRUPTED = 0, 1, 2, 130

#: What Typer raises for wrong arguments: it does not export its name, only that of one of its children.
CommandLineError: Any = typer.BadParameter.__mro__[2]

EPILOG = (
    "Exit codes: 0 it worked; 1 the file, the data or the machine failed; 2 wrong arguments; 130 interrupted. "
    "Results go to stdout, messages to stderr. NO_COLOR switches colours off."
)

app = typer.Typer(
    name="wavesplat",
    help="Pictures of volumes, by high-resolution splatting.",
    epilog=EPILOG,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

# The numbers that people write on a command line ---------------------------------------------------------------------


def _one_of(names: Sequence[str]) -> Callable[[str], str]:
    def parse(text: str) -> str:
        if text not in names:
            raise typer.BadParameter(f"{text!r} is not one of: {', '.join(names)}")
        return text

    return parse


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not WIDTHxHEIGHT, such as 800x600") from None
    return width, height


def _numbers(count: int, example: str) -> Callable[[str], tuple[float, ...]]:
    def parse(text: str) -> tuple[float, ...]:
        try:
            numbers = tuple(float(part) for part in text.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != count:
            raise typer.BadParameter(f"{text!r} is not {count} numbers with commas between, such as {example}")
        return numbers

    return parse


def _whole_numbers(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not whole numbers with commas between, such as 64,128,128") from None


def _weights(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not numbers with commas between, such as 1,1,0") from None


def _color(text: str) -> tuple[float, ...] | None:
    from wavesplat import colors

    try:
        return colors.parse(text)
    except ArgumentError as error:
        raise typer.BadParameter(str(error)) from None


# Options that several commands share ---------------------------------------------------------------------------------

Input = Annotated[str, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)]
Series = Annotated[str | None, typer.Option(metavar="UID", help="DICOM: which series, if the folder holds several.")]
Time = Annotated[int | None, typer.Option(metavar="N", help="Which time point, from 0.")]
Channel = Annotated[int | None, typer.Option(metavar="N", help="Which channel, from 0.")]
Dataset = Annotated[str | None, typer.Option(metavar="NAME", help="HDF5, .npz, Zarr: which array.")]
Level = Annotated[int | None, typer.Option(metavar="N", help="OME-Zarr: level of detail, 0 is the finest.")]
Shape = Annotated[Any, typer.Option(metavar="Z,Y,X", parser=_whole_numbers, help="Raw: number of samples.")]
Dtype = Annotated[str | None, typer.Option(metavar="TYPE", help='Raw: type of the samples, such as "uint8".')]
Spacing = Annotated[
    Any,
    typer.Option(
        metavar="X,Y,Z", parser=_numbers(3, "0.7,0.7,1.5"), help="Distances of samples, instead of the file's."
    ),
]
ByteOrder = Annotated[str | None, typer.Option(metavar="little|big", help="Raw: byte order of the samples.")]
Offset = Annotated[int, typer.Option(metavar="BYTES", help="Raw: bytes before the first sample.")]
Family = Annotated[
    str, typer.Option(metavar="NAME", help="Wavelets: cdf97, cdf53, haar, spline4, bspline2 to bspline4.")
]
Threshold = Annotated[
    float | None, typer.Option(metavar="T", help="Drop wavelet coefficients of less amplitude, in sample units.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No messages and no progress bar; errors still show.")]


@app.command(epilog=EPILOG)
def render(
    input: Input,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT", help="Picture to write: .png, .tif or .exr.", show_default=False),
    ],
    preset: Annotated[
        str | None, typer.Option(metavar="NAME", help="Transfer function by name; auto if neither is given.")
    ] = None,
    tf: Annotated[Path | None, typer.Option("--tf", metavar="FILE.json", help="Transfer function from a file.")] = None,
    materials: Annotated[
        str | None, typer.Option(metavar="FILE.json|ct|fit", help="Materials: a file, a preset, or from the histogram.")
    ] = None,
    view: Annotated[
        Any,
        typer.Option(metavar="NAME", parser=_one_of(tuple(VIEWS)), help=f"{', '.join(VIEWS)}; anterior if not given."),
    ] = None,
    azimuth: Annotated[
        float | None, typer.Option(metavar="DEG", help="Turn the eye from the front to the patient's left.")
    ] = None,
    elevation: Annotated[float | None, typer.Option(metavar="DEG", help="Lift the eye.")] = None,
    zoom: Annotated[float, typer.Option(metavar="FACTOR", help="Magnification; 1 fits the volume.")] = 1.0,
    perspective: Annotated[
        float | None, typer.Option(metavar="DEG", help="Perspective with this vertical angle.")
    ] = None,
    size: Annotated[Any, typer.Option(metavar="WxH", parser=_size, help="Pixels.")] = "512x512",
    kernel: Annotated[
        Any, typer.Option(metavar="NAME", parser=_one_of(get_args(Kernel)), help=f"{', '.join(get_args(Kernel))}.")
    ] = "linear",
    composite: Annotated[
        Any,
        typer.Option(metavar="NAME", parser=_one_of(get_args(Composite)), help=f"{', '.join(get_args(Composite))}."),
    ] = "over",
    iso_value: Annotated[float | None, typer.Option(metavar="VALUE", help="Surface that first-hit shows.")] = None,
    quality: Annotated[
        Any, typer.Option(metavar="NAME", parser=_one_of(get_args(Quality)), help=f"{', '.join(get_args(Quality))}.")
    ] = "normal",
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
            parser=_weights,
            help="A weight for each level of wavelets, the finest first, and for the coarsest samples.",
        ),
    ] = None,
    family: Family = "cdf97",
    background: Annotated[
        Any, typer.Option(metavar="COLOR", parser=_color, help="black, white, grey, #rrggbb, r,g,b or transparent.")
    ] = "black",
    crop: Annotated[
        Any,
        typer.Option(
            metavar="X0,Y0,Z0,X1,Y1,Z1", parser=_numbers(6, "0,0,0,50,50,50"), help="Draw only this box, world units."
        ),
    ] = None,
    crop_index: Annotated[
        Any,
        typer.Option(metavar="X0,Y0,Z0,X1,Y1,Z1", parser=_numbers(6, "0,0,0,50,50,50"), help="The same, in samples."),
    ] = None,
    shading: Annotated[bool, typer.Option(help="Light the surfaces, or draw colours as they are.")] = True,
    bits: Annotated[int, typer.Option(metavar="8|16", help="Bits per channel of a PNG file.")] = 8,
    threads: Annotated[int | None, typer.Option(metavar="N", help="Worker threads; all cores if not given.")] = None,
    report: Annotated[Path | None, typer.Option(metavar="FILE.json", help="Write how the picture was made.")] = None,
    series: Series = None,
    time: Time = None,
    channel: Channel = None,
    dataset: Dataset = None,
    level: Level = None,
    shape: Shape = None,
    dtype: Dtype = None,
    spacing: Spacing = None,
    byte_order: ByteOrder = None,
    offset: Offset = 0,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a picture of a volume and print its path."""
    _refuse_pairs(preset=preset, tf=tf)
    _refuse_pairs(preset=preset, materials=materials)
    _refuse_pairs(tf=tf, materials=materials)
    _refuse_pairs(view=view, azimuth=azimuth)
    _refuse_pairs(view=view, elevation=elevation)
    _refuse_pairs(crop=crop, crop_index=crop_index)
    _check_outputs(output, report)
    from wavesplat.rendering import DEFAULT_SHADING

    volume = _open_any(
        input, series=series, time=time, channel=channel, dataset=dataset, level=level, shape=shape, dtype=dtype,
        spacing=spacing, byte_order=byte_order, offset=offset,
    )  # fmt: skip
    volume, drop_levels = _levels(volume, family, threshold, levels, bands)
    transfer_function = _transfer_function(volume, preset, tf, materials, composite, input)
    camera = _camera(volume, view, azimuth, elevation, zoom=zoom, view_angle=perspective, size=size)
    if not quiet:
        _note_what_stays_hidden(volume, transfer_function, composite)
    picture = _render(
        volume,
        transfer_function,
        camera,
        shown=not quiet and sys.stderr.isatty(),
        size=size,
        kernel=kernel,
        composite=composite,
        iso_value=iso_value,
        shading=DEFAULT_SHADING if shading else None,
        quality=quality,
        sheets_per_slice=sheets_per_slice,
        oversampling=oversampling,
        psnr=psnr,
        drop_levels=drop_levels,
        crop=_crop(crop, crop_index),
        background=background,
        threads=threads,
    )
    picture.save(output, bits=bits)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    if report is not None:
        _write_report(report, facts)
    print(_as_json(facts) if json else output)


@app.command(epilog=EPILOG)
def slice(
    input: Input,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT", help="Picture to write: .png, .tif or .exr.", show_default=False),
    ],
    plane: Annotated[
        Any,
        typer.Option(metavar="NAME", parser=_one_of(tuple(PLANES)), help=f"{', '.join(PLANES)}; else axial."),
    ] = None,
    position: Annotated[
        float | None,
        typer.Option(metavar="MM", help="Where the plane crosses its axis, or how far from the point; world units."),
    ] = None,
    point: Annotated[
        Any, typer.Option(metavar="X,Y,Z", parser=_numbers(3, "0,0,50"), help="Any plane: a point on it, world units.")
    ] = None,
    normal: Annotated[
        Any, typer.Option(metavar="X,Y,Z", parser=_numbers(3, "0,0.3,1"), help="Any plane: at right angles to this.")
    ] = None,
    size: Annotated[
        Any,
        typer.Option(metavar="WxH", parser=_size, help="Pixels; those of the finest spacing if not given."),
    ] = None,
    zoom: Annotated[float, typer.Option(metavar="FACTOR", help="Magnification; 1 fits the volume.")] = 1.0,
    center: Annotated[
        Any, typer.Option(metavar="X,Y,Z", parser=_numbers(3, "0,0,50"), help="World position in the picture's middle.")
    ] = None,
    kernel: Annotated[
        Any, typer.Option(metavar="NAME", parser=_one_of(get_args(Kernel)), help=f"{', '.join(get_args(Kernel))}.")
    ] = "linear",
    thickness: Annotated[float, typer.Option(metavar="MM", help="Of a slab around the plane, world units.")] = 0.0,
    slab: Annotated[
        Any,
        typer.Option(
            metavar="NAME", parser=_one_of(get_args(Slab)), help=f"What is kept across it: {', '.join(get_args(Slab))}."
        ),
    ] = "maximum",
    window: Annotated[
        Any, typer.Option(metavar="LOW,HIGH", parser=_numbers(2, "-150,250"), help="Values shown as black and white.")
    ] = None,
    preset: Annotated[str | None, typer.Option(metavar="NAME", help="Colours: a transfer function by name.")] = None,
    tf: Annotated[Path | None, typer.Option("--tf", metavar="FILE.json", help="Transfer function from a file.")] = None,
    letters: Annotated[bool, typer.Option("--letters", help="Write R, L, A, P, S, I at the edges.")] = False,
    scale_bar: Annotated[bool, typer.Option("--scale-bar", help="Draw a bar of a round length.")] = False,
    background: Annotated[
        Any, typer.Option(metavar="COLOR", parser=_color, help="black, white, grey, #rrggbb, r,g,b or transparent.")
    ] = "black",
    bits: Annotated[int, typer.Option(metavar="8|16", help="Bits per channel of a PNG file.")] = 8,
    threads: Annotated[int | None, typer.Option(metavar="N", help="Worker threads; all cores if not given.")] = None,
    series: Series = None,
    time: Time = None,
    channel: Channel = None,
    dataset: Dataset = None,
    level: Level = None,
    shape: Shape = None,
    dtype: Dtype = None,
    spacing: Spacing = None,
    byte_order: ByteOrder = None,
    offset: Offset = 0,
    json: Json = False,
) -> None:
    """Draw a slice through a volume, thin or thick, and print the picture's path."""
    _refuse_pairs(preset=preset, tf=tf)
    _refuse_pairs(plane=plane, normal=normal)
    if (point is None) != (normal is None):
        raise ArgumentError("--point and --normal belong together; give both, or a --plane")
    _check_outputs(output, None)
    from wavesplat.slicing import slice as cut

    volume = _open_any(
        input, series=series, time=time, channel=channel, dataset=dataset, level=level, shape=shape, dtype=dtype,
        spacing=spacing, byte_order=byte_order, offset=offset,
    )  # fmt: skip
    is_colored = preset is not None or tf is not None
    picture = cut(
        volume,
        (plane or "axial") if normal is None else (point, normal),
        position,
        size=size,
        zoom=zoom,
        center=center,
        kernel=kernel,
        thickness=thickness,
        slab=slab,
        window=window,
        transfer_function=_transfer_function(volume, preset, tf, None, "over", input) if is_colored else None,
        letters=letters,
        scale_bar=scale_bar,
        background=background,
        threads=threads,
    )
    picture.save(output, bits=bits)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    print(_as_json(facts) if json else output)


@app.command(epilog=EPILOG)
def info(
    input: Input,
    series: Series = None,
    time: Time = None,
    channel: Channel = None,
    dataset: Dataset = None,
    level: Level = None,
    shape: Shape = None,
    dtype: Dtype = None,
    spacing: Spacing = None,
    byte_order: ByteOrder = None,
    offset: Offset = 0,
    json: Json = False,
) -> None:
    """Say what a volume holds: size, spacing, type, orientation, values."""
    from wavesplat import describe
    from wavesplat.wavelet_volume import WaveletVolume

    volume = _open_any(
        input, series=series, time=time, channel=channel, dataset=dataset, level=level, shape=shape, dtype=dtype,
        spacing=spacing, byte_order=byte_order, offset=offset,
    )  # fmt: skip
    if isinstance(volume, WaveletVolume):
        facts = describe.describe_wavelets(volume)
        text = describe.wavelet_lines(facts)
    else:
        facts = describe.describe(volume)
        text = describe.lines(facts)
    print(_as_json(facts) if json else "\n".join(text))


@app.command(epilog=EPILOG)
def wavelet(
    input: Input,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="OUT", help="File to write: .wavelets.", show_default=False)
    ] = None,
    family: Family = "cdf97",
    threshold: Threshold = None,
    keep: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Keep this share of the coefficients, 0..1.")
    ] = None,
    psnr: Annotated[float | None, typer.Option(metavar="DB", help="Keep as few as give samples of this PSNR.")] = None,
    levels: Annotated[int | None, typer.Option(metavar="N", help="Levels of details; all if not given.")] = None,
    normalisation: Annotated[
        Any,
        typer.Option(metavar="NAME", parser=_one_of(("l2", "peak")), help="What amplitudes are measured by: l2, peak."),
    ] = "l2",
    series: Series = None,
    time: Time = None,
    channel: Channel = None,
    dataset: Dataset = None,
    level: Level = None,
    shape: Shape = None,
    dtype: Dtype = None,
    spacing: Spacing = None,
    byte_order: ByteOrder = None,
    offset: Offset = 0,
    json: Json = False,
) -> None:
    """Analyse a volume, drop small wavelet coefficients, say what is left, and keep it in a file."""
    from wavesplat import describe
    from wavesplat.wavelet_volume import WaveletVolume, check_suffix

    if output is not None:
        check_suffix(output)
    volume = _open(
        input, series=series, time=time, channel=channel, dataset=dataset, level=level, shape=shape, dtype=dtype,
        spacing=spacing, byte_order=byte_order, offset=offset,
    )  # fmt: skip
    wavelets = WaveletVolume.from_volume(
        volume, family, threshold=threshold, keep=keep, psnr=psnr, levels=levels, normalisation=normalisation
    )
    facts = describe.describe_wavelets(wavelets, volume)
    text = describe.wavelet_lines(facts)
    if output is not None:
        wavelets.save(output)
        facts |= {"file": str(output), "n_bytes_of_file": output.stat().st_size}
        text.append(f"file         {output}, {facts['n_bytes_of_file'] / 2**20:.3g} MiB")
    print(_as_json(facts) if json else "\n".join(text))


@app.command(epilog=EPILOG)
def mesh(
    input: Input,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="OUT", help="Mesh to write: .ply, .stl, .obj, .glb, .gltf.", show_default=False
        ),
    ],
    iso_value: Annotated[float, typer.Option(metavar="VALUE", help="The surface's value.", show_default=False)],
    closed: Annotated[bool, typer.Option("--closed/--open", help="Close what the volume's faces or a box cut.")] = True,
    step: Annotated[int, typer.Option(metavar="N", help="Take every n-th sample: fewer triangles.")] = 1,
    crop: Annotated[
        Any,
        typer.Option(
            metavar="X0,Y0,Z0,X1,Y1,Z1", parser=_numbers(6, "0,0,0,50,50,50"), help="Only this box, world units."
        ),
    ] = None,
    crop_index: Annotated[
        Any,
        typer.Option(metavar="X0,Y0,Z0,X1,Y1,Z1", parser=_numbers(6, "0,0,0,50,50,50"), help="The same, in samples."),
    ] = None,
    series: Series = None,
    time: Time = None,
    channel: Channel = None,
    dataset: Dataset = None,
    level: Level = None,
    shape: Shape = None,
    dtype: Dtype = None,
    spacing: Spacing = None,
    byte_order: ByteOrder = None,
    offset: Offset = 0,
    json: Json = False,
) -> None:
    """Write the surface of one value as a triangle mesh, in world units, and print its path."""
    _refuse_pairs(crop=crop, crop_index=crop_index)
    from wavesplat import meshing
    from wavesplat.output import check_writable

    meshing.check_suffix(output)
    check_writable(output)
    volume = _open_any(
        input, series=series, time=time, channel=channel, dataset=dataset, level=level, shape=shape, dtype=dtype,
        spacing=spacing, byte_order=byte_order, offset=offset,
    )  # fmt: skip
    surface = meshing.mesh(volume, iso_value, closed=closed, step=step, crop=_crop(crop, crop_index))
    surface.save(output)
    print(_as_json({"mesh": str(output), "input": input, **surface.facts()}) if json else output)


@app.command(epilog=EPILOG)
def demo(
    folder: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures; made if missing.")
    ] = Path("out"),
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw the volumes that come with the package and print the pictures' paths."""
    from wavesplat import demo as scenes

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder: {error.strerror}; choose another with -o: {folder}") from None
    paths = []
    for path in scenes.draw(folder):
        paths.append(str(path))
        if not json:
            print(path, flush=True)
    if json:
        print(_as_json({"pictures": paths}))
    elif not quiet:
        _message(f"drew {len(paths)} pictures in {folder}")


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    if version:
        from wavesplat._native import __version__

        print(f"wavesplat {__version__}")
        raise typer.Exit(EXIT_OK)
    if context.invoked_subcommand is None:
        print(context.get_help())
        raise typer.Exit(EXIT_USAGE)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and leave with its exit code; every failure is one line on stderr."""
    try:
        code = app(args=arguments, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        code = EXIT_INTERRUPTED
    except ArgumentError as error:
        _fail(str(error), EXIT_USAGE)
    except WavesplatError as error:
        _fail(str(error), EXIT_FAILED)
    except CommandLineError as error:
        _fail(error.format_message().rstrip(".") + "; see wavesplat --help", EXIT_USAGE)
    except MemoryError:
        _fail("not enough memory; use a smaller picture, a coarser level or a smaller volume", EXIT_FAILED)
    except BrokenPipeError:
        # The reader of our output has gone, as in `wavesplat info x | head -1`.
        sys.stderr.close()
        sys.exit(EXIT_OK)
    if code == EXIT_INTERRUPTED:  # some releases of Typer return it, some raise
        _message("interrupted; nothing was written")
    sys.exit(code if isinstance(code, int) else EXIT_OK)


# What the commands are made of ---------------------------------------------------------------------------------------


def _message(text: str) -> None:
    print(f"wavesplat: {text}", file=sys.stderr)


def _fail(text: str, code: int) -> NoReturn:
    _message("error: " + " ".join(text.split()))
    sys.exit(code)


def _as_json(facts: dict[str, Any]) -> str:
    import json

    return json.dumps(facts, indent=2, allow_nan=False, default=float)


def _refuse_pairs(**given: object) -> None:
    first, second = given
    if given[first] is not None and given[second] is not None:
        names = " and ".join("--" + name.replace("_", "-") for name in given)
        raise ArgumentError(f"{names} say the same thing twice; give one of them")


def _check_outputs(output: Path, report: Path | None) -> None:
    """Find out before the work whether its result can be kept."""
    from wavesplat.output import check_writable
    from wavesplat.picture import check_suffix

    check_suffix(output)
    check_writable(output)
    if report is not None:
        check_writable(report)


def _open(path: str, **options: Any) -> Volume:
    from wavesplat import readers

    return readers.open(path, **options)


def _open_any(path: str, **options: Any) -> Volume | WaveletVolume:
    """A volume, or a file of wavelet coefficients."""
    if not path.endswith(".wavelets"):
        return _open(path, **options)
    from wavesplat.wavelet_volume import WaveletVolume

    given = sorted("--" + name.replace("_", "-") for name, value in options.items() if value)
    if given:
        raise ArgumentError(f"{', '.join(given)} say nothing about a file of wavelet coefficients; leave them out")
    return WaveletVolume.load(path)


def _levels(
    volume: Volume | WaveletVolume,
    family: str,
    threshold: float | None,
    levels: int | None,
    bands: tuple[float, ...] | None,
) -> tuple[Volume | WaveletVolume, int]:
    """What is drawn, as wavelets if any of these options asks for them, and how many levels are left out."""
    from wavesplat.wavelet_volume import WaveletVolume

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


def _transfer_function(
    volume: Volume | WaveletVolume,
    preset: str | None,
    file: Path | None,
    materials: str | None,
    composite: str,
    path: str,
) -> TransferFunction:
    from wavesplat.transfer_function import TransferFunction

    if materials is not None:
        return _materials(volume, materials).transfer_function()
    if file is not None:
        return TransferFunction.load(file, volume)
    if preset not in (None, "auto"):
        return TransferFunction.preset(preset, volume)
    try:
        return TransferFunction.auto(volume, composite)
    except ArgumentError as error:
        # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
        raise FileError(f"{error}: {path}") from None


def _materials(volume: Volume | WaveletVolume, given: str) -> Materials:
    from wavesplat.materials import Materials

    if given == "fit":
        return Materials.fit(volume)
    return Materials.load(given) if given.endswith(".json") else Materials.preset(given)


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
    from wavesplat.camera import Camera

    aspect = size[0] / size[1] if min(size) > 0 else 1.0  # the renderer refuses an empty picture
    if azimuth is None and elevation is None:
        return Camera.view(volume, view or "anterior", zoom=zoom, view_angle=view_angle, aspect=aspect)
    return Camera.orbit(volume, azimuth or 0.0, elevation or 0.0, zoom=zoom, view_angle=view_angle, aspect=aspect)


def _crop(world: tuple[float, ...] | None, index: tuple[float, ...] | None) -> Any:
    from wavesplat.crop import Crop

    if world is not None:
        return Crop(world[:3], world[3:], space="world")
    return None if index is None else Crop(index[:3], index[3:], space="index")


def _note_what_stays_hidden(
    volume: Volume | WaveletVolume, transfer_function: TransferFunction, composite: str
) -> None:
    import numpy as np

    if volume.n_nonfinite:
        _message(f"note: {volume.n_nonfinite} samples are NaN or infinite; they are drawn as empty")
    low, high = volume.value_range
    nodes = [value for value, _ in transfer_function.opacity if low <= value <= high]
    if composite == "over" and not transfer_function(np.array([low, high, *nodes]))[:, 3].any():
        _message(
            f"note: the transfer function is transparent over the volume's values, {low:g} to {high:g}, so the "
            "picture is empty; try --preset auto"
        )


def _render(
    volume: Volume | WaveletVolume, transfer_function: TransferFunction, camera: Camera, *, shown: bool, **options: Any
) -> Any:
    from wavesplat import progress
    from wavesplat.rendering import render as draw

    return progress.run(
        lambda report: draw(volume, transfer_function, camera, progress=report, **options), "drawing", shown=shown
    )


def _write_report(path: Path, facts: dict[str, Any]) -> None:
    from wavesplat.output import write_atomically

    write_atomically(path, lambda part: part.write_text(_as_json(facts) + "\n", encoding="utf-8"))


if __name__ == "__main__":
    main()
