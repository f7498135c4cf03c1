"""Options of sampling: kernel, quality, threads and device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.shared_options import Device, Kernel, Threads
from wavesplat._model.options import Quality

__all__ = ["SamplingOptions", "drawing_arguments", "takes_sampling_options"]


@dataclass(frozen=True)
class SamplingOptions:
    """Kernel, quality, threads and device. Without a quality, what is drawn has its own: "normal" for pictures."""

    kernel: Kernel = "linear"
    quality: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(get_args(Quality)),
            help=f"{', '.join(get_args(Quality))}. Normal if not given; of movies between draft and normal.",
        ),
    ] = None
    sheets_per_slice: Annotated[float | None, typer.Option(metavar="N", help="Instead of what the quality says.")] = (
        None
    )
    oversampling: Annotated[float | None, typer.Option(metavar="N", help="Instead of what the quality says.")] = None
    psnr: Annotated[
        float | None, typer.Option(metavar="DB", help="Choose both for this PSNR against the converged picture.")
    ] = None
    threads: Threads = None
    device: Device = "auto"


def takes_sampling_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `sampling`."""
    return with_options_of(SamplingOptions, "sampling", command)


def drawing_arguments(sampling: SamplingOptions) -> dict[str, Any]:
    """The options as arguments of `Scene.render`."""
    from wavesplat._model.sampling import Sampling

    return {
        "kernel": sampling.kernel,
        "quality": Sampling(sampling.sheets_per_slice, sampling.oversampling, sampling.quality or "normal"),
        "psnr": sampling.psnr,
        "threads": sampling.threads,
        "device": sampling.device,
    }
