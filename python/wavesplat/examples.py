"""Volumes to try things on: two small real scans that come with the package, and a formula.

Source, licence and citation of the scans lie beside them, in `wavesplat/data`.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import as_file, files

import numpy as np

from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume.volume import Volume
from wavesplat._readers.opening import open as open_volume
from wavesplat._system.memory import check_room
from wavesplat.errors import ArgumentError

__all__ = ["ct_pelvis", "mri_head", "ripples"]

#: Most bytes per sample of the test signal while it is made: its arrays in float64, by tracemalloc.
BYTES_A_SAMPLE = 52


def mri_head() -> Volume:
    """T1-weighted MRI of a human head (face removed), 1.5 mm, uint8, shape (171, 171, 128), public domain.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.examples.mri_head().shape
    (171, 171, 128)
    """
    return _bundled("mri_head", "MR")


def ct_pelvis() -> Volume:
    """CT of a human abdomen and pelvis, Hounsfield units, 3 mm, int16, shape (112, 101, 122), Apache-2.0.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.examples.ct_pelvis().spacing
    (3.0, 3.0, 3.0)
    """
    return _bundled("ct_pelvis", "CT")


@takes_its_types
def ripples(n: int = 32) -> Volume:
    """The test signal of Marschner and Lobb, scaled to 0..255, float32, shape (n, n, n), spacing 1.

    With f_M = 6, alpha = 0.25 and r^2 = x^2 + y^2 on [-1, 1]^3:
    rho = (1 - sin(pi z / 2) + alpha (1 + cos(2 pi f_M cos(pi r / 2)))) / (2 (1 + alpha)).
    Its frequencies come close to the sampling limit at n = 40, which shows what a kernel loses.

    Parameters
    ----------
    n : int, default 32
        Samples along each axis, 2 or more.

    Raises
    ------
    ArgumentError
        If `n` is below 2.
    LimitError
        If the samples do not fit into memory.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.examples.ripples(16).samples.shape
    (16, 16, 16)

    Notes
    -----
    S. R. Marschner and R. J. Lobb, An evaluation of reconstruction filters for volume rendering,
    IEEE Visualization 1994.
    """
    if n < 2:
        raise ArgumentError(f"n is {n}; the signal needs at least 2 samples along each axis")
    f_m, alpha = 6.0, 0.25
    check_room(BYTES_A_SAMPLE * int(n) ** 3, f"the samples of a test signal, {n} along each axis,", "give a smaller n")
    axis = np.linspace(-1.0, 1.0, n)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    wave = np.cos(2 * np.pi * f_m * np.cos(np.pi * np.hypot(x, y) / 2))
    rho = (1 - np.sin(np.pi * z / 2) + alpha * (1 + wave)) / (2 * (1 + alpha))
    made = Volume((255 * rho).astype(np.float32), name=f"ripples({n})")
    made._source = {"example": "ripples", "n": int(n)}
    return made


def _bundled(name: str, modality: str) -> Volume:
    with as_file(files("wavesplat") / "data" / name / f"{name}.nii.gz") as path:
        volume = open_volume(path)
    facts = replace(volume.facts, modality=modality)
    example = Volume(volume.samples, world_from_index=volume.world_from_index, name=volume.name, facts=facts)
    example._source = {"example": name}
    return example
