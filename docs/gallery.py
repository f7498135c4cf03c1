"""The gallery: pictures of the scans that come with the package, each with the command or the Python that drew it.

`make gallery` draws them and writes `gallery.md` beside this file. `make gallery-check` only runs everything again,
small, and compares the page, so that no command in it is out of date; the pictures of two machines may differ in a bit.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import contextlib
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import wavesplat

HERE = Path(__file__).parent
PAGE = HERE / "gallery.md"
PICTURES = HERE / "gallery"
DATA = Path(wavesplat.__file__).parent / "data"
SIZE_PX = 288

IMPORTS = {"np.": "import numpy as np\n", "ws.": "import wavesplat as ws\n"}
CT = 'ct = ws.open("ct_pelvis.nii.gz")\n'
VIEW = 'view = {"camera": ws.Camera.orbit(ct, 25, 15, fit="view"), "size": (288, 288)}\n'


@dataclass(frozen=True)
class Entry:
    """A picture: `command` for the command line, without output and size, or `code` that ends in a picture."""

    name: str
    title: str
    words: str
    command: str = ""
    code: str = ""

    @property
    def file(self) -> str:
        """Name of the picture's file."""
        return f"{self.name}.png"

    def shown(self) -> str:
        """The command as a reader can run it, beside the scan."""
        return f"wavesplat {self.command} --size {SIZE_PX}x{SIZE_PX} -o {self.file}"

    def script(self) -> str:
        """The Python as a reader can run it."""
        names = set(re.findall(r"\w+", self.code))
        needed = CT * bool(names & {"ct", "view"}) + VIEW * ("view" in names and "view =" not in self.code)
        imports = "".join(line for name, line in IMPORTS.items() if name in needed + self.code)
        gap = "" if self.code.startswith("\n") else "\n"  # code that begins with a function has its own two lines
        return f'{imports}{gap}{needed}{self.code}picture.save("{self.file}")\n'


ENTRIES = (
    Entry("bone", "Bones", "A preset, seen from the front left.",
          "render ct_pelvis.nii.gz --preset ct-bone --azimuth 25 --elevation 15"),
    Entry("bone_light", "Light that explains", "Hollows darken, and a light from the upper left casts shadows.",
          "render ct_pelvis.nii.gz --preset ct-bone --azimuth 25 --elevation 15 --occlusion 0.8 --shadow 0.6"),
    Entry("bone_standard", "Standard splatting",
          "The older technique splats colours where this one splats densities; it blurs.",
          code="""picture = ws.study.standard(ct, "ct-bone", background="black", **view)
"""),
    Entry("inside", "From close by", "In perspective, cubic B-spline.",
          "render ct_pelvis.nii.gz --preset ct-bone --azimuth -30 --elevation 35 --perspective 60 --zoom 1.6 "
          "--kernel bspline3"),
    Entry("soft_tissue", "Skin over bones", "Translucent.",
          "render ct_pelvis.nii.gz --preset ct-soft-tissue --azimuth 25 --elevation 15"),
    Entry("materials", "Materials", "Air, fat, soft tissue and bone, mixed by their shares in every place.",
          "render ct_pelvis.nii.gz --materials ct --azimuth 25 --elevation 15"),
    Entry("surfaces", "Surfaces between materials", "Their boundaries strengthened by the gradient.",
          "render ct_pelvis.nii.gz --materials ct --surfaces 0.95 --azimuth 25 --elevation 15"),
    Entry("gradient_opacity", "Gradient opacity", "What is homogeneous recedes, boundaries stay.",
          code="""soft = ws.Look.preset("ct-soft-tissue", ct).transfer_function
edges = ws.TransferFunction(soft.opacity, soft.color, soft.opacity_unit, gradient_opacity=[(15, 0), (120, 1)])
picture = ws.render(ct, edges, **view)
"""),
    Entry("two_dimensional", "Functions of two dimensions",
          "Surfaces at values, as wide as the gradient makes them: skin and bone.",
          code="""skin, bone = (-400, 1.5, 40, "#c08060", 0.02), (300, 1.0, 30, "#fff2d9", 0.7)
surfaces = ws.TransferFunction2D.boundaries([skin, bone])
picture = ws.render(ct, surfaces, **view)
"""),
    Entry("labels", "Labels", "A segmentation beside the scan: one half of the body hidden, its bones a solid colour.",
          code="""segmentation = np.zeros(ct.shape, np.uint8)
segmentation[:, :, : ct.shape[2] // 2] = 1
segmentation[(segmentation == 1) & (ct.samples > 220)] = 2
labels = ws.Labels(segmentation, {1: ws.Label("grey", 0, scan=0), 2: ws.Label("#40a0e0", 0.9, name="bone")})
picture = ws.render(ct, "ct-soft-tissue", labels=labels, **view)
"""),
    Entry("figure", "A figure",
          "With a scale bar, the directions and the colours of the values; as `figure.pdf` or `figure.svg` these are "
          "vectors and text.",
          "render ct_pelvis.nii.gz --preset ct-bone --azimuth 25 --elevation 15 --background white --scale-bar "
          '--letters --colorbar --title "Bones of a pelvis"'),
    Entry("channels", "Channels", "Cells made up by a formula, as two channels of a microscope, with a legend.",
          code="""nuclei, membranes = np.zeros((2, 48, 96, 96), np.float32)
z, y, x = np.mgrid[:48, :96, :96]
for a, b, c in np.random.default_rng(4).uniform((10, 14, 14), (38, 82, 82), (16, 3)):
    distance = np.sqrt((z - a) ** 2 + (y - b) ** 2 + (x - c) ** 2)
    nuclei += 900 / (1 + np.exp(distance - 6))
    membranes += 600 * np.exp(-((distance - 11) ** 2) / 3)
half_um = {"spacing": (0.5, 0.5, 0.5), "unit": "um"}
cells = [
    ws.Layer(ws.Volume(nuclei, **half_um), "fluorescence-cyan", name="nuclei"),
    ws.Layer(ws.Volume(membranes, **half_um), "fluorescence-magenta", name="membranes"),
]
picture = ws.render(cells, size=(288, 288), background="black")
picture = picture.annotated(scale_bar=True, legend=True, legend_at="upper right")
"""),
    Entry("fusion", "Two scans in one picture",
          "Bones of a CT, and a synthetic uptake on its own, coarser grid; bones hide it.",
          code="""lower, upper = ct.bounds
x, y, z = np.meshgrid(*(np.arange(a, b, 6) for a, b in zip(lower, upper)), indexing="ij")
u, v, w = (lower + upper) / 2
spots = [(u, v + 20, w - 90, 24, 8), (u + 45, v - 60, w + 10, 11, 9), (u - 45, v + 10, w + 60, 14, 7)]
uptake = sum(
    most * np.exp(-((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / (2 * wide**2)) for a, b, c, wide, most in spots
)
place = np.diag([6, 6, 6, 1.0])
place[:3, 3] = lower
pet = ws.Volume(uptake.T.astype(np.float32), world_from_index=place, unit="mm", anatomical=True)
hot = ws.TransferFunction.from_colormap("hot", clim=(1, 8), opacity=[0, 0.1, 0.3, 0.6])
layers = [ws.Layer(ct, "ct-bone", name="CT"), ws.Layer(pet, hot, name="uptake")]
picture = ws.render(layers, background="black", **view).annotated(scale_bar=True, colorbar="uptake", orientation="cube")
"""),
    Entry("slice", "A slice", "Coronal, with the letters of the directions and a scale bar.",
          "slice ct_pelvis.nii.gz --plane coronal --window abdomen --letters --scale-bar"),
    Entry("slab", "A thick slab", "The maximum over 40 mm.",
          "slice ct_pelvis.nii.gz --plane coronal --thickness 40 --slab maximum --clim 0,700"),
    Entry("head", "A head", "Magnetic resonance, the brain under a translucent scalp.",
          "render mri_head.nii.gz --preset mr-head --azimuth 50 --elevation 15"),
    Entry("maximum", "Maximum projection", "Vessels are bright.",
          "render mri_head.nii.gz --composite maximum --view left"),
    Entry("depth_shaded", "Depth-shaded maximum", "The same, darker with depth.",
          "render mri_head.nii.gz --composite depth-shaded-maximum --depth-shading 0.7 --view left"),
    Entry("depth_colored", "Depth in colour", "The maximum's value is the brightness, its place the hue.",
          "render mri_head.nii.gz --depth-color turbo --view left --size 288x240 --colorbar"),
    Entry("local_maximum", "First local maximum", "On every ray the first peak above a value.",
          "render ct_pelvis.nii.gz --composite local-maximum --local-threshold 250 --kernel bspline3 "
          "--azimuth 25 --elevation 15"),
    Entry("x_ray", "An x-ray", "The scan's Hounsfield units attenuate a beam.",
          "render ct_pelvis.nii.gz --composite x-ray --view anterior"),
    Entry("surface", "The surface of one value", "The first place where a ray meets it, refined within the sample.",
          "render mri_head.nii.gz --composite first-hit --iso-value 22 --azimuth 50 --elevation 15 --kernel bspline3"),
    Entry("share", "From 2 percent of the wavelet coefficients", "Those below the threshold are dropped.",
          "render mri_head.nii.gz --preset mr-head --azimuth 50 --elevation 15 --threshold 12"),
    Entry("levels", "A coarser level", "At its own resolution, and as bright as the whole.",
          "render mri_head.nii.gz --preset mr-head --azimuth 50 --elevation 15 --wavelet-level 2"),
    Entry("tracts", "Tracts in a head",
          "Curves made up by a formula, coloured by their direction, in a head of glass.",
          code="""head = ws.open("mri_head.nii.gz")
random = np.random.default_rng(7)
t = np.linspace(-1, 1, 60)[:, None]
tracts = []
for side, a, b, c in zip(random.choice([-1, 1], 120), *random.normal(0, 1, (3, 120))):
    arch = [side * (16 + 26 * t**2 + 3 * a), 12 + 62 * t + 4 * np.sin(3 * t + b), 48 - 42 * t**2 + 4 * c]
    tracts.append(np.concatenate(arch, axis=1))
glass = ws.TransferFunction([(6, 0), (14, 0.012), (60, 0.03)], [(0, 0.8, 0.85, 0.95)])
scene = ws.Scene([head, ws.Lines(tracts, color="direction", radius=0.8)], glass, background="black")
picture = scene.render(ws.Camera.orbit(head, 50, 15, fit="view"), size=(288, 288))
"""),
    Entry("spots_and_tracks", "Spots and tracks in cells",
          "Cells made up by a formula; a spot in each nucleus, and the way that it took, coloured by time.",
          code="""cells = np.zeros((48, 96, 96), np.float32)
z, y, x = np.mgrid[:48, :96, :96]
centers = np.random.default_rng(4).uniform((10, 14, 14), (38, 82, 82), (16, 3))
for a, b, c in centers:
    cells += 600 * np.exp(-((np.sqrt((z - a) ** 2 + (y - b) ** 2 + (x - c) ** 2) - 11) ** 2) / 3)
volume = ws.Volume(cells, spacing=(0.5, 0.5, 0.5), unit="um")
spots = 0.5 * centers[:, ::-1]
steps = np.random.default_rng(1).normal(0, 0.35, (16, 40, 3)).cumsum(axis=1)
tracks = [spot + way - way[-1] for spot, way in zip(spots, steps)]
times = [np.arange(40.0)] * 16
geometry = [ws.Points(spots, radius=1.2, color="yellow"), ws.Lines(tracks, values=times, cmap="turbo", radius=0.3)]
picture = ws.render(volume, "fluorescence-magenta", geometry=geometry, size=(288, 288), background="black")
"""),
    Entry("implant", "An implant in bone",
          "Rods and screws in a spine, made of tubes, from behind; bone hides the tips of the screws.",
          code="""heights = [262, 296, 329, 362]
rods = [[(x, 66, 252), (x, 70, 300), (x, 60, 376)] for x in (-26, 18)]
screws = [[(x, 64, z), (-4 + (x + 4) * 0.45, 118, z + 4)] for x in (-26, 18) for z in heights]
metal = [ws.Lines(rods, radius=3.5, color="#b8c4cc"), ws.Lines(screws, radius=2.8, color="#e0c060")]
from_behind = ws.Camera.orbit(ct, 155, 12, fit="view")
picture = ws.render(ct, "ct-bone", from_behind, geometry=metal, size=(288, 288), background="black")
"""),
    Entry("streamlines", "Streamlines in a flow",
          "The ABC flow: its speed as smoke, streamlines coloured by it.",
          code="""

def flow(p):
    x, y, z = np.moveaxis(p, -1, 0)
    return np.stack([np.sin(z) + np.cos(y), np.sin(x) + np.cos(z), np.sin(y) + np.cos(x)], axis=-1)


n, size = 64, 2 * np.pi
grid = np.stack(np.meshgrid(*[np.linspace(0, size, n)] * 3, indexing="ij"), axis=-1)
speed = np.linalg.norm(flow(grid), axis=-1).T.astype(np.float32)
volume = ws.Volume(np.ascontiguousarray(speed), spacing=[size / (n - 1)] * 3, name="speed")
lines = [np.random.default_rng(2).uniform(0, size, (60, 3))]
for _ in range(150):
    halfway = lines[-1] + 0.02 * flow(lines[-1])
    lines.append(lines[-1] + 0.04 * flow(halfway))
paths = [path[((path >= 0) & (path <= size)).all(axis=1)] for path in np.stack(lines, axis=1)]
paths = [path for path in paths if len(path) > 20]
speeds = [np.linalg.norm(flow(path), axis=1) for path in paths]
streams = ws.Lines(paths, values=speeds, cmap="viridis", radius=0.035)
smoke = ws.TransferFunction.from_colormap("gray", clim=(0, 2.5), opacity=[0.03, 0.01, 0])
picture = ws.render(volume, smoke, geometry=[streams], size=(288, 288), background="black")
"""),
    Entry("box", "A box with ticks",
          "The axes of a field, in its unit, with a grid on the far sides.",
          code="""z, y, x = np.mgrid[-1:1:64j, -1:1:64j, -1:1:64j]
field = np.exp(-4 * ((np.hypot(x, y) - 0.55) ** 2 + z**2) * 4).astype(np.float32)
ring = ws.Volume(field, spacing=[2 / 63] * 3, unit="m", name="density")
scene = ws.Scene([ring, ws.Frame(grid=True)], background="white")
picture = scene.render(ws.Camera.orbit(ring, 30, 25, fit="view", zoom=0.8), size=(288, 288))
"""),
    Entry("electrodes", "Electrodes with their names",
          "Balls on a head, with their names beside them.",
          code="""head = ws.open("mri_head.nii.gz")
angles = np.radians([(a, e) for a in (-50, -15) for e in (20, 45, 70)])
around = np.array([(np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)) for a, e in angles])
places = (-3, 5, 15) + (78, 96, 88) * around
names = ["T1", "T2", "T3", "F1", "F2", "F3"]
electrodes = ws.Points(places, radius=5, color="#ffc030", labels=names)
picture = ws.render(head, "mr-head", ws.Camera.orbit(head, 50, 15, fit="view"), geometry=[electrodes], size=(288, 288))
"""),
    Entry("cut", "A head cut open", "The faces of a cut as slices: what was measured there, in greys.",
          "render mri_head.nii.gz --cut-out right-anterior-superior --slice-plane cuts --azimuth -35 --elevation 30"),
    Entry("standing_slice", "A standing slice",
          "A coronal slice in the window of the abdomen, behind the bones and in front of them.",
          code="""slice = ws.SlicePlane(plane="coronal", window="abdomen")
picture = ws.render(ct, "ct-bone", geometry=[slice], background="black", **view)
"""),
    Entry("segments", "Surfaces of segments",
          "Skin and bones as surfaces in the scan, the skin translucent.",
          code="""skin = ws.Surface(ws.mesh(ct, -300), color="#e0b090", opacity=0.25)
bones = ws.Surface(ws.mesh(ct, 250), color="#f4ead0")
clear = ws.TransferFunction([(-200, 0), (0, 0.004), (200, 0.01)], [(0, 0.8, 0.3, 0.2)])
picture = ws.render(ct, clear, geometry=[skin, bones], background="black", **view)
"""),
    Entry("lightbox", "Slices on one sheet",
          "Six axial slices at one scale, each with its position and its directions.",
          code="""places = range(130, 421, 58)
picture = ws.lightbox(ct, "axial", places, window="abdomen", size=(140, 120), scale_bar=True)
"""),
    Entry("activation", "A statistic over anatomy",
          "Values made up by a formula, hidden between -2.5 and 2.5, on a slice of a head.",
          code="""head = ws.open("mri_head.nii.gz")
lower, upper = head.bounds
x, y, z = np.meshgrid(*(np.arange(a, b, 3) for a, b in zip(lower, upper)), indexing="ij")
peaks = [(-36, 20, 40, 10, 9), (40, 24, 40, 11, 7), (4, -50, 30, 12, -8)]
t = sum(most * np.exp(-((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / (2 * r**2)) for a, b, c, r, most in peaks)
place = np.diag([3, 3, 3, 1.0])
place[:3, 3] = lower
t = ws.Volume(t.T.astype(np.float32), world_from_index=place, unit="mm", anatomical=True, name="t")
layer = ws.Layer.overlay(t, "coolwarm", (-8, 8), threshold=2.5)
picture = ws.slice([head, layer], "axial", 40, size=(288, 288)).annotated(colorbar="t", orientation="letters")
"""),
    Entry("attenuated", "Attenuated maximum",
          "What is bright dims what lies behind it, so that the vessels of the neck have a front and a back.",
          code="""head = ws.open("mri_head.nii.gz")
camera = ws.Camera.orbit(head, 50, 15, fit="view")
picture = ws.render(head, composite=ws.AttenuatedMaximum(0.05), camera=camera, size=(288, 288), background="black")
"""),
    Entry("anaglyph", "Two eyes",
          "Bones for glasses of red and cyan.",
          code="""picture = ws.render(ct, "ct-bone", background="black", stereo="anaglyph", **view)
"""),
    Entry("nuclei", "Numbered nuclei",
          "A synthetic segmentation alone: each label gets a colour.",
          code="""z, y, x = np.mgrid[:48, :96, :96]
numbers = np.zeros(z.shape, np.uint16)
for number, (a, b, c) in enumerate(np.random.default_rng(4).uniform((8, 10, 10), (40, 86, 86), (40, 3)), 1):
    numbers[(z - a) ** 2 * 1.4 + (y - b) ** 2 + (x - c) ** 2 < 70] = number
nuclei = ws.Volume(numbers, spacing=(0.5, 0.5, 0.5), unit="um")
camera = ws.Camera.orbit(nuclei, 25, 30, fit="view")
picture = ws.render(nuclei, camera=camera, size=(288, 288), background="black").annotated(scale_bar=True)
"""),
    Entry("porous_rock", "Pores of a rock",
          "Made up by a formula; hollows are dark, cut faces flat.",
          code="""random = np.random.default_rng(8)
noise = np.fft.rfftn(random.normal(size=(80, 80, 80)))
frequency = np.meshgrid(*[np.fft.fftfreq(80)] * 2, np.fft.rfftfreq(80), indexing="ij")
band = np.exp(-((np.sqrt(sum(one**2 for one in frequency)) - 0.05) ** 2) / 0.0004)
rock = np.fft.irfftn(noise * band, s=(80, 80, 80)).astype(np.float32)
volume = ws.Volume(rock / rock.std(), spacing=(4, 4, 4), unit="um")
camera = ws.Camera.orbit(volume, 30, 25, fit="view")
light = ws.Shading(ambient_occlusion=0.8, shadow=0.4)
stone = ws.TransferFunction([(0.05, 0), (0.15, 1)], [(0, 0.85, 0.72, 0.5), (3, 0.6, 0.45, 0.35)])
picture = ws.render(volume, stone, camera, size=(288, 288), background="black", shading=light).annotated(scale_bar=True)
"""),
    Entry("two_fields", "One field in the colours of another",
          "A plume made up by a formula: opaque as its smoke, coloured by its temperature.",
          code="""z, y, x = np.mgrid[0:1:96j, -0.5:0.5:64j, -0.5:0.5:64j]
width = 0.06 + 0.22 * z**1.5
swirl = np.hypot(x - 0.05 * np.sin(9 * z) * z, y - 0.05 * np.cos(9 * z) * z) / width
smoke = np.exp(-(swirl**2)) * (1 + 0.5 * np.sin(14 * x / width + 30 * z) * np.sin(11 * y / width)) * (1 - z**4)
heat = np.exp(-3 * z) * np.exp(-0.5 * swirl**2)
density, temperature = ws.Volume(smoke.astype(np.float32)), ws.Volume(heat.astype(np.float32))
colors = ws.Layer(temperature, ws.TransferFunction.from_colormap("inferno", clim=(-0.15, 0.7)))
opacity = ws.TransferFunction([(0.15, 0), (0.8, 0.25), (1.3, 0.6)], [(0, 1, 1, 1)])
plume = ws.Scene(ws.Layer(density, opacity, color_from=colors, name="plume"), background="black")
picture = plume.render(ws.Camera.orbit(density, 20, 5, fit="view"), size=(288, 288))
"""),
    Entry("cosmic_web", "A density over decades",
          "Filaments made up by a formula, on a scale of logarithms.",
          code="""random = np.random.default_rng(5)
frequency = np.meshgrid(*[np.fft.fftfreq(112)] * 2, np.fft.rfftfreq(112), indexing="ij")
smooth = np.exp(-sum(one**2 for one in frequency) * 1500)
fields = [np.fft.irfftn(np.fft.rfftn(random.normal(size=(112,) * 3)) * smooth, s=(112,) * 3) for _ in range(2)]
away = sum((one / one.std()) ** 2 for one in fields)  # threads are where both fields are zero
density = ws.Volume((10 ** (3 - 8 * away)).astype(np.float32))
web = ws.TransferFunction.from_colormap("inferno", clim=(3, 1000), log=True, opacity=[0, 0.01, 0.05, 0.3, 0.8])
picture = ws.render(density, web, ws.Camera.orbit(density, 30, 20, fit="view"), size=(288, 288), background="black")
"""),
    Entry("orbital", "An orbital",
          "A wave function with two signs, known by its values: red is positive, blue negative.",
          code="""x, y, z = np.meshgrid(*[np.linspace(-11, 11, 80)] * 3, indexing="ij")
orbital = z * (x**2 - y**2) * np.exp(-np.sqrt(x**2 + y**2 + z**2) / 1.05)
orbital = ws.Volume((orbital.T / np.abs(orbital).max()).astype(np.float32), spacing=[22 / 79] * 3, unit="angstrom")
lobes = ws.TransferFunction.diverging(0.4)
picture = ws.render(orbital, lobes, ws.Camera.orbit(orbital, 25, 20, fit="view"), size=(288, 288), background="black")
"""),
    Entry("isolines", "Lines of equal value",
          "The potential of three charges on a slice, and its lines.",
          code="""z, y, x = np.mgrid[-1:1:64j, -1:1:64j, -1:1:64j]
charges = [(-0.4, 0.1, 1), (0.45, -0.2, -1), (0.1, 0.6, 0.6)]
potential = sum(q / np.sqrt((x - a) ** 2 + (y - b) ** 2 + z**2 + 0.02) for a, b, q in charges).astype(np.float32)
field = ws.Volume(potential, spacing=[2 / 63] * 3, unit="cm", name="potential")
lines = ws.Isolines(field, [-3, -2, -1, -0.5, 0.5, 1, 2, 3], color="black")
colors = ws.TransferFunction.from_colormap("coolwarm", clim=(-8, 8))
picture = ws.slice(field, "xy", 1, transfer_function=colors, isolines=lines, size=(288, 288))
picture = picture.annotated(colorbar=True, scale_bar=True)
"""),
)  # fmt: skip

#: The names of the entries of each field, and of each technique, as the page lists them; every entry is in both.
BY_FIELD = {
    "CT": "bone bone_light bone_standard inside soft_tissue materials surfaces gradient_opacity two_dimensional labels "
    "figure slice slab lightbox local_maximum x_ray implant standing_slice segments anaglyph",
    "MRI": "head cut maximum depth_shaded depth_colored attenuated surface share levels",
    "Nuclear medicine": "fusion",
    "Neuroscience": "tracts electrodes activation",
    "Microscopy": "channels spots_and_tracks nuclei",
    "Flow and heat": "streamlines two_fields box",
    "Astronomy": "cosmic_web",
    "Chemistry and physics": "orbital isolines",
    "Materials": "porous_rock",
}
BY_TECHNIQUE = {
    "Transfer functions": "bone soft_tissue head gradient_opacity two_dimensional materials surfaces cosmic_web "
                          "orbital",
    "Light": "bone_light porous_rock",
    "Projections": "maximum depth_shaded depth_colored attenuated local_maximum x_ray",
    "Surfaces of values": "surface segments",
    "Cameras": "inside anaglyph",
    "Several volumes": "channels fusion two_fields activation",
    "Segmentations": "labels nuclei",
    "Slices": "slice slab lightbox isolines standing_slice cut",
    "Geometry": "tracts spots_and_tracks implant streamlines electrodes",
    "Figures": "figure box",
    "Wavelets": "share levels",
    "Splatting of old": "bone_standard",
}  # fmt: skip


def run(entry: Entry, folder: Path, *, small: bool) -> None:
    """Draw a picture, in a folder with the scans."""
    if entry.command:
        shown = entry.shown()
        command = [sys.executable, "-m", "wavesplat", *shlex.split(shown)[1:]]
    else:
        shown = entry.script()
        command = [sys.executable, "-c", shown]
    if small:
        command = [part.replace(f"{SIZE_PX}x{SIZE_PX}", "96x96").replace("(288, 288)", "(96, 96)") for part in command]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603 - our own
    if done.returncode != 0 or not (folder / entry.file).exists():
        raise SystemExit(f"the gallery's {entry.name!r} failed:\n{shown}\n{done.stderr}")


@contextlib.contextmanager
def scans() -> Iterator[Path]:
    """A folder with the bundled scans under their names."""
    with tempfile.TemporaryDirectory() as name:
        for file in DATA.glob("*/*.nii.gz"):
            (Path(name) / file.name).symlink_to(file)
        yield Path(name)


def listed(heading: str, groups: dict[str, str]) -> list[str]:
    """Lines with links to all entries, by groups."""
    titles = {entry.name: entry.title for entry in ENTRIES}
    if missing := titles.keys() - set(" ".join(groups.values()).split()):
        raise SystemExit(f"the gallery lists {', '.join(sorted(missing))} in no group of {heading!r}")
    lines = [f"## {heading}", ""]
    for group, names in groups.items():
        links = (f"[{titles[name]}](#{titles[name].lower().replace(' ', '-')})" for name in names.split())
        lines.append(f"- **{group}**: {', '.join(links)}.")
    return [*lines, ""]


def page() -> str:
    """Markdown text of the gallery."""
    words = (
        "Written by `make gallery`, which runs what stands below every picture.\n"
        "The scans come with the package, in `wavesplat/data`."
    )
    parts = ["# Gallery", "", words, "", *listed("By field", BY_FIELD), *listed("By technique", BY_TECHNIQUE)]
    for entry in ENTRIES:
        language, text = ("sh", entry.shown() + "\n") if entry.command else ("python", entry.script())
        picture = f"![{entry.title}](gallery/{entry.file})"
        parts += [f"## {entry.title}", "", entry.words, "", picture, "", f"```{language}", text + "```", ""]
    return "\n".join(parts)


def main() -> int:
    """Draw, or check."""
    parser = argparse.ArgumentParser(description="Draw the gallery.")
    parser.add_argument(
        "--check", action="store_true", help="run everything, small, and compare the page; write nothing"
    )
    check = parser.parse_args().check
    with scans() as folder:
        for entry in ENTRIES:
            run(entry, folder, small=check)
            if not check:
                PICTURES.mkdir(exist_ok=True)
                (PICTURES / entry.file).write_bytes((folder / entry.file).read_bytes())
    if check:
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != page():
            raise SystemExit("docs/gallery.md is not what docs/gallery.py writes; run make gallery")
        print(f"gallery: {len(ENTRIES)} pictures drawn, the page is as written")
        return 0
    for old in PICTURES.glob("*.png"):
        if old.name not in {entry.file for entry in ENTRIES}:
            old.unlink()
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
