"""`wavesplat slice`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil
from typing import Any, ClassVar, get_args

from wavesplat._cli.options import parsers
from wavesplat._cli.options.figure import FigureOptions, annotated, check_figure
from wavesplat._cli.options.groups import (
    Input,
    Json,
    PictureOutput,
    Quiet,
    background,
    bits,
    kernel,
    option,
    part,
    picture_size,
    threads,
    zoom,
)
from wavesplat._cli.options.layers import ChannelOptions, further_layers
from wavesplat._cli.options.opened_layers import FirstLayers, first_layers
from wavesplat._cli.options.reader import ProcessingOptions, ReaderOptions, check_uptake
from wavesplat._cli.options.slices import (
    ComparisonOptions,
    LabelOptions,
    LineOptions,
    opened_comparison,
    opened_contours,
    opened_isolines,
    opened_labels,
)
from wavesplat._cli.options.transfer_function import ColorOptions, NamedLookOptions
from wavesplat._cli.printing import check_outputs, print_notes, print_result, warnings_as_notes
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._model.arguments.sampling import Slab
from wavesplat._model.camera.views import PLANES
from wavesplat.errors import ArgumentError

#: Sheets of the three planes.
OF_THREE = ("all", "ortho")
#: Least number of pixels along the longer side of a patient's slice that is not given a size.
MIN_SIDE_PX = 512
#: Minimum pixels along the longer side of a picture of a single plane with several levels, if no size is given.
PLANE_PX = 2048
#: A plane counts as "xy", "xz" or "yz" if the cosine of its normal and the axis differs from 1 by at most this.
ON_AXIS = 1e-9


@dataclass(repr=False)
class SheetOptions:
    """Several slices on one sheet."""

    TITLE: ClassVar = "Several slices"

    positions: Any = option(
        "START:STOP:STEP|N",
        "Several slices on one sheet: positions such as 10:80:10 or 10,20,35, or 1mm:8mm:0.5mm, or how many.",
        parser=parsers.positions,
    )
    columns: int | None = option("N", "Slices in a row of the sheet.")
    reference_lines: bool | None = option(
        None,
        "On a sheet: lines where the other planes lie, if not given on three planes; of --positions on a scout, a "
        "slice at right angles.",
        "--reference-lines/--no-reference-lines",
        show_default=False,
    )


@dataclass(repr=False)
class PlaneOptions:
    """Where the slice lies, how thick it is, and how it is drawn."""

    TITLE: ClassVar = "Slice"

    plane: Any = option(
        help=f"{', '.join(PLANES)}; all three on one sheet: all in a row, ortho aligned; else axial or xy.",
        choices=(*PLANES, *OF_THREE),
    )
    position: Any = option(
        "LENGTH",
        "Where the plane crosses its axis, or how far from the point: world units, or with its unit, such as 12mm.",
        parser=parsers.length,
    )
    point: Any = option("X,Y,Z", "Any plane: a point on it, world units.", parser=parsers.numbers(3, "0,0,50"))
    normal: Any = option("X,Y,Z", "Any plane: at right angles to this.", parser=parsers.numbers(3, "0,0.3,1"))
    thickness: Any = option(
        "LENGTH",
        "Of a slab around the plane: world units, or with its unit, such as 5mm or 20um.",
        default="0",
        parser=parsers.length,
    )
    slab: Any = option(
        help=f"What is kept across it: {', '.join(get_args(Slab))}.", default="maximum", choices=get_args(Slab)
    )
    size: Any = picture_size(
        "Pixels; if not given, one per sample of the finest spacing, and 512 or more of a patient's slice.", None
    )
    zoom: float = zoom()
    center: Any = option("X,Y,Z", "World position in the picture's middle.", parser=parsers.numbers(3, "0,0,50"))
    kernel: Any = kernel()
    background: Any = background("black")
    bits: int = bits()
    threads: int | None = threads()
    sheet: SheetOptions = part(SheetOptions)

    @property
    def is_sheet(self) -> bool:
        """Whether several slices are drawn on one sheet."""
        return self.sheet.positions is not None or self.plane in OF_THREE

    def check(self) -> None:
        """Refuse options that cannot work, before anything is read."""
        parsers.refuse_pairs(plane=self.plane, normal=self.normal)
        parsers.refuse_pairs(position=self.position, positions=self.sheet.positions)
        if self.plane in OF_THREE:
            parsers.refuse_pairs(plane=self.plane, position=self.position)
            parsers.refuse_pairs(plane=self.plane, positions=self.sheet.positions)
        for name in ("columns", "reference_lines"):
            if getattr(self.sheet, name) is not None and not self.is_sheet:
                written = f"--{name.replace('_', '-')}"
                raise ArgumentError(f"{written} is for several slices on one sheet; give --positions, or --plane all")
        if (self.point is None) != (self.normal is None):
            raise ArgumentError("--point and --normal belong together; give both, or a --plane")

    def arguments(self, first: FirstLayers, plane: Any) -> dict[str, Any]:
        """The options as arguments of `wavesplat.slice`, of lengths in the unit of the volume."""
        own = _size(first.volume, plane) if self.size is None and not self.is_sheet else self.size
        return {
            "size": own,
            "thickness": self.thickness.in_world(first.volume.unit, "--thickness"),
            **{name: getattr(self, name) for name in ("zoom", "center", "kernel", "slab", "background", "threads")},
        }


@takes_several_inputs(".png")
def slice(
    input: Input,
    output: PictureOutput,
    *,
    plane: PlaneOptions,
    look: NamedLookOptions,
    colors: ColorOptions,
    channels: ChannelOptions,
    labels: LabelOptions,
    lines: LineOptions,
    comparison: ComparisonOptions,
    figure: FigureOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a slice through a volume, thin or thick, or several on one sheet, and print the picture's path."""
    parsers.refuse_pairs(preset=look.preset, tf=look.tf)
    plane.check()
    check_outputs(input, output, "pictures")
    from wavesplat._picture.picture import check_bits
    from wavesplat._scene.scene import Scene

    check_bits(plane.bits)
    check_figure(figure)
    first = first_layers(
        input,
        channels,
        reader,
        processing,
        look=look,
        colors=colors,
        is_alone=not (channels.layer or lines.isolines or comparison.checkerboard or comparison.difference),
        n_pixels=plane.zoom * (max(plane.size) if plane.size else PLANE_PX),
        quiet=quiet,
    )
    if comparison.difference is not None and not (first.is_grey or look.tf):
        raise ArgumentError("--difference has its own colours; give their ends as --clim LOW,HIGH, or others as --tf")
    of_plane: Any = plane.plane or _only_plane(first.volume) if plane.normal is None else (plane.point, plane.normal)
    options: Any = plane.arguments(first, of_plane) | {
        "window": colors.window if first.is_grey else None,
        "clim": colors.clim if first.is_grey else None,
        "transfer_function": first.transfer_function,
    }
    how: Any = {"time": reader.time or 0, "quiet": quiet, "suv": reader.suv}
    with warnings_as_notes(quiet=quiet):
        further = further_layers(channels.layer, first.volume, **how)
        # Segments, and the table, may be of the contours alone.
        of_lines = lines.contours and not labels.labels
        shown = LabelOptions() if of_lines else labels
        scene = Scene([*first.layers, *further], labels=opened_labels(shown, first.volume, quiet=quiet))
        isolines = opened_isolines(lines.isolines, first.volume, **how)
        compared = opened_comparison(comparison, first.volume, **how)
        check_uptake(scene, suv=reader.suv, others=[*(one.volume for one in isolines or ()), *compared.volumes])
        table = None if labels.labels else labels.label_table
        regions = opened_contours(lines.contours, table, labels.segment, first.volume, quiet=quiet)
        options |= {"contours": regions, "isolines": isolines, **compared.arguments}
        picture, figure = _cut(scene, of_plane, plane, figure, options)
    if not quiet:
        print_notes(picture)
    picture = annotated(picture, figure, scene, quiet=quiet)
    picture.save(output, bits=plane.bits, dpi=figure.dpi)
    facts = {"picture": str(output), "size": list(picture.size), "input": input, "report": picture.report}
    print_result(facts, output, as_json=json, written=output)


def _cut(
    scene: Any, of_plane: Any, plane: PlaneOptions, figure: FigureOptions, options: dict[str, Any]
) -> tuple[Any, FigureOptions]:
    """The picture of one slice or of a sheet, and the figure that is still to be drawn on it."""
    from wavesplat._scene.slices.lightbox import lightbox
    from wavesplat._scene.slices.slicing import slice as cut

    unit, positions = scene.layers[0].drawn.unit, plane.sheet.positions
    if not plane.is_sheet:
        position = plane.position and plane.position.in_world(unit, "--position")
        return cut(scene, of_plane, position, **options), figure
    if isinstance(positions, tuple):
        positions = [one.in_world(unit, "--positions") for one in positions]
    marks = figure.marks
    bar: Any = marks.scale_bar if marks.bar_length is None else marks.bar_length
    options |= {"columns": plane.sheet.columns, "reference_lines": plane.sheet.reference_lines, "scale_bar": bar}
    # Each slice has its letters, and one of them the bar.
    left = replace(figure, figure=False, marks=replace(marks, letters=False, scale_bar=False, bar_length=None))
    return lightbox(scene, of_plane, positions, **options), left


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


def _size(volume: Any, plane: Any) -> tuple[int, int]:
    """Pixels of a slice that is not given a size: a whole number from sample to sample.

    A patient's slices have `MIN_SIDE_PX` or more, to be read; other data a pixel per sample, to be worked on.
    """
    from wavesplat._render.slicing import sides_of

    steps = [max(1, round(side / min(volume.spacing))) for side in sides_of(volume, plane)]
    times = ceil((MIN_SIDE_PX - 1) / max(steps)) if volume.is_anatomical else 1
    return times * steps[0] + 1, times * steps[1] + 1
