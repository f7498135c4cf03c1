"""The usual colour of a microscope's channel: from the file, else by its emission wavelength or its dye.

White is what writers put where they know no colour, so that several channels that are all white have none.
Dyes and proteins are known by their names; of names with a number, such as "Alexa 568" or "488 nm", the number is the
line that excites, whose light is about 30 nm longer.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from wavesplat._model.volume.facts import Channel, Rgb

#: Conventional colours of channels without a colour, and of unknown light: green, magenta, cyan, yellow, red, blue,
#: white, orange.
CHANNEL_COLORS: tuple[Rgb, ...] = (
    (0.0, 1.0, 0.0),
    (1.0, 0.0, 1.0),
    (0.0, 1.0, 1.0),
    (1.0, 1.0, 0.0),
    (1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0),
    (1.0, 1.0, 1.0),
    (1.0, 0.65, 0.0),
)
#: Longest wavelength of the light, nanometres -> its usual colour: blue, cyan, green, yellow, orange, red, and magenta
#: for far red, which the eye hardly sees.
COLORS_OF_LIGHT: tuple[tuple[float, Rgb], ...] = (
    (470.0, (0.0, 0.0, 1.0)),
    (495.0, (0.0, 1.0, 1.0)),
    (545.0, (0.0, 1.0, 0.0)),
    (565.0, (1.0, 1.0, 0.0)),
    (590.0, (1.0, 0.5, 0.0)),
    (640.0, (1.0, 0.2, 0.0)),
)
FAR_RED: Rgb = (1.0, 0.0, 1.0)
WHITE: Rgb = (1.0, 1.0, 1.0)
#: Wavelengths that detectors of microscopes see, nanometres.
LIGHT_NM = (300.0, 1000.0)
#: Dyes and fluorescent proteins, and the peak of their light, nanometres (FPbase, and the makers' data sheets).
DYES = {
    **dict.fromkeys(("dapi", "hoechst", "bfp", "tagbfp"), 460.0),
    **dict.fromkeys(("cfp", "cerulean", "turquoise", "tfp"), 480.0),
    **dict.fromkeys(
        ("gfp", "fitc", "fluorescein", "neongreen", "clover", "staygold", "gcamp", "cy2", "calcein"), 512.0
    ),
    **dict.fromkeys(("yfp", "venus", "citrine"), 550.0),
    **dict.fromkeys(("cy3", "tritc", "rhodamine", "tamra", "tomato", "dsred", "rfp", "tagrfp", "orange", "dii"), 580.0),
    **dict.fromkeys(("cherry", "scarlet", "ruby", "texasred", "txred", "jred", "rcamp", "propidium"), 610.0),
    **dict.fromkeys(("cy5", "cy7", "sir", "draq5", "plum", "irfp", "farred"), 670.0),
}
#: Prefixes of the names in `DYES`: monomeric, enhanced, superfolder, tandem dimer, ...
BEFORE_DYES = ("em", "me", "sf", "td", "d", "e", "j", "m")
#: Names of channels of transmitted light.
TRANSMITTED = {"brightfield", "bf", "dic", "phase", "transmitted", "tl", "esid", "tpmt", "phasecontrast"}
#: Names of colours: Leica's files name channels after their look-up tables.
NAMES_OF_COLORS: dict[str, Rgb] = {
    "blue": (0.0, 0.0, 1.0),
    "cyan": (0.0, 1.0, 1.0),
    "green": (0.0, 1.0, 0.0),
    "yellow": (1.0, 1.0, 0.0),
    "red": (1.0, 0.0, 0.0),
    "magenta": (1.0, 0.0, 1.0),
    **dict.fromkeys(("gray", "grey", "white"), WHITE),
}
#: Excitation lines, by which dyes are numbered, and the Stokes shift to their emission, nanometres.
LINES = {
    *(350, 355, 365, 375, 385, 395, 405, 430, 440, 445, 450, 458, 470, 473, 475, 476, 477, 480, 485, 488, 490, 491),
    *(505, 514, 515, 532, 543, 546, 549, 550, 552, 555, 560, 561, 565, 568, 590, 594, 610, 620, 630, 633, 635, 637),
    *(638, 640, 642, 646, 647, 649, 650, 660, 680, 700, 730, 740, 750, 785, 790),
}
STOKES_NM = 30.0
#: Lines whose number always means a dye or a laser, as in "actin 568".
COMMON_LINES = {405, 488, 514, 532, 546, 555, 561, 568, 594, 633, 640, 647}
#: Words that stand beside the number of a dye or of a wavelength; others make it a number of something else.
BESIDE_NUMBERS = {
    *("a", "abberior", "af", "alexa", "alexafluor", "atto", "bodipy", "c", "cam", "camera", "cf", "ch", "channel"),
    *(
        "confocal",
        "dylight",
        "em",
        "emission",
        "ex",
        "excitation",
        "fluor",
        "janelia",
        "jf",
        "laser",
        "led",
        "lp",
        "nm",
    ),
    *("phalloidin", "plus", "sim", "star", "sted", "t", "tirf", "track", "widefield", "wf"),
}
#: Colours that differ by less in every share count as the same.
SAME_COLOR = 0.1


def color_of(channel: Channel | None, channels: Sequence[Channel]) -> Rgb | None:
    """The colour of a channel among all of its file: the file's, else the usual one of its light; None without either.

    White beside other colours was chosen by somebody, and so was the white of a single channel.
    """
    if channel is None:
        return None
    given = [one.color for one in channels if one.color is not None]
    is_chosen = channel.color is not None and not (len(given) > 1 and all(is_same_color(one, WHITE) for one in given))
    return channel.color if is_chosen else usual_color(channel)


def usual_color(channel: Channel) -> Rgb | None:
    """The colour of a channel's light, by its wavelength, else by the name of its dye, or of a colour; else None."""
    wavelength = channel.emission_nm if channel.emission_nm is not None else _wavelength_of(channel.name)
    if wavelength is None:
        is_transmitted = not TRANSMITTED.isdisjoint(_words(channel.name))
        return WHITE if is_transmitted else NAMES_OF_COLORS.get(channel.name.strip().lower())
    if not LIGHT_NM[0] <= wavelength <= LIGHT_NM[1]:
        return None
    return next((color for longest, color in COLORS_OF_LIGHT if wavelength < longest), FAR_RED)


def distinct_colors(wanted: Sequence[Rgb | None], own: Sequence[Rgb | None]) -> list[Rgb]:
    """A colour for each channel: the wanted one, else its own if no other channel has it, else a conventional one.

    Own colours are given before the others, so that none is taken by a channel that has none.
    """
    found = list(wanted)
    for number, color in enumerate(own):
        if found[number] is None and color is not None and not _is_taken(color, found):
            found[number] = color
    for number, color in enumerate(found):
        if color is None:
            free = (one for one in CHANNEL_COLORS if not _is_taken(one, found))
            found[number] = next(free, CHANNEL_COLORS[number % len(CHANNEL_COLORS)])
    return [color for color in found if color is not None]


def is_same_color(color: Rgb, other: Rgb) -> bool:
    """Whether two colours look the same."""
    return all(abs(a - b) < SAME_COLOR for a, b in zip(color, other, strict=True))


def _is_taken(color: Rgb, colors: Sequence[Rgb | None]) -> bool:
    return any(other is not None and is_same_color(color, other) for other in colors)


def _words(name: str) -> list[str]:
    """Words of a name in small letters, also without the number at their ends, and each two that stand side by side."""
    words = re.findall(r"[a-z]+[0-9]*", name.lower())
    bare = [word.rstrip("0123456789") for word in words]
    numbered = re.findall(r"[a-z]+[0-9]*|[0-9]+", name.lower())
    return [*words, *bare, *(one + other for one, other in pairwise(numbered))]


def _wavelength_of(name: str) -> float | None:
    """The emission wavelength of the dye that a name contains, in nanometres; None if it contains no dye."""
    for word in _words(name):
        for before in ("", *BEFORE_DYES):
            if word.startswith(before) and word[len(before) :] in DYES:
                return DYES[word[len(before) :]]
    parts = re.findall(r"[a-z]+|[0-9]+", name.lower())
    is_alone = all(part.isdecimal() or part in BESIDE_NUMBERS for part in parts)
    for number in (int(part) for part in parts if part.isdecimal() and len(part) == 3):
        if number in COMMON_LINES or (is_alone and number in LINES):
            return number + STOKES_NM
        if is_alone and LIGHT_NM[0] <= number <= LIGHT_NM[1]:
            return float(number)
    return None
