"""Arguments of functions, checked against their annotations: errors name the argument and what is meant.

An annotation is one or several types, joined by `|`. Each of them is in `KINDS`, which says how it is checked, or in
`CHECKED_BY_FUNCTIONS`; any other is an error when the function is defined. Arguments with a type of the second list are
checked by the function itself.
"""

from __future__ import annotations

import inspect
import os
import textwrap
from collections.abc import Callable, Collection, Iterable
from dataclasses import fields
from difflib import get_close_matches
from functools import wraps
from operator import index
from typing import Any, ParamSpec, TypeVar

from wavesplat._storage.json_texts import is_text
from wavesplat._storage.paths import FileName
from wavesplat._system.values import described, float_of
from wavesplat.errors import ArgumentError

# Hints for unknown keyword arguments: the argument that is meant by a keyword of our commands or of other programs.
#
# Similar spelling is the last resort: `view` is not `device`.

#: Keywords that people try -> keywords that may be meant, the first that a function has; after a comma, what to give.
MEANT: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("view", "azimuth", "elevation", "zoom", "perspective", "view_angle", "viewpoint", "cpos", "direction"),
        ('camera, the name of a view, such as "xy", or a wavesplat.Camera', "plane"),
    ),
    **dict.fromkeys(("orientation", "axis"), ("plane", 'camera, the name of a view, such as "xy"')),
    **dict.fromkeys(("z", "slice", "index", "slice_index"), ("position, in world units",)),
    **dict.fromkeys(
        ("cmap", "colormap", "colour_map", "preset", "tf", "transfer_function", "opacity", "lut"),
        ("look", "transfer_function, the name of a preset or a TransferFunction"),
    ),
    **dict.fromkeys(
        ("clim", "window", "vmin", "vmax", "contrast_limits"),
        ("clim", "look, wavesplat.Look.auto(volume).changed(...)"),
    ),
    **dict.fromkeys(("projection", "mode", "blending", "mip", "operator", "rendering"), ("composite", "slab")),
    **dict.fromkeys(("iso", "iso_value", "isovalue", "isosurface"), ("composite, wavesplat.FirstHit(value)",)),
    **dict.fromkeys(("light", "lights", "lighting", "shade", "occlusion", "ambient"), ("shading",)),
    **dict.fromkeys(("clipping", "clip_plane", "clip_planes", "cut_out", "crop", "roi"), ("clip",)),
    **dict.fromkeys(("bg", "bgcolor", "background_color"), ("background",)),
    **dict.fromkeys(("width", "height", "window_size", "resolution"), ("size, (width, height)",)),
    **dict.fromkeys(("segmentation", "seg", "masks"), ("labels, a wavesplat.Labels",)),
    **dict.fromkeys(("lines", "points", "surfaces", "mesh", "meshes", "tracks"), ("geometry",)),
    **dict.fromkeys(("gpu", "backend"), ("device",)),
    **dict.fromkeys(("n_threads", "workers", "n_jobs"), ("threads",)),
    **dict.fromkeys(("voxel_size", "scale", "pixel_size"), ("spacing",)),
    **dict.fromkeys(("channels", "c"), ("channel", "channels")),
    **dict.fromkeys(("t", "timepoint", "frame"), ("time",)),
}
#: Keywords for things that another function does -> that function.
ELSEWHERE = {
    **dict.fromkeys(
        ("scale_bar", "scalebar", "colorbar", "colourbar", "legend", "title", "letters", "dpi"),
        "annotate the picture: picture.annotated({}=...)",
    ),
    **dict.fromkeys(("output", "out", "filename", "save"), "save the picture: picture.save(path)"),
    **dict.fromkeys(
        ("layer", "layers", "overlay"), "give several volumes: wavesplat.Scene([volume, wavesplat.Layer(...)])"
    ),
    **dict.fromkeys(("exposure", "gamma"), "change the look: wavesplat.Look.auto(volume).changed({}=...)"),
    **dict.fromkeys(("smooth", "sigma"), "smooth the volume: volume.smoothed(...)"),
    **dict.fromkeys(("time", "channel", "spacing", "unit", "level"), "say it to wavesplat.open: open(path, {}=...)"),
    "labels": "give a scene: wavesplat.Scene(volume, labels=...)",
}
#: Least similarity, 0..1 (`difflib`), from which a name counts as misspelt.
ALIKE = 0.7


def check_keywords(function: Callable[..., object], given: Collection[str], known: Collection[str]) -> None:
    """Raise a `TypeError`, as Python does, for the first keyword that a function does not take, with a hint."""
    called = function.__name__ if function.__name__ != "__init__" else function.__qualname__.split(".")[0]
    for name in given:
        if name not in known:
            raise TypeError(f"{called}() got an unexpected keyword argument {name!r}{_hint(name, known)}")


def _hint(name: str, known: Collection[str]) -> str:
    for meant in MEANT.get(name, ()):
        keyword, _, how = meant.partition(", ")
        if keyword in known:
            return f"; write {keyword}={f' ({how})' if how else ''}"
    near = get_close_matches(name, known, 1, ALIKE)
    if near:
        return f"; is it {near[0]!r}?"
    return f"; {ELSEWHERE[name].format(name)}" if name in ELSEWHERE else ""


# Checks of arguments against a function's annotations; the error names the argument and what it takes.

P = ParamSpec("P")
R = TypeVar("R")

#: Bound of the whole numbers that the compiled module takes.
MAX_WHOLE = 2**63

VOLUME = (
    "a wavesplat.Volume, as from wavesplat.open(path), an array [z, y, x], or an image of SimpleITK, ITK, nibabel, "
    "xarray, PyVista, VTK, PyTorch, yt or napari"
)


def is_whole_number_below(value: object, n: int) -> bool:
    """Whether a value is one of the whole numbers from 0 to n - 1."""
    try:
        return 0 <= index(value) < n  # type: ignore[arg-type]
    except TypeError:
        return False


def check_text(value: object, what: str) -> None:
    """Raise an `ArgumentError` for a text that cannot be written: it has half of a surrogate pair."""
    if isinstance(value, str) and not is_text(value):
        raise ArgumentError(f"{what} is {described(value)}, which has half of a surrogate pair; give a text without")


def text_of(value: object, what: str) -> str:
    """A value as a text; an `ArgumentError` for a whole number of more digits than Python writes."""
    if isinstance(value, FileName):
        return value
    try:
        return str(value)
    except ValueError:
        raise ArgumentError(f"{what} is {described(value)}; give a name") from None


def takes_its_types(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that arguments of other types than its annotations' raise an `ArgumentError`."""
    signature = inspect.signature(function)
    checks = {
        name: check
        for name, parameter in signature.parameters.items()
        if isinstance(parameter.annotation, str) and (check := _check(parameter.annotation))
    }

    takes_any = any(parameter.kind is parameter.VAR_KEYWORD for parameter in signature.parameters.values())

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError:
            if not takes_any:
                check_keywords(function, kwargs, signature.parameters)
            return function(*args, **kwargs)  # which says it better
        for name, value in given.items():
            if name in checks:
                checks[name](name, value)
        return function(*args, **kwargs)

    return checked


def _check(annotation: str) -> Callable[[str, object], None] | None:
    """A checker of values against an annotation; None for one that the function checks itself."""
    words = [annotation] if annotation in KINDS else _alternatives(annotation)
    for word in words:
        if word not in KINDS and word.partition("[")[0] not in CHECKED_BY_FUNCTIONS:
            raise TypeError(f"annotation {annotation!r}: add {word!r} to KINDS or CHECKED_BY_FUNCTIONS")
    if annotation == "Volume" or not all(word in KINDS for word in words):
        return None  # functions that take only samples say what to do with coefficients
    kinds = [KINDS[word] for word in words]
    forms = list(dict.fromkeys(form for _, form in kinds if form))

    def check(name: str, value: object) -> None:
        if TEXT in kinds:
            check_text(value, name)
        if not any(fits(value) for fits, _ in kinds):
            raise ArgumentError(f"{name} is {described(value)}; give {' or '.join(forms)}")

    return check


def _alternatives(annotation: str) -> list[str]:
    """The types of an annotation that are joined by `|` outside of brackets."""
    words, depth = [""], 0
    for letter in annotation.replace(" | ", "|"):
        depth += (letter == "[") - (letter == "]")
        if letter == "|" and depth == 0:
            words.append("")
        else:
            words[-1] += letter
    return words


def _is_whole(value: object) -> bool:
    try:
        return not isinstance(value, bool) and -MAX_WHOLE <= index(value) < MAX_WHOLE  # type: ignore[arg-type]
    except TypeError:
        return False


def _is_flag(value: object) -> bool:
    try:
        bool(value)
    except (TypeError, ValueError):
        return False
    return True


def _is_many(value: object) -> bool:
    return isinstance(value, Iterable)


def _is_text(value: object) -> bool:
    return isinstance(value, str) and is_text(value)


def _is_a(*names: str) -> Callable[[object], bool]:
    """Test whether a value's class or one of its bases has one of these names (their modules import this one)."""
    return lambda value: any(base.__name__ in names for base in type(value).__mro__)


TEXT = (_is_text, "a name")

KINDS: dict[str, tuple[Callable[[object], bool], str]] = {
    "Iterable[Light]": (_is_many, "a sequence of wavesplat.Light"),
    "None": (lambda value: value is None, ""),
    "float": (lambda value: float_of(value) is not None, "a number"),
    "int": (_is_whole, "a whole number"),
    "bool": (_is_flag, "True or False"),
    "str": TEXT,
    **dict.fromkeys(("Kernel", "Composite", "Quality", "Slab", "Buffer"), TEXT),
    # Names of files may hold bytes that are no text.
    "str | PathLike[str]": (lambda value: isinstance(value, str | os.PathLike), "the name of a file or folder"),
    "Grid": (_is_a("Grid"), VOLUME),
    "Volume": (_is_a("Volume"), VOLUME),
    "WaveletVolume": (_is_a("WaveletVolume"), ""),
    "Picture": (_is_a("Picture"), "a wavesplat.Picture"),
    "Shading": (_is_a("Shading"), "a wavesplat.Shading or None"),
    "Literal['look']": (lambda value: isinstance(value, str) and value == "look", '"look"'),
    "Look": (_is_a("Look"), "a wavesplat.Look"),
    # Functions that take only `TransferFunction` say so themselves.
    "TransferFunction": (_is_a("TransferFunction", "TransferFunction2D"), "a TransferFunction"),
    "TransferFunction2D": (_is_a("TransferFunction2D"), "a TransferFunction2D"),
    "Materials": (_is_a("Materials"), "Materials"),
    "Crop": (_is_a("Crop"), "a wavesplat.Crop(lower, upper, space=...)"),
    "Callable[[float], object]": (callable, "a function"),
}

#: Types whose values the functions check themselves, since they take them in several forms, or say what to do instead.
CHECKED_BY_FUNCTIONS = frozenset(
    {
        *("Any", "object", "VolumeLike", "Scene", "Labels", "AnyLook", "Sampling", "Stereo", "Operator", "Opacity"),
        *("Camera", "Clip", "Along", "Plane", "Orientation", "Corner", "Side", "Fit", "Ablation", "StandardSplatting"),
        *("tuple", "Iterable", "Sequence", "Mapping", "Literal", "PathLike", "ArrayLike", "DTypeLike", "Isolines"),
        "_native.Shapes",
        "Shown",
    }
)


# Options that several functions take, each list written once.
#
# A list is a `TypedDict` whose docstring documents its keys, and a dataclass with the same fields and their defaults. A
# function takes one as ``**options: Unpack[RenderOptions]``, which type checkers and editors understand;
# `takes_options` gives the function the whole signature and documentation, so that `help` shows them.

#: Columns of a documentation line.
WIDTH = 112


def takes_options(
    listed: type, values: type, *, in_full: bool = False, **defaults: object
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator that writes out the ``**options`` of a function: its signature, its documentation, unknown names.

    Parameters
    ----------
    listed : TypedDict
        The options.
    values : dataclass
        Has a field of the same name for each of them, with type and default.
    in_full : bool, default False
        Write out what the options mean, in place of the entry ``**options``; else their names, in place of its name.
    defaults
        Defaults that differ from the defaults of `values`.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        whole = _signature(function, listed, values, defaults)

        @wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            check_keywords(function, kwargs, whole.parameters)
            return function(*args, **kwargs)

        called.__signature__ = whole  # type: ignore[attr-defined]
        called.__doc__ = _documentation(function.__doc__, listed, in_full=in_full)
        return called

    return decorate


def _signature(
    function: Callable[..., Any], listed: type, values: type, defaults: dict[str, object]
) -> inspect.Signature:
    """The signature with a keyword for each option in place of ``**options``."""
    own = inspect.signature(function)
    written = [one for one in own.parameters.values() if one.kind is not one.VAR_KEYWORD]
    of = {field.name: field for field in fields(values)}
    for name in listed.__annotations__:
        default = defaults.get(name, of[name].default)
        written.append(
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=of[name].type)
        )
    return own.replace(parameters=written)


def _documentation(text: str | None, listed: type, *, in_full: bool) -> str | None:
    """The documentation with the options, or their names, in place of the entry ``**options``."""
    if text is None or listed.__doc__ is None:
        return text  # python -OO
    lines = inspect.cleandoc(text).splitlines()
    [begin] = [k for k, line in enumerate(lines) if line.startswith("**options")]
    end = begin + 1
    if in_full:
        while end < len(lines) and lines[end].startswith(" "):
            end += 1
        section = inspect.cleandoc(listed.__doc__).split("----------\n", 1)[1]
        entries = section.split("\n\nExamples\n", 1)[0].splitlines()
    else:
        entries = textwrap.wrap(", ".join(listed.__annotations__), WIDTH)
    return "\n".join([*lines[:begin], *entries, *lines[end:]])


def first_sentences(listed: type) -> dict[str, str]:
    """The first sentence on each option of a list, for one line of help; empty where Python left out documentation."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in inspect.cleandoc(listed.__doc__ or "").partition("----------\n")[2].partition("\n\n")[0].splitlines():
        if line.startswith(" "):
            found[name].append(line.strip())
        else:
            name = line.partition(" ")[0]
            found[name] = []
    return {name: " ".join(lines).partition(". ")[0].rstrip(".") + "." for name, lines in found.items()}
