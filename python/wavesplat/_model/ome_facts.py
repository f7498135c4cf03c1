"""Facts of volumes as OME files hold them, and those that such a file has no place for."""

from __future__ import annotations

from os import PathLike

import numpy as np

from wavesplat._files.notes import warn
from wavesplat._model.stack import Stack

#: Part of the spacing by which an axis may lean and still count as one of the world's.
TOLERANCE = 1e-6


def steps_of(stack: Stack) -> tuple[float, float, float] | None:
    """Signed steps along x, y and z where these are the world's axes; None for a grid that is turned."""
    matrix = stack.grid.world_from_index[:3, :3]
    x, y, z = (float(step) for step in np.diag(matrix))
    off = np.abs(matrix - np.diag((x, y, z))).max(axis=0)
    return None if (off > TOLERANCE * np.array(stack.grid.spacing)).any() else (x, y, z)


def hex_of(color: tuple[float, float, float]) -> str:
    """A colour as RRGGBB."""
    return "".join(f"{round(255 * share):02X}" for share in color)


def _lost_times(stack: Stack, *, is_zarr: bool) -> list[str]:
    """Names of the lost facts of times: without a unit all but their order, and in Zarr where they begin."""
    if stack.n_times == 1 or stack.times == tuple(range(stack.n_times)):
        return []
    if stack.time_unit is None:
        return ["its times, which have no unit"]
    if is_zarr and stack.time_step is None:
        return ["its times, which are not evenly spaced"]
    return ["when its times begin"] if stack.times[0] != 0 and stack.time_step is not None else []


def warn_of_lost(stack: Stack, path: str | PathLike[str], *, is_zarr: bool) -> None:
    """Warn of facts that the file cannot hold."""
    steps, facts = steps_of(stack), stack.facts
    lost = [] if steps is not None else ["how its axes are turned", *(["its place"] if is_zarr else [])]
    if not is_zarr:
        lost += ["which axes are mirrored"] if steps is not None and min(steps) < 0 else []
        lost += ["its place"] if np.abs(stack.grid.world_from_index[:3, 3]).max() > 0 else []
    lost += ["that its axes are a patient's"] if facts.is_anatomical else []
    lost += [f"the modality ({facts.modality})"] if facts.modality not in (None, "fluorescence") else []
    lost += [f"the unit of its values ({facts.value_unit})"] if facts.value_unit is not None else []
    lost += _lost_times(stack, is_zarr=is_zarr)
    if lost:
        kind = "OME-Zarr" if is_zarr else "OME-TIFF"
        warn(
            f"{kind} has no place for some facts of volume {stack.grid.name!r}: {', '.join(lost)}; .nrrd keeps those "
            f"of single volumes: {path}",
            stacklevel=5,
        )
