"""`wavesplat convert`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from wavesplat._cli.options.groups import Input, Json, Quiet, option, output
from wavesplat._cli.options.reader import ReaderOptions, print_guesses
from wavesplat._cli.printing import check_outputs, is_terminal, message, print_result, warnings_as_notes
from wavesplat._cli.several_inputs import takes_several_inputs

if TYPE_CHECKING:
    from wavesplat._model.volume.series import Series
    from wavesplat._model.volume.stack import Stack

#: Samples along each side of the box by which a lazy volume is taken for a segmentation.
SIDE_OF_BOX = 96


@dataclass(repr=False)
class LevelOptions:
    """Coarser levels of the file."""

    downsampling: Any = option(
        "mean|nearest",
        "Of .ome.zarr: coarser levels of means, or for labels of every second sample; by the kind of data.",
        choices=("mean", "nearest"),
    )


@takes_several_inputs(".ome.zarr")
def convert(
    input: Input,
    output: Annotated[Path, output("File to write: .ome.zarr, .ome.tif, .nrrd, .nii.gz or .nii.")],
    *,
    levels: LevelOptions,
    reader: ReaderOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write a volume to a file of another format: all channels and times to .ome.zarr and .ome.tif, one to others."""
    check_outputs(input, output, "volumes")
    from wavesplat._cli.progress import bar
    from wavesplat._model.interchange import volume_file

    downsampling = levels.downsampling
    is_ome = ".ome." in output.name.lower()
    with warnings_as_notes(quiet=quiet):
        stack = _stack_of(input, reader) if is_ome else _one_of(input, reader)
        if not quiet:
            first: Any = stack.volumes[0][0]
            print_guesses([first])
        if downsampling is None and output.name.lower().endswith(".zarr") and _holds_labels(stack):
            downsampling = "nearest"
            if not quiet:
                message("note: taken for labels, so coarser levels have every second sample; or --downsampling mean")
        with bar("writing", shown=not quiet and is_terminal()) as progress:
            volume_file.save(stack, output, downsampling, progress)
    facts = {
        "file": str(output),
        "input": input,
        "shape": list(stack.grid.shape),
        "n_channels": stack.n_channels,
        "n_times": stack.n_times,
        "dtype": str(stack.dtype),
    }
    print_result(facts, output, as_json=json, written=output)


def _one_of(input: str, reader: ReaderOptions) -> Stack:
    """The volume of an input; an error that says how to choose where it holds several."""
    from wavesplat._model.volume.stack import stacked
    from wavesplat._readers.opening import open as open_volume

    return stacked([[open_volume(input, **vars(reader))]])


def _stack_of(input: str, reader: ReaderOptions) -> Stack:
    """All channels and times of an input, or those that are chosen."""
    from wavesplat._model.volume.stack import stacked

    channels = [_times_of(input, reader, number) for number in _channels_of(input, reader)]
    return stacked(channels, None, channels[0].times, channels[0].time_unit)


def _channels_of(input: str, reader: ReaderOptions) -> list[int | None]:
    from wavesplat._readers.request import SeveralError

    try:
        _ = _times_of(input, reader, reader.channel)[0]
    except SeveralError as several:
        if several.option != "channel":
            raise
        return list(range(len(several.names)))
    return [reader.channel]


def _times_of(input: str, reader: ReaderOptions, channel: int | None) -> Series:
    from wavesplat._readers.time_points import open_series

    options = vars(replace(reader, time=None, channel=channel))
    options.pop("time")
    series = open_series(input, **options)
    return series if reader.time is None else series[reader.time : reader.time + 1 or None]


def _holds_labels(stack: Stack) -> bool:
    """Whether the first volume is a segmentation by its values; of a lazy one, by a box in its middle."""
    from wavesplat._looks.kinds.kinds import kind_of
    from wavesplat._model.lazy.volume import LazyVolume
    from wavesplat._model.volume.volume import Volume

    first: Any = stack.volumes[0][0]
    if stack.n_channels > 1 or not isinstance(first, Volume) or first.dtype.kind not in "iu":
        return False
    if isinstance(first, LazyVolume):
        lower = [max(0, (n - SIDE_OF_BOX) // 2) for n in stack.grid.shape]
        upper = [min(n, start + SIDE_OF_BOX) for n, start in zip(stack.grid.shape, lower, strict=True)]
        first = Volume(stack.read(0, 0, ((lower[0], lower[1], lower[2]), (upper[0], upper[1], upper[2]))))
    return kind_of(first) in ("labels", "mask")
