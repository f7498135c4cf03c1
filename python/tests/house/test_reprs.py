"""The reprs of the public types: one line that distinguishes them, whatever they hold."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

LABELS = ws.Labels(np.arange(60, dtype=np.uint8).reshape(3, 4, 5), {1: ws.Label("#ff0000", name="liver")})
TF = ws.TransferFunction([(0, 0), (100, 0.5)], [(-10, 1, 1, 1)])
SHORT = {
    "Labels": (LABELS, "<Labels: z 3, y 4, x 5, 59 labels: 1 'liver', 2, 3, 4, 5, 6, ...>"),
    "no labels": (ws.Labels(np.zeros((3, 4, 5), np.uint8)), "<Labels: z 3, y 4, x 5, 0 labels: none>"),
    "TransferFunction": (TF, "<TransferFunction: values -10 to 100, 2 nodes of opacity up to 0.5, 1 of colour>"),
    "its unit": (
        ws.TransferFunction([(0, 0), (9, 1)], [(0, 1, 1, 1)], 2, [(0, 0), (5, 1)]),
        "<TransferFunction: values 0 to 9, 2 nodes of opacity up to 1, 1 of colour, per 2, by the gradient too>",
    ),
    "TransferFunction2D": (
        ws.TransferFunction2D([0, 1], [0, 5], np.ones((2, 2, 4))),
        "<TransferFunction2D: 2 values 0 to 1, 2 magnitudes 0 to 5>",
    ),
    "Look": (
        ws.Look(transfer_function=TF, shading=None, view="left", name="mine"),
        f"<Look 'mine': over, no shading, left, {TF!r}>",
    ),
    "Materials": (ws.Materials.preset("ct"), "<Materials: air, fat, soft tissue, bone>"),
    "Facts": (ws.Facts(unit="mm", is_anatomical=True), "Facts(unit='mm', is_anatomical=True)"),
    "Shading": (ws.Shading(ambient=0.5), "Shading(ambient=0.5)"),
}


@pytest.mark.parametrize("kind", SHORT)
def test_short(kind):
    thing, text = SHORT[kind]
    assert repr(thing) == text


@pytest.mark.parametrize("thing", [ws.Facts(unit="um", guesses=["a", "b"]), ws.Shading(lights=[ws.Light((0, 0, 1))])])
def test_what_is_a_call_makes_the_same_again(thing):
    names = {"Facts": ws.Facts, "Shading": ws.Shading, "Light": ws.Light}
    assert eval(repr(thing), names) == thing  # noqa: S307 - our own text
