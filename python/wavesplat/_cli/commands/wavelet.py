"""`wavesplat wavelet`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from wavesplat._cli.options.groups import Input, Json, Quiet, family, option, output, threshold
from wavesplat._cli.options.reader import ProcessingOptions, ReaderOptions, processed_samples
from wavesplat._cli.printing import check_outputs, print_result
from wavesplat._cli.several_inputs import takes_several_inputs


@dataclass(repr=False)
class CoefficientOptions:
    """The wavelets, and the coefficients that are kept: arguments of `WaveletVolume.from_volume`."""

    family: str = family()
    threshold: float | None = threshold()
    keep: float | None = option("SHARE", "Keep this share of the coefficients, 0..1.")
    psnr: float | None = option("DB", "Keep as few as give samples of this PSNR.")
    levels: int | None = option("N", "Levels of details; all if not given.")
    normalisation: Any = option(help="What amplitudes are measured by: l2, peak.", default="l2", choices=("l2", "peak"))


@takes_several_inputs(".wavelets")
def wavelet(
    input: Input,
    *,
    output: Annotated[Path | None, output("File to write: .wavelets.")] = None,
    coefficients: CoefficientOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Analyse a volume, drop small wavelet coefficients, say what is left, and keep it in a file."""
    if output is not None:
        check_outputs(input, output, "wavelet coefficients")
    from wavesplat._cli import describe
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

    volume = processed_samples(input, reader, processing, quiet=quiet)
    wavelets = WaveletVolume.from_volume(volume, **vars(coefficients))
    facts = describe.describe_wavelets(wavelets, volume)
    text = describe.wavelet_lines(facts)
    if output is not None:
        wavelets.save(output)
        facts |= {"file": str(output), "n_bytes_of_file": output.stat().st_size}
        text.append(f"file         {output}, {facts['n_bytes_of_file'] / 2**20:.3g} MiB")
    print_result(facts, "\n".join(text), as_json=json, written=output)
