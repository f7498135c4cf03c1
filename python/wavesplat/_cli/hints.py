"""Hints for unknown commands and options: the known ones that do the same."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from difflib import get_close_matches
from pathlib import Path

#: Command -> words that people use for it, in other programs too.
WORDS_OF_COMMANDS = {
    "render": "draw plot picture image screenshot snapshot export volume vr mip",
    "view": "open show viewer gui serve browse display ui app start",
    "movie": "video animate animation turntable turn rotate spin gif",
    "slice": "slices mpr ortho reslice section lightbox montage plane",
    "info": "header describe inspect stats metadata dump ls list",
    "convert": "save write transcode copy resample",
    "tf": "transfer-function look lut",
    "mesh": "isosurface surface contour stl marching-cubes segment",
    "gpu-check": "gpu gpus devices vulkan",
    "demo": "example examples try tour",
    "plan": "cost estimate dry-run",
    "presets": "looks styles preset",
    "wavelet": "compress wavelets levels",
}
#: Options, as they are to be written, with / between -> words that people use for them. A command means its first one.
WORDS_OF_OPTIONS = {
    "--composite mip / --slab maximum": "mip maximum max projection maximum-intensity-projection",
    "--composite minip / --slab minimum": "minip minimum min",
    "--composite mean / --slab mean": "average mean",
    "--composite x-ray": "xray x-ray drr",
    "--composite NAME": "blend blend-mode mode ray-function",
    "--composite isosurface --iso-value VALUE / --iso-value VALUE / --isolines FILE:VALUE,...": (
        "iso isovalue isosurface iso-surface surface contour value"
    ),
    "--isolines FILE:VALUE,...": "isodose isodoses isoline isocontour isocontours contour-values dose",
    "--contours FILE / --labels FILE": "rtstruct structures structure-set outline outlines rois",
    "--segment NAME": "segments label-names",
    "--cmap NAME": "colormap colourmap color-map colour-map lut palette colors colours color colour",
    "--clim LOW,HIGH": "limits range vmin vmax min-max contrast contrast-limits scalar-range display-range",
    "--window LEVEL,WIDTH or a name": "wl ww window-level window-width window-center windowing",
    "--opacity NAME|A,A,...": "opacity-scale alpha transparency opacities",
    "--log": "log-scale logarithmic",
    "--tf FILE, or --preset NAME": "transfer-function transfer vp volume-property lut-file tf-file look",
    "--preset NAME": "style theme",
    "--exposure FACTOR / --gamma G": "brightness brighten",
    "--light X,Y,Z": "light-direction light-position sun",
    "--occlusion 0..1": "ao ambient-occlusion",
    "--shading": "shade shaded lighting",
    "--no-shading": "no-light flat unlit",
    "--background COLOR": "bg background-color background-colour bgcolor",
    "--background transparent": "transparent",
    "--size WxH": "width height resolution res window-size pixels dimensions",
    "--view NAME / --plane NAME": "front anterior top side axis direction orientation",
    "--azimuth DEG": "rotate rotation yaw angle turn azim",
    "--elevation DEG": "pitch tilt elev",
    "--perspective DEG": "fov view-angle field-of-view",
    "--stereo LAYOUT": "stereo-mode stereo-type anaglyph stereoscopic 3d",
    "--panorama": "360 vr equirectangular spherical fisheye panoramic",
    "--eye-distance LENGTH": "eye-angle eye-separation interocular baseline",
    "--convergence LENGTH": "focal-distance zero-parallax",
    "--zoom FACTOR": "scale magnification dolly",
    "--spacing X,Y,Z": "voxel-size voxelsize voxel-spacing pixel-size pixelsize z-step zstep pitch-um",
    "--unit NAME": "units length-unit",
    "--time N": "frame timepoint time-point t",
    "--times all": "frames all-times",
    "--channel N": "channels c",
    "--layer FILE:COLORS:LOW,HIGH": "overlay fuse add second",
    "--scale-bar": "scalebar bar ruler",
    "--colorbar": "color-bar colour-bar colourbar scalar-bar",
    "--letters / --cube": "orientation-labels orientation-marker",
    "--labels FILE": "segmentation label mask seg",
    "--smooth VOXELS": "smoothing blur gaussian denoise sigma",
    "--clip X,Y,Z,NX,NY,NZ": "clip-plane clipping clipping-plane cut-plane",
    "--crop X0,Y0,Z0,X1,Y1,Z1": "clip-box crop-box roi bounds",
    "--cut-out NAME": "cutout cut corner",
    "--threads N": "jobs cores workers n-threads",
    "--quality high": "aa antialiasing supersampling samples step step-size",
    "--wavelet-level N / --level N": "levels",
    "--level N (OME-Zarr) / --wavelet-level N": "detail lod level-of-detail",
    "-o OUT": "out out-file outfile save save-as output-dir outdir",
    "--quiet": "silent",
    "--position LENGTH": "slice slice-index z",
    "--positions START:STOP:STEP / --sheet OUT": "slices lightbox montage mosaic n-slices",
    "--sheet OUT": "contact-sheet",
    '--title "t = {time}"': "time-stamp timestamp stamp",
    "--same-look first": "same-contrast same-window same-clim comparable",
    "--plane all": "ortho orthogonal planes three-planes mpr",
    "--thickness LENGTH": "thick slab-thickness",
}
#: Word -> the command, or the options, that it stands for.
COMMANDS = {word: command for command, words in WORDS_OF_COMMANDS.items() for word in words.split()}
OPTIONS = {word: tuple(text.split(" / ")) for text, words in WORDS_OF_OPTIONS.items() for word in words.split()}
#: Minimum similarity, 0..1 (`difflib`), from which a name counts as a misspelt command or option.
ALIKE_COMMANDS, ALIKE_OPTIONS = 0.7, 0.8


def of_command(name: str, commands: Collection[str]) -> str:
    """The hint for an unknown command. `commands`: the names of all."""
    word = name.lower().replace("_", "-")
    if word in COMMANDS:
        return f"write wavesplat {COMMANDS[word]}"
    if near := get_close_matches(word, [*commands, *COMMANDS], 1, ALIKE_COMMANDS):
        return f"did you mean {COMMANDS.get(near[0], near[0])}?"
    if Path(name).suffix or "/" in name or "\\" in name or Path(name).exists():
        return f"for a picture of a file write wavesplat render {name}, to look at it wavesplat view {name}"
    return "wavesplat --help lists the commands"


def of_option(option: str, command: str, options: Mapping[str, Collection[str]]) -> str:
    """The hint for an unknown option of a command. `options`: the options of all commands."""
    own = options[command]
    word = option.lstrip("-").lower().replace("_", "-")
    meant = OPTIONS.get(word, ())
    for text in meant:
        if text.split(" ")[0] in own:
            return f"write {text}"
    others = [name for name, known in options.items() if f"--{word}" in known]
    if others:
        return f"it is an option of wavesplat {', '.join(others)}"
    near = get_close_matches(f"--{word}", own, 1, ALIKE_OPTIONS)
    if near:
        return f"did you mean {near[0]}?"
    for text in meant:
        other = next((name for name, known in options.items() if text.split(" ")[0] in known), None)
        if other is not None:
            return f"write {text} with wavesplat {other}"
    return f"wavesplat {command} --help lists the options"
