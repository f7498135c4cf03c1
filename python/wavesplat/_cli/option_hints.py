"""Hints for unknown options: the option of the command that does what the name asks for.

Similar spelling is the last resort: `--window` does not mean `--shadow`, nor `--clim` `--time`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from difflib import get_close_matches

__all__ = ["hint"]

#: Words that people use, in other programs too -> what to write. The first that a command has is offered.
WORDS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("mip", "maximum", "max", "projection", "maximum-intensity-projection"), ("--composite mip", "--slab maximum")
    ),
    **dict.fromkeys(("minip", "minimum", "min"), ("--composite minip", "--slab minimum")),
    **dict.fromkeys(("average", "mean"), ("--composite mean", "--slab mean")),
    **dict.fromkeys(("xray", "x-ray", "drr"), ("--composite x-ray",)),
    **dict.fromkeys(("blend", "blend-mode", "mode", "ray-function"), ("--composite NAME",)),
    **dict.fromkeys(
        ("iso", "isovalue", "isosurface", "iso-surface", "surface", "contour", "value"),
        ("--composite isosurface --iso-value VALUE", "--iso-value VALUE", "--isolines FILE:VALUE,..."),
    ),
    **dict.fromkeys(
        ("isodose", "isodoses", "isoline", "isocontour", "isocontours", "contour-values", "dose"),
        ("--isolines FILE:VALUE,...",),
    ),
    **dict.fromkeys(
        ("rtstruct", "structures", "structure-set", "outline", "outlines", "rois"), ("--contours FILE", "--labels FILE")
    ),
    **dict.fromkeys(("segments", "label-names"), ("--segment NAME",)),
    **dict.fromkeys(
        ("colormap", "colourmap", "color-map", "colour-map", "lut", "palette", "colors", "colours", "color", "colour"),
        ("--cmap NAME",),
    ),
    **dict.fromkeys(
        ("limits", "range", "vmin", "vmax", "min-max", "contrast", "contrast-limits", "scalar-range", "display-range"),
        ("--clim LOW,HIGH",),
    ),
    **dict.fromkeys(
        ("wl", "ww", "window-level", "window-width", "window-center", "windowing"), ("--window LEVEL,WIDTH or a name",)
    ),
    **dict.fromkeys(("opacity-scale", "alpha", "transparency", "opacities"), ("--opacity NAME|A,A,...",)),
    **dict.fromkeys(("log-scale", "logarithmic"), ("--log",)),
    **dict.fromkeys(
        ("transfer-function", "transfer", "vp", "volume-property", "lut-file", "tf-file", "look"),
        ("--tf FILE, or --preset NAME",),
    ),
    **dict.fromkeys(("style", "theme"), ("--preset NAME",)),
    **dict.fromkeys(("brightness", "brighten"), ("--exposure FACTOR", "--gamma G")),
    **dict.fromkeys(("light-direction", "light-position", "sun"), ("--light X,Y,Z",)),
    **dict.fromkeys(("ao", "ambient-occlusion"), ("--occlusion 0..1",)),
    **dict.fromkeys(("shade", "shaded", "lighting"), ("--shading",)),
    **dict.fromkeys(("no-light", "flat", "unlit"), ("--no-shading",)),
    **dict.fromkeys(("bg", "background-color", "background-colour", "bgcolor"), ("--background COLOR",)),
    **dict.fromkeys(("transparent",), ("--background transparent",)),
    **dict.fromkeys(("width", "height", "resolution", "res", "window-size", "pixels", "dimensions"), ("--size WxH",)),
    **dict.fromkeys(
        ("front", "anterior", "top", "side", "axis", "direction", "orientation"), ("--view NAME", "--plane NAME")
    ),
    **dict.fromkeys(("rotate", "rotation", "yaw", "angle", "turn", "azim"), ("--azimuth DEG",)),
    **dict.fromkeys(("pitch", "tilt", "elev"), ("--elevation DEG",)),
    **dict.fromkeys(("fov", "view-angle", "field-of-view"), ("--perspective DEG",)),
    **dict.fromkeys(("stereo-mode", "stereo-type", "anaglyph", "stereoscopic", "3d"), ("--stereo LAYOUT",)),
    **dict.fromkeys(("360", "vr", "equirectangular", "spherical", "fisheye", "panoramic"), ("--panorama",)),
    **dict.fromkeys(("eye-angle", "eye-separation", "interocular", "baseline"), ("--eye-distance LENGTH",)),
    **dict.fromkeys(("focal-distance", "zero-parallax"), ("--convergence LENGTH",)),
    **dict.fromkeys(("scale", "magnification", "dolly"), ("--zoom FACTOR",)),
    **dict.fromkeys(
        ("voxel-size", "voxelsize", "voxel-spacing", "pixel-size", "pixelsize", "z-step", "zstep", "pitch-um"),
        ("--spacing X,Y,Z",),
    ),
    **dict.fromkeys(("units", "length-unit"), ("--unit NAME",)),
    **dict.fromkeys(("frame", "timepoint", "time-point", "t"), ("--time N",)),
    **dict.fromkeys(("frames", "all-times"), ("--times all",)),
    **dict.fromkeys(("channels", "c"), ("--channel N",)),
    **dict.fromkeys(("overlay", "fuse", "add", "second"), ("--layer FILE:COLORS:LOW,HIGH",)),
    **dict.fromkeys(("scalebar", "bar", "ruler"), ("--scale-bar",)),
    **dict.fromkeys(("color-bar", "colour-bar", "colourbar", "scalar-bar"), ("--colorbar",)),
    **dict.fromkeys(("orientation-labels", "orientation-marker"), ("--letters", "--cube")),
    **dict.fromkeys(("segmentation", "label", "mask", "seg"), ("--labels FILE",)),
    **dict.fromkeys(("smoothing", "blur", "gaussian", "denoise", "sigma"), ("--smooth VOXELS",)),
    **dict.fromkeys(("clip-plane", "clipping", "clipping-plane", "cut-plane"), ("--clip X,Y,Z,NX,NY,NZ",)),
    **dict.fromkeys(("clip-box", "crop-box", "roi", "bounds"), ("--crop X0,Y0,Z0,X1,Y1,Z1",)),
    **dict.fromkeys(("cutout", "cut", "corner"), ("--cut-out NAME",)),
    **dict.fromkeys(("jobs", "cores", "workers", "n-threads"), ("--threads N",)),
    **dict.fromkeys(("aa", "antialiasing", "supersampling", "samples", "step", "step-size"), ("--quality high",)),
    "levels": ("--wavelet-level N", "--level N"),
    **dict.fromkeys(("detail", "lod", "level-of-detail"), ("--level N (OME-Zarr)", "--wavelet-level N")),
    **dict.fromkeys(("out", "out-file", "outfile", "save", "save-as", "output-dir", "outdir"), ("-o OUT",)),
    **dict.fromkeys(("silent",), ("--quiet",)),
    **dict.fromkeys(("slice", "slice-index", "z"), ("--position MM",)),
    **dict.fromkeys(
        ("slices", "lightbox", "montage", "mosaic", "n-slices"), ("--positions START:STOP:STEP", "--sheet OUT")
    ),
    **dict.fromkeys(("contact-sheet",), ("--sheet OUT",)),
    **dict.fromkeys(("time-stamp", "timestamp", "stamp"), ('--title "t = {time}"',)),
    **dict.fromkeys(("same-contrast", "same-window", "same-clim", "comparable"), ("--same-look first",)),
    **dict.fromkeys(("ortho", "orthogonal", "planes", "three-planes", "mpr"), ("--plane all",)),
    **dict.fromkeys(("thick", "slab-thickness"), ("--thickness MM",)),
}
#: Least similarity, 0..1 (`difflib`), from which a name counts as a misspelt option.
ALIKE = 0.8


def hint(option: str, command: str, options: Mapping[str, Collection[str]]) -> str:
    """The hint for an unknown option of a command. `options`: those of all commands, as they are written."""
    own = options[command]
    word = option.lstrip("-").lower().replace("_", "-")
    meant = WORDS.get(word, ())
    for text in meant:
        if text.split(" ")[0] in own:
            return f"write {text}"
    others = [name for name, known in options.items() if f"--{word}" in known]
    if others:
        return f"it is an option of wavesplat {', '.join(others)}"
    near = get_close_matches(f"--{word}", own, 1, ALIKE)
    if near:
        return f"did you mean {near[0]}?"
    for text in meant:
        other = next((name for name, known in options.items() if text.split(" ")[0] in known), None)
        if other is not None:
            return f"write {text} with wavesplat {other}"
    return f"wavesplat {command} --help lists the options"
