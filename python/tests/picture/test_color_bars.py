"""Colour bars and legends: the colours of the right values, with their names."""

import numpy as np
import pytest
from figure_pictures import ALPHA, BONE, GREEN, GREYS, RED, WHITE, check_inside, picture, texts

import wavesplat as ws
from wavesplat._picture import color_bar, lettering, raster
from wavesplat._picture.marks import Canvas, Ramp, Text
from wavesplat._picture.report_facts import shown_layer
from wavesplat.errors import ArgumentError

# Colours


@pytest.mark.parametrize(
    ("low", "high", "most", "ticks"),
    [
        (0, 1000, 5, [0, 250, 500, 750, 1000]),
        (150, 400, 6, [150, 200, 250, 300, 350, 400]),
        (-10, 10, 5, [-10, -5, 0, 5, 10]),
        (0.1, 0.13, 4, [0.1, 0.11, 0.12, 0.13]),
        (3, 4, 2, [3, 4]),
    ],
)
def test_ticks_are_round(low, high, most, ticks):
    assert color_bar.round_ticks(low, high, most) == pytest.approx(ticks)


def test_a_bar_has_the_colours_of_the_function():
    scale = color_bar.scale_of(BONE, "over", "HU", WHITE)
    assert (scale.low, scale.high) == (150, 400)
    canvas = Canvas(40, 500, np.zeros((1, 1, 4), np.float32), marks=(Ramp(0, 0, 40, 500, scale.stops),))
    column = raster.drawn(canvas)[:, 20]
    values = 150 + 250 * (1 - (np.arange(500) + 0.5) / 500)
    np.testing.assert_allclose(column[:, :3], BONE(values)[:, :3], atol=1e-6)


def test_steps_stay_sharp():
    function = ws.TransferFunction([(0, 1), (10, 1)], [(0, *RED), (4, *RED), (4, *GREEN), (10, *GREEN)])
    stops = color_bar.scale_of(function, "over", "", WHITE).stops
    assert [(round(place, 6), np.round(color, 6).tolist()) for place, color in stops][1:3] == [
        (0.4, [1, 0, 0]),
        (0.4, [0, 1, 0]),
    ]


def test_bars_of_projections_show_opacity_and_others_do_not():
    faint = ws.TransferFunction([(0, 0), (10, 0.5)], [(0, *RED), (10, *RED)])
    mixed, projected = (color_bar.scale_of(faint, name, "", WHITE).stops for name in ("over", "maximum"))
    np.testing.assert_allclose(mixed[-1][1], RED, atol=1e-6)
    np.testing.assert_allclose(projected[0][1], WHITE, atol=1e-6)
    np.testing.assert_allclose(projected[-1][1], (1, 0.5, 0.5), atol=1e-6)


def test_what_nothing_is_seen_of_is_left_out():
    nodes = [(-1000, 0), (-50, 0), (0, 0.1), (80, 0.1), (90, 0), (3000, 0)]
    function = ws.TransferFunction(nodes, [(-1000, 0, 0, 0), (3000, 1, 1, 1)])
    scale = color_bar.scale_of(function, "over", "", WHITE)
    assert (scale.low, scale.high) == (-50, 90)
    step = ws.TransferFunction([(300, 0), (300, 1)], [(300, 1, 1, 1)])
    scale = color_bar.scale_of(step, "over", "", WHITE)
    assert scale.low < 300 < scale.high


def test_logarithmic_maps_have_logarithmic_bars():
    function = ws.TransferFunction.from_colormap("viridis", clim=(1, 1e6), log=True)
    scale = color_bar.scale_of(function, "over", "density", WHITE)
    assert scale.is_log
    assert scale.place(1000) == pytest.approx(0.5)
    made = picture(shown=[shown_layer("density", "over", function, "")], size=(400, 400)).annotated(colorbar=True)
    assert {"density", "1", "100", "10⁴", "10⁶"} <= set(texts(made))
    linear = ws.TransferFunction.from_colormap("viridis", clim=(1, 1e6))
    assert not color_bar.scale_of(linear, "over", "", WHITE).is_log


def test_large_values_have_a_power_of_ten():
    function = ws.TransferFunction([(0, 0), (3e7, 1)], [(0, 0, 0, 0), (3e7, 1, 1, 1)])
    made = picture(shown=[shown_layer("Bq", "over", function, "")], size=(400, 400)).annotated(colorbar=True)
    assert texts(made)[0] == "Bq  \N{MULTIPLICATION SIGN}10⁷"
    assert set(texts(made)[1:]) <= {"0", "1", "2", "3"}
    signed = ws.TransferFunction.diverging(10)
    made = picture(shown=[shown_layer("", "over", signed, "m/s")], size=(400, 400)).annotated(colorbar=True)
    assert {"m/s", "\N{MINUS SIGN}10", "0", "10"} <= set(texts(made))


def test_several_layers_have_a_bar_each():
    shown = [shown_layer("ct.nii.gz", "over", BONE, "HU"), shown_layer("pet", "over", GREYS, "")]
    made = picture(shown=shown, size=(600, 600))
    assert {"ct (HU)", "pet"} <= set(texts(made.annotated(colorbar=True)))
    assert "pet" not in texts(made.annotated(colorbar="ct.nii.gz"))
    with pytest.raises(ArgumentError, match=r"no layer is named 'mr'; there are: 'ct\.nii\.gz', 'pet'"):
        made.annotated(colorbar="mr")


def test_functions_of_two_dimensions_have_no_bar():
    table = ws.TransferFunction2D([0, 1], [0, 1], np.ones((2, 2, 4)))
    with pytest.raises(ArgumentError, match="depend on the gradient or a second field too"):
        picture(shown=[shown_layer("ct", "over", table, "")]).annotated(colorbar=True)


# Legends


def test_legends_name_labels_and_layers():
    labels = [{"name": "liver", "color": [1, 0, 0]}, {"name": "spleen", "color": [0, 1, 0]}]
    made = picture(labels=labels)
    figure = made.annotated(legend=True)
    assert texts(figure) == ["liver", "spleen"]
    for color in (RED, GREEN):
        assert (figure.rgba[:, 400:, :3] == color).all(axis=2).sum() > 50
    assert texts(made.annotated(legend=["spleen"])) == ["spleen"]
    with pytest.raises(ArgumentError, match=r"no \['lung'\]; there are: 'liver', 'spleen'"):
        made.annotated(legend=["lung"])
    channels = [
        shown_layer(name, "over", ws.TransferFunction([(0, 0), (1, 1)], [(0, 0, 0, 0), (1, *color)]), "")
        for name, color in (("DAPI", RED), (ALPHA + "-tubulin", GREEN))
    ]
    figure = picture("black", shown=channels).annotated(legend=True, legend_at="upper left")
    assert texts(figure) == ["DAPI", ALPHA + "-tubulin"]
    assert figure.size == (400, 300)
    with pytest.raises(ArgumentError, match="nothing for a legend"):
        picture().annotated(legend=True)


def test_many_labels_stand_in_columns():
    labels = [{"name": f"label {number}", "color": [0, 0, number / 60]} for number in range(60)]
    figure = picture(labels=labels).annotated(legend=[label["name"] for label in labels])
    assert len(texts(figure)) == 60
    assert len({mark.x for mark in figure._canvas.marks if isinstance(mark, Text)}) > 1
    check_inside(figure)


def test_a_legend_of_very_many_labels_is_cut():
    labels = [{"name": f"label {number}", "color": [0, 0, number / 60]} for number in range(60)]
    figure = picture(labels=labels).annotated(legend=True)
    assert texts(figure) == [*(f"label {number}" for number in range(30)), "and 30 more"]
    assert len(texts(picture(labels=labels[:30]).annotated(legend=True))) == 30
    check_inside(figure)


def test_a_legend_beside_a_low_picture_stays_in_proportion_fault_10():
    """A coronal slice through twenty thick axial ones is 122 x 30 pixels."""
    labels = [{"name": f"vertebra {number}", "color": [0, 0, number / 60]} for number in range(31)]
    low = ws.Picture(np.ones((30, 122, 4), np.float32), report={"labels": labels})
    width, height = low.annotated(legend=True).size
    assert width < 122 + 300
    assert 200 < height < 300


def test_powers_of_ten_have_letters_that_the_typeface_has():
    lettering.check_letters(color_bar.RAISED + color_bar.MINUS + color_bar.TIMES, None, "a power of ten")


def written_values(low, high, *, size=300, log=False):
    """Values of a bar's labels as numbers, and the labels."""
    function = ws.TransferFunction.from_colormap("viridis", clim=(low, high), log=log)
    made = picture(shown=[shown_layer("v", "over", function, "")], size=(size, size)).annotated(colorbar=True)
    head, *labels = texts(made)
    raised = str.maketrans(color_bar.RAISED, "-0123456789")
    factor = 10.0 ** int(head.partition("10")[2].translate(raised)) if "10" in head else 1.0
    return [factor * float(label.replace("\N{MINUS SIGN}", "-")) for label in labels], labels


@pytest.mark.parametrize(
    ("low", "high"),
    [
        (1e7, 1e7 + 3),
        (1e6, 1e6 + 1),
        (-1e6 - 1, -1e6),
        (20_260_101, 20_260_131),
        (1.6e9, 1.6e9 + 60),
        (1, 1 + 1e-9),
        (1, 1 + 1e-14),
        (1e12, 1e12 + 1),
        (5e-7, 5e-7 + 1e-13),
        (273.15, 273.1500001),
        (0, 1e-300),
        (0, 5e-324),
        (-1e308, 1e307),
        (0.1, 1 / 3),
        (1e300, 1.0000001e300),
    ],
)
@pytest.mark.parametrize("size", [60, 300])
def test_labels_differ_and_lie_in_the_range(low, high, size):
    values, labels = written_values(low, high, size=size)
    assert len(labels) >= 2
    assert len(set(labels)) == len(labels)
    room = 2e-3 * (high - low) + 4 * np.spacing(max(abs(low), abs(high)))
    assert all(low - room <= value <= high + room for value in values)
    assert values == sorted(values)


def test_whole_numbers_are_written_out_where_that_is_shorter():
    _, labels = written_values(20_260_101, 20_260_131)
    assert all(label.startswith("202601") and len(label) == 8 for label in labels)
    _, labels = written_values(0, 3e7)
    assert max(map(len, labels)) <= 4


def test_a_range_that_float64_cannot_span_is_refused():
    function = ws.TransferFunction([(-1.7e308, 0), (1.7e308, 1)], [(-1.7e308, 0, 0, 0), (1.7e308, 1, 1, 1)])
    with pytest.raises(ArgumentError, match="no colour bar"):
        color_bar.scale_of(function, "over", "", WHITE)


def test_a_surface_of_one_colour_has_no_bar():
    """Isosurfaces had a bar of colours that they do not have (simulation, F11)."""
    picture = ws.render(ws.examples.ripples(24), "grey", composite=ws.FirstHit(100), size=(60, 60))
    with pytest.raises(ws.errors.ArgumentError, match="a surface of one value has one colour"):
        picture.annotated(colorbar=True)
