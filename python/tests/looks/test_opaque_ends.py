"""Where values pass a curve that ends in opacity 1 within a slab, the colour is that of the opaque end."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

#: Opacity rises to 1 at 31, far below the largest value; at 354 in the mirrored field, far above the least.
RAMPS = {
    "up": (lambda field: field, (0, 31), [0.0, 1.0]),
    "down": (lambda field: 385 - field, (354, 385), [1.0, 0.0]),
}


def field_of(sharp):
    """A plate of 385 in a field of 0.5, 32^3 samples, met along y; its sides are one sample wide."""
    y = np.arange(32)[None, :, None] * np.ones((32, 1, 32))
    plate = np.abs(y - 16) < 3 if sharp else np.clip(4 - np.abs(y - 16), 0, 1)
    return (384.5 * plate + 0.5).astype(np.float32)


@pytest.mark.parametrize("ramp", RAMPS)
@pytest.mark.parametrize("sharp", [True, False])
@pytest.mark.parametrize("view", ["front", "back"])
@pytest.mark.parametrize("quality", ["draft", "normal", "high"])
def test_the_color_is_that_of_the_opaque_end(ramp, sharp, view, quality):
    turned, clim, opacity = RAMPS[ramp]
    volume = ws.Volume(turned(field_of(sharp)))
    function = ws.TransferFunction.from_colormap("turbo", clim=clim, opacity=opacity)
    look = ws.Look(transfer_function=function, shading=None)
    own = ws.render(volume, look, view, size=(24, 24), quality=quality).rgba[12, 12]
    right = ws.reference.raycast(volume, function, view, size=(24, 24), shading=None).rgba[12, 12]
    # It was up to 0.67 off: (0.12, 0.72, 0.67) for (0.44, 0.06, 0.09).
    np.testing.assert_allclose(own, right, atol=0.04)


@pytest.mark.parametrize("ramp", RAMPS)
@pytest.mark.parametrize("sharp", [True, False])
@pytest.mark.parametrize("quality", ["draft", "normal", "high"])
def test_layers_have_that_color_too(ramp, sharp, quality):
    turned, clim, opacity = RAMPS[ramp]
    volume = ws.Volume(turned(field_of(sharp)))
    function = ws.TransferFunction.from_colormap("turbo", clim=clim, opacity=opacity)
    other = np.zeros((32, 32, 32), np.float32)
    other[:4, :, :4] = 1
    layers = [
        ws.Layer(volume, ws.Look(transfer_function=function, shading=None)),
        ws.Layer(
            ws.Volume(other),
            ws.Look(transfer_function=ws.TransferFunction([(0, 0.0), (1, 0.5)], [(0, 1, 1, 1)]), shading=None),
        ),
    ]
    own = ws.Scene(layers).render("front", size=(24, 24), quality=quality).rgba[12, 12]
    right = ws.reference.raycast(volume, function, "front", size=(24, 24), shading=None).rgba[12, 12]
    np.testing.assert_allclose(own, right, atol=0.04)
