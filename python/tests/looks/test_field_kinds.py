"""Forty made fields, and the kind, colours, scale, window and centre that each gets by itself (simulation, 8.1, 8.13).

Windows are percentiles of the samples: of the values, or of their sizes where both signs are shown alike.
"""

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat._looks.curves.colormaps import colors_of
from wavesplat._looks.kinds.kinds import kind_of, unit_of_values
from wavesplat._picture.color_bar import scale_of

N = 40
G = np.linspace(-1, 1, N)
Z, Y, X = np.meshgrid(G, G, G, indexing="ij")
R = np.sqrt(X * X + Y * Y + Z * Z)
PATIENT = ws.Facts(unit="mm", is_anatomical=True)
ANGSTROM = ws.Facts(unit="angstrom")


def smooth(seed, width=2.5):
    """Normal noise of deviation 1 without details finer than some samples."""
    k = np.fft.fftfreq(N)
    square = k[:, None, None] ** 2 + k[:, None] ** 2 + k**2
    spectrum = np.fft.fftn(np.random.default_rng(seed).normal(size=(N, N, N)))
    made = np.fft.ifftn(spectrum * np.exp(-2 * (np.pi * width) ** 2 * square)).real
    return made / made.std()


def noise(seed, *shape):
    return np.random.default_rng(seed).normal(size=shape or (N, N, N))


def bytes_of(field):
    return np.round(255 * (field - field.min()) / np.ptp(field)).astype(np.uint8)


def rounded(field):
    return np.round(field).astype(np.int16)


def outside_missing(field):
    return np.where(R > 0.95, np.nan, field)


SMOOTH, OTHER = smooth(1), smooth(2)
WAVES = np.sin(5 * X) * np.cos(4 * Y) * np.exp(-2 * Z * Z)
VORTEX = np.exp(-((X - 0.2 * np.sin(4 * Z)) ** 2 + Y * Y) / 0.02)
BLOB = np.exp(-6 * R * R)
BZ = BLOB - 0.23 * np.exp(-40 * ((X - 0.8) ** 2 + Y * Y + Z * Z))
ORBITAL = X * Y * np.exp(-7 * R)
SCAN = (120 * (R < 0.6) + np.abs(9 * noise(6))).astype(np.uint8)
#: Shares of a liquid: a half of the box with waves, and a drop of 1 % of it.
SURFACE = 0.5 - 0.5 * np.tanh(20 * (Z + 0.1 * np.sin(4 * X)))
DROP = 0.5 - 0.5 * np.tanh(20 * (R - 0.27))
DROPS = 1 - np.prod(
    [
        0.5 + 0.5 * np.tanh(20 * (np.sqrt((X - x) ** 2 + (Y - y) ** 2 + (Z - z) ** 2) - 0.33))
        for x, y, z in ((-0.5, 0, 0.4), (0.5, 0.3, 0.3), (0.1, -0.4, -0.5), (0.5, 0.5, -0.5))
    ],
    axis=0,
)
CELLS = 1 + (X > 0) + 2 * (Y > 0.2) + 4 * (Z > -0.3)

SIGNED, FIELD = "signed field", "field"
#: Name -> samples, facts, kind, colours, scale, percentiles of the window (None where the kind has another look).
TABLE = {
    # Both signs.
    "waves": (WAVES, None, SIGNED, "signs", "linear", 99.5),
    "velocity": (9e6 * SMOOTH, None, SIGNED, "signs", "linear", 99.5),
    "velocity of a wind": (9 * SMOOTH - 4, None, SIGNED, "signs", "linear", 99.5),
    "vorticity": (1500 * SMOOTH, None, SIGNED, "signs", "linear", 99.5),
    "seismic": (2000 * np.sin(30 * Z) * np.exp(-X * X), None, SIGNED, "signs", "linear", 99.5),
    "whole seismic": (rounded(2000 * np.sin(12 * Z) * np.exp(-X * X)), None, SIGNED, "signs", "linear", 99.5),
    "potential": (1200 * np.cos(6 * X), None, SIGNED, "signs", "linear", 99.5),
    "noise": (700 * noise(3), None, SIGNED, "signs", "linear", 99.5),
    "whole noise": (rounded(700 * noise(3)), None, SIGNED, "signs", "linear", 99.5),
    "magnetic field": (BZ, None, SIGNED, "signs", "linear", 99.5),
    "signed distance": (R - 0.6, None, SIGNED, "signs", "linear", 99.5),
    "orbital": (ORBITAL, ANGSTROM, SIGNED, "signs", None, 99.5),
    "difference of charges": (1e-3 * SMOOTH * BLOB, ANGSTROM, SIGNED, "signs", None, 99.5),
    "laser in a plasma": (1e12 * np.sin(25 * X) * BLOB, ws.Facts(unit="um"), SIGNED, "signs", None, 99.5),
    "temperature in Celsius": (6 * SMOOTH + 3, None, SIGNED, "signs", "linear", 99.5),
    "tiny signed": (1e-14 * WAVES, None, SIGNED, "signs", "linear", 99.5),
    "huge signed": (1e30 * WAVES, None, SIGNED, "signs", "linear", 99.5),
    "signed, missing outside": (outside_missing(SMOOTH), None, SIGNED, "signs", "linear", 99.5),
    "signed, of NRRD": (SMOOTH, PATIENT, SIGNED, "signs", "linear", 99.5),
    "heavy tails of both signs": (np.sinh(3 * SMOOTH), None, SIGNED, "signs", "symlog", 99.5),
    "Cauchy's tails": (noise(4) / noise(5), None, SIGNED, "signs", "symlog", 99.5),
    # One sign.
    "speed": (np.hypot(SMOOTH, OTHER), None, FIELD, "map", "linear", (1, 99)),
    "density, log-normal": (np.exp(1.5 * SMOOTH), None, FIELD, "map", "log", (5, 99.9)),
    "density of galaxies": (np.exp(3 * SMOOTH), None, FIELD, "map", "log", None),
    "density with voids": (np.where(SMOOTH < -0.5, 0, np.exp(2 * SMOOTH)), None, FIELD, "map", "log", None),
    "density of an orbital": (ORBITAL**2, ANGSTROM, FIELD, "map", "log", None),
    "density with undershoots": (np.exp(2 * SMOOTH) - 0.01, None, FIELD, "map", "log", None),
    "temperature in kelvin": (2e4 * np.exp(1.3 * SMOOTH), None, FIELD, "map", "log", (5, 99.9)),
    "pressure with offset": (101_325 + 300 * BLOB * np.sign(X), None, FIELD, "map", "linear", (1, 99)),
    "pressure in vortices": (1000 - 40 * VORTEX, None, FIELD, "reversed", "linear", (1, 99)),
    "stratified": (1025 + Z + 0.05 * SMOOTH, None, FIELD, "map", "linear", (1, 99)),
    "distance": (R, None, FIELD, "map", "linear", (1, 99)),
    "tiny": (1e-12 * (2 + SMOOTH.clip(-1.9)), None, FIELD, "map", "linear", (1, 99)),
    "narrow": (1 + 1e-4 * np.hypot(SMOOTH, OTHER), None, FIELD, "map", "linear", (1, 99)),
    "missing outside": (outside_missing(np.hypot(SMOOTH, OTHER)), None, FIELD, "map", "linear", (1, 99)),
    "fraction of a phase": (0.5 + 0.5 * np.tanh(3 * SMOOTH), None, FIELD, "map", "linear", (1, 99)),
    "bytes of a fuel": (bytes_of(BLOB), None, FIELD, "map", "linear", (1, 99)),
    "bytes of NRRD": (bytes_of(VORTEX + 0.2 * BLOB), PATIENT, FIELD, "map", "linear", (1, 99)),
    "two bytes of a distance": (np.round(1000 * R).astype(np.uint16), None, FIELD, "map", "linear", (1, 99)),
    # Phases, of which many samples have the largest value.
    "share of water": (SURFACE, None, FIELD, "map", "linear", (1, 99)),
    "density of water in air": (1.2 + 997 * SURFACE, None, FIELD, "map", "linear", (1, 99)),
    "drop in air": (1.2 + 997 * DROP, None, FIELD, "map", "linear", (1, 99.9)),
    "drops of a tenth": (DROPS, None, FIELD, "map", "linear", (1, 99)),
    "pores": ((SMOOTH < 0.4) * (1 + 0.01 * OTHER), None, FIELD, "reversed", "linear", None),
    # No fields.
    "labels": (CELLS.astype(np.int32), None, "labels", None, None, None),
    "mask of a phase": ((SMOOTH > 1).astype(np.float32), None, "mask", None, None, None),
    "bytes of a scan": (SCAN, None, "scan", None, None, None),
    "bytes of a patient": (SCAN, PATIENT, "scan", None, None, None),
}


def made(name):
    samples, facts, *_ = TABLE[name]
    samples = samples.astype(np.float32) if samples.dtype == np.float64 else samples
    # As a header without a place has it: the origin is at the first sample.
    return ws.Volume(samples, facts=facts or ws.Facts())


def test_there_are_forty():
    assert len(TABLE) >= 40


@pytest.mark.parametrize("name", TABLE)
def test_each_field_gets_its_kind_colours_scale_window_and_centre(name):
    samples, _, kind, colors, scale, window = TABLE[name]
    volume = made(name)
    assert kind_of(volume) == kind
    assert unit_of_values(volume) == ""
    if colors is None:
        return
    function = ws.Look.auto(volume).transfer_function
    values = np.array([value for value, *_ in function.color])
    rgb = np.array([rgb for _, *rgb in function.color])
    finite = samples[np.isfinite(samples)]
    if colors == "signs":
        assert values[0] == -values[-1]
        red, green, blue = function([0.0])[0, :3]
        assert red == green == blue, "zero has no hue"
        assert function([0.0])[0, 3] == 0
        assert rgb[0, 2] > rgb[0, 0] + 0.5, "blue is below zero"
        assert rgb[-1, 0] > rgb[-1, 2] + 0.5, "red is above zero"
        assert values[-1] == pytest.approx(np.percentile(np.abs(finite), window), rel=0.1)
    else:
        places, table = colors_of("inferno")
        wanted = np.stack([np.interp(np.linspace(0.4, 1, len(rgb)), places, table[:, c]) for c in range(3)], axis=1)
        np.testing.assert_allclose(rgb, wanted[::-1] if colors == "reversed" else wanted, atol=1e-6)
        if window is not None:
            np.testing.assert_allclose(
                values[[0, -1]], np.percentile(finite, window), rtol=0.1, atol=0.01 * np.ptp(finite)
            )
    bar = scale_of(function, "over", "", (1.0, 1.0, 1.0))
    found = "symlog" if bar.linear else "log" if bar.is_log else "linear"
    assert scale in (None, found)


@pytest.mark.parametrize("background", ["black", "white"])
@pytest.mark.parametrize("name", [name for name, row in TABLE.items() if row[3] is not None])
def test_each_field_is_seen_and_seen_through(name, background):
    picture = ws.render(made(name), size=(64, 64), background="transparent")
    alpha = picture.rgba[..., 3]
    assert (alpha > 0.3).mean() > 0.005, "something is there"
    # A box of bricks would be opaque in over half of the picture; sheets across it are not.
    assert (alpha > 0.9).mean() < 0.45, "no wall"
    behind = {"black": 0.0, "white": 1.0}[background]
    seen = picture.rgba[..., :3] + (1 - alpha[..., None]) * behind
    contrast = np.abs(seen - behind).max(axis=2)
    assert np.percentile(contrast[alpha > 0.3], 50) > 0.2
    if TABLE[name][3] == "signs":
        for sign in (1, -1):
            hue = sign * (picture.rgba[..., 0] - picture.rgba[..., 2])
            assert (hue > 0.1).mean() > 0.001, "both signs are there"


@pytest.mark.parametrize(
    "name", ["velocity of a wind", "heavy tails of both signs", "density, log-normal", "pressure in vortices"]
)
def test_another_map_changes_the_colours_alone(name):
    volume = made(name)
    own, other = ws.Look.auto(volume), ws.Look.auto(volume, colormap="coolwarm")
    assert other.transfer_function.opacity == own.transfer_function.opacity
    assert other.shading == own.shading
    values = [value for value, *_ in own.transfer_function.color]
    places, table = colors_of("coolwarm")
    at = np.linspace(0, 1, len(values))
    wanted = [
        (value, *(np.interp(place, places, table[:, c]) for c in range(3)))
        for value, place in zip(values, at, strict=True)
    ]
    np.testing.assert_allclose(other.transfer_function.color, wanted, atol=1e-6)
    if TABLE[name][2] == SIGNED:
        assert values[len(values) // 2] == 0, "the middle of a diverging map is at 0"


def test_infinite_samples_side_by_side_are_left_out_without_a_warning():
    samples = np.where(R < 0.3, np.inf, SMOOTH).astype(np.float32)
    assert kind_of(ws.Volume(samples)) == SIGNED


def test_looks_without_a_map_of_colours_say_so():
    for volume, composite in ((made("bytes of a scan"), None), (made("speed"), "maximum")):
        with pytest.raises(
            ws.errors.ArgumentError, match=r"is not one of a field.*from_colormap\('coolwarm', volume\)"
        ):
            ws.Look.auto(volume, composite, colormap="coolwarm")


def test_the_command_s_map_alone_is_that_of_the_look(wavesplat, tmp_path):
    """`--cmap coolwarm` made a field a wall, whose middle colour was not at 0."""
    volume = made("velocity of a wind")
    volume.save(tmp_path / "wind.nrrd")
    size = ("--size", "48x48", "--background", "transparent")
    done = wavesplat("render", tmp_path / "wind.nrrd", "--cmap", "coolwarm", *size, "-o", tmp_path / "a.png")
    assert done.returncode == 0, done.stderr
    there = ws.open(tmp_path / "wind.nrrd")
    ws.render(there, ws.Look.auto(there, colormap="coolwarm"), size=(48, 48)).save(tmp_path / "b.png")
    with Image.open(tmp_path / "a.png") as one, Image.open(tmp_path / "b.png") as two:
        assert np.array_equal(one, two)
    clim = wavesplat(
        "render", tmp_path / "wind.nrrd", "--cmap", "coolwarm", "--clim", "-20,20", *size, "-o", tmp_path / "c.png"
    )
    assert clim.returncode == 0, clim.stderr
    given = ws.TransferFunction.from_colormap("coolwarm", clim=(-20, 20))
    ws.render(there, given, size=(48, 48)).save(tmp_path / "d.png")
    with Image.open(tmp_path / "c.png") as one, Image.open(tmp_path / "d.png") as two:
        assert np.array_equal(one, two), "values that are given count, from clear to opaque"


def test_components_of_a_vector_get_one_kind():
    """A magnet's Bz has under 1 % of negative values, and its three components had two kinds of looks."""
    poles = [(X - 0.3, Y, Z + 0.5), (X + 0.3, Y, Z - 0.6)]
    for axis in range(3):
        component = sum((0.02 + x * x + y * y + z * z) ** -1.5 * (x, y, z)[axis] for x, y, z in poles)
        assert kind_of(ws.Volume(component.astype(np.float32))) == SIGNED
    few = BLOB - 0.23 * np.exp(-150 * ((X - 0.5) ** 2 + Y * Y + Z * Z))
    few -= 0.25 * np.exp(-120 * ((X - 0.9) ** 2 + (Y - 0.9) ** 2 + Z * Z))
    assert 0 < (few < 0).mean() < 0.01
    assert kind_of(ws.Volume(few.astype(np.float32))) == SIGNED


def test_a_bar_of_symmetric_logarithms_has_powers_of_ten_at_their_places():
    function = ws.Look.auto(made("heavy tails of both signs")).transfer_function
    bar = scale_of(function, "over", "", (1.0, 1.0, 1.0))
    middle = bar.place(0)
    assert middle == pytest.approx(0.5)
    assert bar.place(bar.high) == pytest.approx(1)
    assert bar.place(-10) + bar.place(10) == pytest.approx(1)
    assert bar.place(100) - bar.place(10) < bar.place(10) - middle + 0.2
    picture = ws.render(made("heavy tails of both signs"), size=(200, 200)).annotated(colorbar=True)
    written = [mark.text for mark in picture._canvas.marks if hasattr(mark, "text")]
    powers = [text for text in written if text.isdigit()]
    assert {"0", "1000"} <= set(powers)
    assert {"\N{MINUS SIGN}" + text for text in powers if text != "0"} <= set(written)
