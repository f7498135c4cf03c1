"""Small volumes of every kind of data, for the lines of the oracle (`brain_lines.py`).

Samples come from whole numbers, sums, products, quotients and square roots alone, which are the same on every machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product

import numpy as np

import wavesplat as ws
from wavesplat._model.volume.facts import BLOOD_FLOW, LENGTH
from wavesplat._model.volume.grid import NO_PLACE, UPRIGHT

N = 24
PATIENT = {"unit": "mm", "anatomical": True}
#: A patient's axes turned by an angle of cosine 0.8 and sine 0.6, with different steps, and slices in other orders.
OBLIQUE = [[1.6, -1.2, 0, -20], [1.2, 1.6, 0, 10], [0, 0, 3, 5], [0, 0, 0, 1]]
FLIPPED = [[-2, 0, 0, 30], [0, -2, 0, 40], [0, 0, 2.5, -50], [0, 0, 0, 1]]
CORONAL = [[2, 0, 0, 0], [0, 0, 2, 0], [0, -2, 0, 0], [0, 0, 0, 1]]
SAGITTAL = [[0, 0, 2, 0], [2, 0, 0, 0], [0, -2, 0, 0], [0, 0, 0, 1]]
#: Rows, and levels, that go downwards.
DOWNWARD = [[1, 0, 0, 0], [0, -1, 0, 9], [0, 0, 1, 0], [0, 0, 0, 1]]
SUNKEN = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -2, 0], [0, 0, 0, 1]]
SHEARED = [[2, 0.3, 0, 0], [0, 2, 0.5, 0], [0, 0, 2, 0], [0, 0, 0, 1]]


def grid(shape=(N, N, N)):
    """Places z, y and x from -1 to 1."""
    return np.meshgrid(*((2.0 * np.arange(n) - (n - 1)) / max(n - 1, 1) for n in shape), indexing="ij")


def noise(shape, seed=1):
    """Noise of mean 0 and deviation 1, nearly Gaussian: sums of four even numbers."""
    state = np.arange(4 * int(np.prod(shape)), dtype=np.uint64) + np.uint64(seed * 1_000_003)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1)):
        state = (state ^ (state >> np.uint64(shift))) * np.uint64(factor)
    even = (state >> np.uint64(48)).astype(np.int64).reshape(4, *shape)
    return (even.sum(axis=0) - 131_070) / 37_837.0


def square(z, y, x, at=(0, 0, 0), sides=(1, 1, 1)):
    """Squared distance from a place, in half axes of an ellipsoid."""
    return sum(((a - b) / c) * ((a - b) / c) for a, b, c in zip((z, y, x), at, sides, strict=True))


def bump(*args, **options):
    """A smooth hill of height 1 on 0."""
    rest = np.maximum(0.0, 1.0 - square(*args, **options))
    return rest * rest * rest


def wave(t):
    """A smooth wave of period 2 and of both signs, of parabolas."""
    phase = t - 2.0 * np.floor(0.5 * (t + 1.0))
    return 4.0 * phase * (1.0 - np.abs(phase))


def ct(shape=(N, N, N), *, loud=12.0):
    """A body of fat, soft tissue and bone in air, Hounsfield units."""
    z, y, x = grid(shape)
    values = np.full(shape, -1000.0)
    for side, value in ((0.85, -100.0), (0.72, 45.0)):
        values[square(z, y, x, sides=(2.0, side, side)) < 1] = value
    values[square(z, y, x, (0, 0.35, 0), (2.0, 0.2, 0.2)) < 1] = 650.0
    values[square(z, y, x, (0.1, -0.2, 0.2), (0.3, 0.2, 0.2)) < 1] = 220.0
    return np.rint(values + loud * noise(shape)).clip(-1024)


def head(shape=(N, N, N)):
    """A head with bright skin, brain and dark fluid, in noise."""
    z, y, x = grid(shape)
    values = 8.0 + np.zeros(shape)
    for side, value in ((0.85, 160.0), (0.76, 30.0), (0.7, 105.0), (0.35, 80.0), (0.15, 25.0)):
        values[square(z, y, x, sides=(side, side, 0.9 * side)) < 1] = value
    return np.maximum(0.0, np.rint(values + 5.0 * noise(shape, 2)))


def spots(shape=(N, N, N), *, count=7, size=0.2, height=900.0, loud=6.0, base=100.0):
    """Bright spots over noise."""
    z, y, x = grid(shape)
    values = base + loud * noise(shape, 3)
    for number in range(count):
        at = tuple(((number * step) % 13 - 6) / 8.0 for step in (3, 5, 7))
        values += height * (1 + number % 3) / 3 * bump(z, y, x, at=at, sides=(size,) * 3)
    return values


def uptake(shape=(N, N, N)):
    """Uptake of a tracer: a faint body, a bright bladder."""
    z, y, x = grid(shape)
    values = 0.02 + 0.6 * (square(z, y, x, sides=(1.5, 0.7, 0.7)) < 1) + 14.0 * bump(z, y, x, (-0.4, 0, 0), (0.3,) * 3)
    return np.maximum(0.0, values + 0.04 * noise(shape, 4)).astype(np.float32)


def signed(shape=(N, N, N)):
    """Smooth values of both signs."""
    z, y, x = grid(shape)
    return wave(1.7 * x) * wave(1.3 * y + 0.4) * (1.0 - 0.6 * z * z)


def flame(shape=(N, N, N)):
    """A smooth field without noise, from 0 to 1."""
    z, y, x = grid(shape)
    return 0.6 * bump(z, y, x, (0.1, 0, 0)) + 0.4 * bump(z, y, x, (-0.3, 0.2, 0.1), (0.5, 0.4, 0.4))


def dense(shape=(N, N, N)):
    """Stained tissue: mostly bright, with dark walls, in noise."""
    z, y, x = grid(shape)
    walls = np.abs(wave(2.5 * x + z)) * np.abs(wave(2.1 * y - z)) < 0.15
    return np.clip(np.rint(np.where(walls, 60.0, 175.0) + 14.0 * noise(shape, 5)), 0, 255)


def labelled(shape=(N, N, N)):
    """Four parts, numbered with gaps."""
    z, y, x = grid(shape)
    values = np.zeros(shape)
    for number, at in ((1, (-0.4, -0.4, -0.4)), (3, (0.4, 0.4, 0)), (4, (0, -0.3, 0.5)), (12, (0.4, -0.4, -0.2))):
        values[square(z, y, x, at, (0.35,) * 3) < 1] = number
    return values


def mask(shape=(N, N, N)):
    """A ball."""
    return (square(*grid(shape), sides=(0.5, 0.7, 0.6)) < 1).astype(np.float64)


def share(shape=(N, N, N)):
    """Probabilities of a tissue: 1 inside, 0 outside, a soft border."""
    return np.clip((0.55 - square(*grid(shape), sides=(0.9, 0.9, 0.9))) * 6.0, 0.0, 1.0)


def with_gaps(values, part=0.3):
    """Values of which those outside of a ball are missing."""
    return np.where(square(*grid(values.shape)) < 1 - part, values, np.nan)


def padded(values, fill):
    """Values within a frame of one value."""
    made = np.full_like(values, fill)
    made[3:-3, 4:-4, 5:-5] = values[3:-3, 4:-4, 5:-5]
    return made


def _volume(name, samples, dtype, *, spacing=None, matrix=None, unit=None, anatomical=None, **facts):
    placed = {} if matrix is None else {"world_from_index": np.array(matrix, dtype=np.float64)}
    placed |= {} if spacing is None else {"spacing": spacing}
    kept = ws.Facts(**facts)
    return ws.Volume(samples.astype(dtype), name=name, unit=unit, anatomical=anatomical, facts=kept, **placed)


def _scans() -> Iterator[tuple]:
    yield "ct", ct(), "i2", {**PATIENT, "spacing": (2, 2, 2), "modality": "CT"}
    yield "ct unnamed", ct(), "i2", {**PATIENT, "spacing": (2, 2, 2)}
    yield "ct float", ct() + 0.25, "f4", {**PATIENT, "spacing": (2, 2, 3)}
    yield "ct not of a patient", ct(), "f8", {}
    yield "ct metres", ct(), "i2", {"unit": "m", "spacing": (0.002,) * 3, "anatomical": True, "modality": "CT"}
    yield "ct offset 1000", np.maximum(ct() + 1000, 0), "u2", {**PATIENT, "spacing": (2, 2, 2)}
    yield "ct offset 1024", np.maximum(ct() + 1024, 0), "i2", {**PATIENT, "spacing": (2, 2, 2), "modality": "CT"}
    yield "ct padded", padded(ct(), -2000), "i2", {**PATIENT, "spacing": (2, 2, 2), "modality": "CT"}
    yield "ct few slices", ct((5, 32, 32)), "i2", {**PATIENT, "spacing": (1, 1, 6), "modality": "CT"}
    yield "ct of a window", ct(), "i2", {**PATIENT, "modality": "CT", "window": (-200, 300)}
    for name, matrix in (("oblique", OBLIQUE), ("flipped", FLIPPED), ("coronal", CORONAL), ("sheared", SHEARED)):
        yield f"ct {name}", ct((24, 28, 32)), "i2", {**PATIENT, "matrix": matrix, "modality": "CT"}
    yield "angiography", spots(size=0.15, height=4000), "u2", {**PATIENT, "modality": "XA"}
    for dtype in ("u1", "i2", "u2", "f4", "f8"):
        yield f"mr {dtype}", head(), dtype, {**PATIENT, "spacing": (1, 1, 1.5), "modality": "MR"}
    yield "mr unnamed", head(), "i2", {**PATIENT, "spacing": (1, 1, 1.5)}
    yield "scan u1", head(), "u1", {**PATIENT, "spacing": (1, 1, 1.5)}
    yield "scan of matter", head(), "u1", {}
    yield "mr normalised", (head() - 55) / 47, "f4", {**PATIENT, "matrix": SAGITTAL}
    yield "mr from 0 to 1", head() / 180, "f4", {**PATIENT, "spacing": (1, 1, 1)}
    yield "mr block", head()[7:17, 7:17, 7:17] + 20, "f4", {**PATIENT, "modality": "MR"}
    yield "mr thick slices", head((9, 40, 40)), "i2", {**PATIENT, "spacing": (1, 1, 7), "modality": "MR"}
    yield "mr with a window", head(), "i2", {**PATIENT, "modality": "MR", "window": (10, 120), "is_inverted": True}
    yield "pet", uptake(), "f4", {**PATIENT, "spacing": (4, 4, 4), "modality": "PT", "value_unit": "g/ml"}
    yield "pet unnamed", uptake(), "f4", {**PATIENT, "spacing": (4, 4, 4)}
    yield "body_suv", uptake(), "f8", {**PATIENT, "spacing": (4, 4, 4)}
    yield "dose", 60 * flame(), "f4", {**PATIENT, "spacing": (3, 3, 3), "modality": "RTDOSE", "value_unit": "Gy"}
    yield "ultrasound", np.abs(40 * noise((N, N, N), 7)) + 90 * flame(), "u1", {**PATIENT, "modality": "US"}


def _maps() -> Iterator[tuple]:
    small = {**PATIENT, "spacing": (2, 2, 2)}
    anisotropy = np.abs(0.12 * noise((N, N, N), 8)) * mask() + 0.5 * bump(*grid(), sides=(0.5,) * 3)
    yield "anisotropy fa", anisotropy.clip(0, 0.95), "f4", small
    yield "anisotropy above 1", anisotropy * 1.3, "f4", small
    yield "c1 prob", share(), "f4", small
    yield "shares", share(), "f8", small
    yield "lesion", 0.7 * bump(*grid(), at=(0.2, 0.1, 0), sides=(0.4,) * 3), "f4", small
    yield "fractions of segments", share(), "f4", {**small, "modality": "SEG"}
    yield "diffusion", 0.0007 * mask() + 0.0022 * bump(*grid(), sides=(0.5,) * 3), "f4", small
    yield "t2 map", head(), "f4", small
    yield "flow", head(), "f4", {**small, "quantity": BLOOD_FLOW}
    yield "pvalues", 1 - 0.99 * bump(*grid(), sides=(0.4,) * 3), "f4", small
    yield "p of a mask pvals", mask() * (1 - 0.9 * bump(*grid())), "f4", small
    yield "zstat", 6 * signed() + noise((N, N, N), 9), "f4", small
    yield "zstat of one sign", 3 * flame(), "f4", small


def _microscopy() -> Iterator[tuple]:
    small = {"unit": "um", "spacing": (0.2, 0.2, 0.5)}
    green = ws.Channel("GFP", (0.0, 1.0, 0.0), 509.0)
    blue = ws.Channel("DAPI", (0.0, 0.0, 1.0), 461.0, (100.0, 700.0))
    light = {"modality": "fluorescence", "channels": (green, blue)}
    yield "cells", spots(), "u2", {**small, **light, "channel": green}
    yield "cells of a window", spots(), "u2", {**small, **light, "channel": blue}
    yield "cells unnamed", spots(count=13, size=0.35), "u2", small
    yield "cells of a channel", spots(count=13, size=0.35), "f4", {**small, "channel": ws.Channel("561")}
    yield "beads", spots(count=4, size=0.12), "u2", small
    yield "hot pixels", spots(count=3, size=0.05, height=9000), "u2", {}
    yield "em", dense(), "u1", {"unit": "nm", "spacing": (8, 8, 30), "modality": "EM"}
    yield "em unnamed", dense(), "u1", {"unit": "nm", "spacing": (8, 8, 30)}
    yield "em thin", dense((3, 40, 40)), "u1", {"unit": "nm"}
    yield "flat stack", spots((1, 48, 48)), "u2", small
    yield "two slices", spots((2, 40, 40)), "u2", small
    yield "coarse stack", spots((12, 40, 40)), "u2", {"unit": "um", "spacing": (0.3, 0.3, 4.0)}


def _fields() -> Iterator[tuple]:
    yield "signed", signed(), "f4", {}
    yield "signed f8 with unit", 1e5 * signed(), "f8", {"unit": "m", "value_unit": "Pa", "quantity": "pressure"}
    yield "signed i2", np.rint(900 * signed()), "i2", {}
    yield "signed i1", np.rint(100 * signed()), "i1", {}
    yield "mostly positive", signed() + 0.9, "f4", {}
    yield "nearly one sign", flame() - 1e-7, "f4", {}
    yield "flame u1", np.rint(255 * flame()), "u1", {}
    yield "flame f4", 300 + 1700 * flame(), "f4", {"value_unit": "K", "quantity": "temperature"}
    yield "flame of noise", flame() + 0.05 * noise((N, N, N), 11), "f4", {}
    yield "steep", 1e-9 + flame() * flame() * flame() * 1e6, "f8", {}
    yield "lengths of vectors", np.abs(signed()), "f4", {"processing": (LENGTH,)}
    yield "wide", flame((8, 24, 48)), "f4", {"spacing": (1, 2, 0.5)}
    yield "flat along x", flame((40, 40, 8)), "f4", {}
    yield "flat along z", flame((8, 40, 40)), "f4", {}
    yield "long", flame((48, 12, 12)), "u1", {"spacing": (1, 1, 4)}
    yield "map of the earth", 300 * flame((6, 30, 48)), "f4", {"conventions": (UPRIGHT,), "matrix": DOWNWARD}
    yield "downward map", signed((10, 30, 40)), "f4", {"matrix": SUNKEN, "conventions": (UPRIGHT,)}
    yield "axes without a place", flame(), "f4", {**PATIENT, "conventions": (NO_PLACE,)}
    yield "no data", np.where(flame() < 0.02, -30.0, 40 * flame()), "f4", {"value_unit": "dBZ"}
    yield "with gaps", with_gaps(flame()), "f4", {}
    yield "signed with gaps", with_gaps(signed(), 0.6), "f8", {}
    yield "infinities", np.where(flame() > 0.9, np.inf, flame()), "f4", {}
    yield "i4", np.rint(1e9 * flame()), "i4", {}
    yield "u4", np.rint(4e9 * flame()), "u4", {}
    yield "far from 0", 1e6 + flame(), "f8", {}
    yield "tiny", 1e-30 * flame(), "f4", {}
    yield "large", 1e300 * signed(), "f8", {}


def _segmentations() -> Iterator[tuple]:
    for dtype in ("u1", "i2", "u4", "f4"):
        yield f"labels {dtype}", labelled(), dtype, {}
    yield "labels of a patient", labelled(), "u1", {**PATIENT, "matrix": FLIPPED, "modality": "SEG"}
    yield "labels with unit", labelled(), "f4", {"value_unit": "K"}
    yield "mask u1", mask(), "u1", {}
    yield "mask f4", 7 * mask() - 3, "f4", {}
    yield "mask of a patient", mask(), "u1", {**PATIENT, "matrix": OBLIQUE}
    yield "mask with gaps", with_gaps(mask()), "f4", {}


def _limits() -> Iterator[tuple]:
    yield "one value", np.full((6, 7, 8), 5.0), "u1", {}
    yield "all missing", np.full((6, 7, 8), np.nan), "f4", {}
    yield "one sample", np.full((1, 1, 1), 3.0), "f4", {}
    yield "one bright sample", (square(*grid((9, 9, 9))) == 0) * 40.0, "f4", {}
    yield "noise", noise((N, N, N), 12), "f4", {}
    yield "noise u1", np.clip(128 + 30 * noise((N, N, N), 13), 0, 255), "u1", {}
    yield "single row", flame((1, 1, 40)), "f4", {}
    yield "little contrast", 1000 + np.rint(flame()), "i2", {}
    yield "too far apart", np.where(mask() > 0, 1.7e308, -1.7e308), "f8", {}


def phantoms() -> dict[str, Callable[[], ws.Volume]]:
    """The function that makes each phantom, by name."""
    makers = (_scans, _maps, _microscopy, _fields, _segmentations, _limits)
    made = {
        name: partial(_volume, name, samples, dtype, **facts)
        for maker in makers
        for name, samples, dtype, facts in maker()
    }
    first = made["flame f4"]
    made["not in memory"] = lambda: ws.Volume.lazy(first().samples, name="not in memory")
    made["ripples"] = lambda: ws.examples.ripples(24)
    for number, (flip, axes) in enumerate(product((1, -1), ((0, 1, 2), (2, 0, 1)))):
        samples = np.ascontiguousarray(signed((12, 16, 20))[::flip].transpose(axes))
        made[f"stored otherwise {number}"] = partial(_volume, f"stored otherwise {number}", samples, "f4")
    return made
