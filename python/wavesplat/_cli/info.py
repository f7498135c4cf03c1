"""`wavesplat info`."""

from __future__ import annotations

from wavesplat._cli.printing import print_result
from wavesplat._cli.reader_options import Input, ReaderOptions, open_any, takes_reader_options
from wavesplat._cli.shared_options import Json

__all__ = ["info"]


@takes_reader_options
def info(input: Input, *, reader: ReaderOptions, json: Json = False) -> None:
    """Say what a volume holds: size, spacing, type, orientation, values."""
    from wavesplat._cli import describe
    from wavesplat._model.wavelet_volume import WaveletVolume

    volume = open_any(input, reader)
    if isinstance(volume, WaveletVolume):
        facts = describe.describe_wavelets(volume)
        text = describe.wavelet_lines(facts)
    else:
        facts = describe.describe(volume)
        text = describe.lines(facts)
    print_result(facts, "\n".join(text), as_json=json)
