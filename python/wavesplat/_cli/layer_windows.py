"""A note on a layer whose window lies far below its values, such as one for SUV of a PET in Bq/ml."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["note_on_window"]

#: Least share of the values above a window that is worth a note.
MANY = 0.5
#: Percentiles of a window in its place.
INSTEAD = "90%,99.8%"


def note_on_window(volume: Volume | WaveletVolume, high: float | str | None) -> str | None:
    """Advice on the window of a layer of which most values lie above its end `high`; None for any other one."""
    from wavesplat._looks.histogram import finite_samples
    from wavesplat._looks.kinds import unit_of_values

    if not isinstance(high, float | int):
        return None
    values = finite_samples(volume)
    share = float(np.mean(values > high)) if values.size else 0.0
    if share <= MANY:
        return None
    unit = unit_of_values(volume)
    most = f"{volume.value_range[1]:.6g} {unit}".rstrip()
    instead = "--suv, or " if unit == "Bq/ml" else ""
    return (
        f"{100 * share:.0f} % of the values of layer {volume.name!r} lie above its window, which ends at {high:g}, and "
        f"cover what is below; they reach up to {most}: give {instead}a window such as {INSTEAD}"
    )
