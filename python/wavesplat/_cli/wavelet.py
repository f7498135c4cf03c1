"""`wavesplat wavelet`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.parsers import one_of
from wavesplat._cli.printing import print_result
from wavesplat._cli.processing_options import ProcessingOptions, processed_samples, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Family, Json, Quiet, Threshold

__all__ = ["wavelet"]


@takes_several_inputs(".wavelets")
@takes_reader_options
@takes_processing_options
def wavelet(
    input: Input,
    *,
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
        typer.Option(metavar="NAME", parser=one_of(("l2", "peak")), help="What amplitudes are measured by: l2, peak."),
    ] = "l2",
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Analyse a volume, drop small wavelet coefficients, say what is left, and keep it in a file."""
    if output is not None:
        check_outputs(input, output, "wavelet coefficients")
    from wavesplat._cli import describe
    from wavesplat._model.wavelet_volume import WaveletVolume

    volume = processed_samples(input, reader, processing, quiet=quiet)
    wavelets = WaveletVolume.from_volume(
        volume, family, threshold=threshold, keep=keep, psnr=psnr, levels=levels, normalisation=normalisation
    )
    facts = describe.describe_wavelets(wavelets, volume)
    text = describe.wavelet_lines(facts)
    if output is not None:
        wavelets.save(output)
        facts |= {"file": str(output), "n_bytes_of_file": output.stat().st_size}
        text.append(f"file         {output}, {facts['n_bytes_of_file'] / 2**20:.3g} MiB")
    print_result(facts, "\n".join(text), as_json=json, written=output)
