"""`wavesplat info`: arrays, labels, regions, images and wells in a file, and facts of its volume."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wavesplat._cli.options.groups import Input, Json
from wavesplat._cli.options.reader import ReaderOptions, open_any, open_samples
from wavesplat._cli.printing import print_result
from wavesplat._cli.several_inputs import takes_several_inputs

if TYPE_CHECKING:
    from wavesplat._cli import describe
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Budget of volumes of which only a small level is read.
MEMORY = "1 GB"


@takes_several_inputs()
def info(input: Input, *, reader: ReaderOptions, json: Json = False) -> None:
    """Say what a file holds: what there is to choose, and size, spacing, unit, orientation, values of a volume."""
    from wavesplat._cli import describe, describe_contents
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

    if (regions := describe_contents.regions_of(input)) is not None:
        print_result(regions, "\n".join(describe_contents.region_lines(regions)), as_json=json)
        return
    arrays = describe_contents.arrays_in(input, reader)
    choices, volume, problem = _first(input, reader, [], has_arrays=bool(arrays))
    facts: dict[str, Any] = {"choices": [choice.facts() for choice in choices], **arrays}
    facts |= describe_contents.images_in(input, reader)
    text = describe_contents.array_lines(facts) + [line for choice in choices for line in choice.lines()]
    text += describe_contents.image_lines(facts)
    if problem is not None:
        facts["problem"] = problem
        text.append(f"not shown    {problem}")
    if volume is None:
        pass
    elif isinstance(volume, WaveletVolume):
        facts |= describe.describe_wavelets(volume)
        text += describe.wavelet_lines(facts)
    else:
        facts |= describe.describe(volume, of_coarsest=reader.memory is None)
        facts["labels"] = _labels_of(input, volume, reader.dataset) if reader.channel is None else []
        text += [*describe.lines(facts), *describe_contents.label_lines(facts["labels"])]
    print_result(facts, "\n".join(text), as_json=json)


def _labels_of(input: str, volume: Volume, dataset: str | None) -> list[dict[str, Any]]:
    """The labels of a segmentation; empty for scans. Label names are read from files, not from addresses."""
    from wavesplat._cli import describe_contents
    from wavesplat._looks.labels import label_names
    from wavesplat._storage.addresses import is_address

    if volume.modality not in (None, "SEG"):
        return []
    return describe_contents.counted(volume, {} if is_address(input) else label_names.in_file(input, dataset))


def _first(
    input: str, reader: ReaderOptions, choices: list[describe.Choice], *, has_arrays: bool
) -> tuple[list[describe.Choice], Volume | WaveletVolume | None, str | None]:
    """The choices that a file leaves open, and the volume that their first values name.

    It is None if it cannot be read; a file whose arrays are listed (`has_arrays`) may hold none, for a reason.
    """
    from wavesplat._cli.describe import Choice
    from wavesplat._readers.request import SeveralError
    from wavesplat.errors import FileError

    try:
        return choices, _opened(input, reader), None
    except SeveralError as several:
        if not several.names or several.option in [choice.option for choice in choices]:
            raise
        first: dict[str, Any] = {several.option: several.names[0]}
        choice = Choice(several.option, several.names, several.described)
        return _first(input, replace(reader, **first), [*choices, choice], has_arrays=has_arrays)
    except FileError as error:
        # The first of several may be unreadable where another one is not: its error is reported with the choice.
        if choices:
            return [*choices[:-1], replace(choices[-1], problem=str(error))], None, None
        if has_arrays:
            return [], None, str(error)
        raise


def _opened(input: str, reader: ReaderOptions) -> Volume | WaveletVolume:
    """The volume; of a Zarr image on a server, or of a large pyramid in a folder, no samples are read yet."""
    from wavesplat._cli import describe
    from wavesplat._readers.opening import is_zarr
    from wavesplat._readers.request import PictureError, taking_planes
    from wavesplat._storage.addresses import is_address

    if reader.memory is None and reader.level is None and is_zarr(input, **vars(reader)):
        lazy = open_samples(input, replace(reader, memory=MEMORY, cache=False), quiet=True)
        if is_address(input) or describe.is_large_pyramid(lazy):
            return lazy
    try:
        return open_any(input, reader, quiet=True)
    except PictureError:  # single pictures and films have facts to list too
        if is_zarr(input, **vars(reader)):
            raise
        with taking_planes():
            return open_any(input, reader, quiet=True)
