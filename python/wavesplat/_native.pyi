"""Interface of the compiled module; the public package wraps it and holds the docs that users read."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, TypedDict, TypeGuard, final, type_check_only

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "CHANNEL_COLORS",
    "CHANNEL_COLORS_IN_SPACE",
    "CT_WINDOWS",
    "DARKEST",
    "FARTHEST",
    "FILLED",
    "FULL_COLOR",
    "HOUNSFIELD_ATTENUATION",
    "KINDS_OF_MODALITIES",
    "MAP_NODES",
    "N_SAMPLES_MOST",
    "PRESET_GROUPS",
    "QUANTITIES",
    "RISES",
    "SCALES",
    "SHOWS_THROUGH",
    "SLICER_PREFIX",
    "SOLID_LIGHT",
    "VIEWS",
    "VIEW_ANGLE",
    "Ablation",
    "BlockState",
    "Camera",
    "CameraPath",
    "DecodedVolume",
    "Face",
    "Labels",
    "LazyVolume",
    "Shading",
    "Shapes",
    "Stack",
    "Stream",
    "Survey",
    "TransferFunction",
    "Volume",
    "WaveletVolume",
    "__version__",
    "attenuation",
    "automatic_look",
    "bent",
    "camera_all_around",
    "camera_axes",
    "camera_fields",
    "camera_in_perspective",
    "camera_project",
    "camera_turned",
    "camera_unproject",
    "camera_widened",
    "camera_within",
    "camera_zoomed",
    "cameras_evenly",
    "channel_color",
    "channel_light",
    "channel_ramp",
    "channel_window",
    "check_material",
    "check_part",
    "check_settings",
    "check_state",
    "check_values",
    "checked_view",
    "cleared",
    "curves_fields",
    "distinct_colors",
    "encode_png",
    "exposed",
    "eye_of",
    "eyes_cut",
    "eyes_settled",
    "fit_view",
    "gpu_adapters",
    "gpu_check",
    "gpu_count",
    "gpu_memory",
    "gpu_settle",
    "greys_of_pixels",
    "greys_of_projection",
    "has_two_signs",
    "in_one_unit",
    "in_window",
    "is_block",
    "is_number",
    "is_point",
    "is_whole_range",
    "kind_of_data",
    "label_color",
    "light_step",
    "lightened",
    "lights_of",
    "look_refused",
    "look_texts",
    "looks_like_hounsfield",
    "map_colors",
    "map_is_diverging",
    "map_nodes",
    "map_over",
    "materials_fields",
    "normals_of_faces",
    "opaque_after",
    "orbit_axes",
    "otsu",
    "otsu_of_scan",
    "patched",
    "plain_name",
    "plane",
    "presets",
    "quality_settings",
    "ramp_of_part",
    "raycast",
    "render",
    "render_standard",
    "reported_unit",
    "rgb_bytes",
    "rise_nodes",
    "robust_range",
    "samples_for",
    "scale_nodes",
    "shown_positions",
    "sin_cos_deg",
    "slicer_presets",
    "smallest_budget",
    "splat_ablated",
    "splat_literal",
    "step_for",
    "stored_offset",
    "straight_bytes",
    "table_fields",
    "turn_angles",
    "turn_around",
    "turn_in_place",
    "turn_in_view",
    "unit_factor",
    "unit_guesses",
    "unit_metres",
    "unit_name",
    "view_angles",
    "window_of",
]

__version__: str
#: Share of an opaque projection that shows through the shapes over it.
SHOWS_THROUGH: float
#: Largest ratio of lengths in a picture, such as of view and volume.
FARTHEST: float
#: Share of the picture's height, or width, that the object fills.
FILLED: float
#: Samples at most that are looked at for histograms and cameras, for the kind of data, and for the unit of the values.
N_SAMPLES_MOST: tuple[int, int, int]
#: Angle of view, degrees, of views in perspective that were orthographic.
VIEW_ANGLE: float
#: Deviations of the noise of a background above its median that are far, of a few bright samples.
#: Kinds of data of DICOM's modalities that have a look of their own.
KINDS_OF_MODALITIES: dict[str, str]
#: Names of quantities of calculated maps; p-values, of which low ones matter, are the last.
QUANTITIES: tuple[str, ...]
#: The largest p that counts as significant.
#: Azimuth and elevation, degrees, of the named views.
VIEWS: dict[str, tuple[float, float]]
#: Level and width of windows of CT, Hounsfield units.
CT_WINDOWS: dict[str, tuple[float, float]]
#: Kinds of data that presets are for, and their titles.
PRESET_GROUPS: dict[str, str]
#: Text before the names of presets of 3D Slicer.
SLICER_PREFIX: str
#: Scales of the values of curves, and whether they need no volume.
SCALES: list[tuple[str, bool]]
#: Value of air, which absorbs no x-rays, and absorption per millimetre and unit above it.
HOUNSFIELD_ATTENUATION: tuple[float, float]
#: Settings of the light of solid things.
SOLID_LIGHT: dict[str, Any]
#: Share of a channel's colour at the low end of its window, and the place of the full colour, 0..1.
DARKEST: float
FULL_COLOR: float
#: Colours of a map that is even.
MAP_NODES: int
#: Names of curves of opacity.
RISES: list[str]
#: Conventional colours of channels that have none.
CHANNEL_COLORS: list[tuple[float, float, float]]
#: Lighter ones for pictures in space, in the same order.
CHANNEL_COLORS_IN_SPACE: list[tuple[float, float, float]]

@type_check_only
class RenderResult(TypedDict):
    """`rgba` [height, width, 4] associated; `depth` and `value` [height, width], NaN where nothing is hit."""

    rgba: NDArray[np.float32]
    depth: NDArray[np.float32] | None
    value: NDArray[np.float32] | None
    report: dict[str, Any]

@type_check_only
class FrameArguments(TypedDict):
    """Arguments of a frame, beside its layers and its camera."""

    labels: Labels | None
    width: int
    height: int
    kernel: str
    composite: str
    #: Of the operator, in the order of the fields of `Composite` (crates/core/src/composite.rs).
    numbers: Sequence[float]
    sheets_per_slice: float
    oversampling: float
    psnr: float | None
    like: Mapping[str, float | int | bool | list[float] | list[list[float] | None]] | None
    crop_index: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    crop_world: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    clip_planes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]]
    background: tuple[float, float, float, float] | None
    threads: int | None
    device: str
    depth: bool
    #: Colours, and the world axis that they are along; None is the view.
    depth_colors: tuple[Sequence[tuple[float, float, float]], tuple[float, float, float] | None] | None
    shapes: Shapes | None
    pre_integration: bool
    early_ray_termination: bool

#: First index and end of samples along (z, y, x).
_Box: TypeAlias = tuple[tuple[int, int, int], tuple[int, int, int]]
_LazyLayer: TypeAlias = tuple[
    "LazyVolume", "TransferFunction", "Shading | None", "tuple[LazyVolume, TransferFunction] | None"
]
#: Samples [z, y, x] of a box of a level, and where it begins.
_LevelBox: TypeAlias = tuple[NDArray[np.float32], tuple[int, int, int]]

@final
class Survey:
    """Statistics, bounds and strided samples of a volume that is not in memory, from one pass over it, box by box.

    Bricks are as small as bounds of `bounds_bytes` allow; `steps` (z, y, x) are the steps of strided samples.
    """

    def __new__(
        cls,
        shape: tuple[int, int, int],
        kernel: str,
        bounds_bytes: int,
        steps: Sequence[tuple[int, int, int]],
    ) -> Survey: ...
    @staticmethod
    def from_parts(
        shape: tuple[int, int, int],
        kernel: str,
        side: int,
        statistics: tuple[float, float, int],
        bounds: NDArray[np.float32],
        strided: Sequence[tuple[tuple[int, int, int], NDArray[np.float32]]],
    ) -> Survey: ...
    def add(self, samples: NDArray[Any], lo: tuple[int, int, int]) -> None: ...
    def add_prepared(
        self,
        samples: NDArray[Any],
        lo: tuple[int, int, int],
        inner: _Box,
        kernel: str,
        statistics: tuple[float, float, int],
        world_from_index: NDArray[np.float64],
    ) -> None: ...
    def forget_bounds(self) -> None: ...
    @property
    def has_bounds(self) -> bool: ...
    @property
    def statistics(self) -> tuple[float, float, int]: ...
    def parts(self) -> tuple[int, NDArray[np.float32], list[NDArray[np.float32]]]: ...
    def strided(self, which: int) -> NDArray[np.float32]: ...

@final
class LazyVolume:
    """A volume whose samples are read while it is drawn, for one kernel.

    `light`: which of the strided samples are for light. `level`: shape and affine of the finest level; and affine of a
    finer one, parts of it and of this one, with smallest and largest sample, where its brightness is to be kept.
    """

    def __new__(
        cls,
        name: str,
        shape: tuple[int, int, int],
        world_from_index: NDArray[np.float64],
        *,
        kernel: str,
        is_narrow: bool,
        survey: Survey,
        prepared: Survey | None,
        light: int,
        chunk: tuple[int, int, int],
        sample_bytes: int,
        level: tuple[
            tuple[int, int, int],
            NDArray[np.float64],
            tuple[NDArray[np.float64], _LevelBox, _LevelBox, tuple[float, float]] | None,
        ]
        | None,
    ) -> LazyVolume: ...
    @property
    def value_range(self) -> tuple[float, float]: ...

@final
class BlockState:
    """State of the rays of a block of a base plane between two steps; empty before the first."""

    def __new__(cls) -> BlockState: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> BlockState: ...

@final
class Stream:
    """A frame of lazy volumes: blocks of its base planes, each drawn front to back in steps, of boxes that are read."""

    def __new__(
        cls,
        layers: Sequence[_LazyLayer],
        camera: Camera,
        frame: FrameArguments,
        budget_bytes: int,
        n_blocks: int,
        segment_slices: int | None,
        part: tuple[Sequence[float], Sequence[float]] | None,
    ) -> Stream: ...
    @property
    def n_blocks(self) -> int: ...
    def n_steps(self, block: int) -> int: ...
    def segments(self, block: int) -> list[tuple[int, int]]: ...
    def is_done(self, block: int, state: BlockState) -> bool: ...
    def n_texels(self, block: int) -> int: ...
    def bytes_to_read(self) -> list[int]: ...
    def n_boxes(self) -> int: ...
    def n_rays(self, block: int) -> int: ...
    def peak_sample_bytes(self, block: int) -> int: ...
    def held(self, block: int, step: int) -> list[_Box]: ...
    def reads(self, block: int, step: int, is_first: bool, state: BlockState) -> list[list[_Box]]: ...
    def draw(
        self,
        block: int,
        step: int,
        samples: Sequence[NDArray[Any]],
        state: BlockState,
        progress: Callable[[float], object] | None,
    ) -> BlockState: ...
    def fold(self, segments: Sequence[BlockState]) -> BlockState: ...
    def put(self, block: int, state: BlockState) -> None: ...
    @property
    def n_planes(self) -> int: ...
    def plane_state(self, block: int, state: BlockState) -> tuple[int, BlockState]: ...
    def put_plane(self, plane: int, state: BlockState) -> None: ...
    def picture(self) -> RenderResult: ...

@final
class Volume:
    """Samples [z, y, x] in their own type, shared with NumPy, and the affine `world_from_index` (4 x 4, x y z)."""

    def __new__(cls, samples: NDArray[Any], world_from_index: NDArray[np.float64], name: str) -> Volume: ...
    @property
    def value_range(self) -> tuple[float, float]: ...
    @property
    def n_nonfinite(self) -> int: ...

@final
class WaveletVolume:
    """Retained wavelet coefficients; `keep` says what `amount` is: "threshold", "keep" (a share) or "psnr" (dB)."""

    def __new__(
        cls, volume: Volume, *, family: str, keep: str, amount: float, levels: int | None, peak: bool
    ) -> WaveletVolume: ...
    @staticmethod
    def families() -> list[str]: ...
    @property
    def n_levels(self) -> int: ...
    @property
    def threshold(self) -> float: ...
    @property
    def offset(self) -> float: ...
    @property
    def psnr(self) -> float | None: ...
    @property
    def n_kept_by_level(self) -> list[int]: ...
    @property
    def n_bytes(self) -> int: ...
    def samples(self, weights: Sequence[float]) -> NDArray[np.float32]: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    @property
    def value_range(self) -> tuple[float, float]: ...
    def parts(
        self,
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint64], NDArray[np.float32], tuple[float, float] | None]: ...
    @staticmethod
    def from_parts(
        shape: tuple[int, int, int],
        family: str,
        levels: int,
        threshold: float,
        offset: float,
        has_block: NDArray[np.uint8],
        masks: NDArray[np.uint64],
        values: NDArray[np.float32],
        value_range: tuple[float, float] | None,
    ) -> WaveletVolume: ...
    def decoded(
        self, level: int, weights: Sequence[float], world_from_index: NDArray[np.float64], name: str, cache_bytes: int
    ) -> DecodedVolume: ...

@final
class DecodedVolume:
    """A level of a WaveletVolume, decoded as it is drawn; `every` gives every n-th sample [z, y, x]."""

    @property
    def value_range(self) -> tuple[float, float]: ...
    @property
    def cache_bytes(self) -> int: ...
    def every(self, step: int) -> NDArray[np.float32]: ...

@final
class TransferFunction:
    """Piecewise-linear opacity and colour; `evaluate` gives rows of (red, green, blue, opacity)."""

    def __new__(
        cls,
        opacity: Sequence[tuple[float, float]],
        color: Sequence[tuple[float, float, float, float]],
        opacity_unit: float | None,
        gradient_opacity: Sequence[tuple[float, float]],
    ) -> TransferFunction: ...
    @staticmethod
    def two_dimensional(
        values: Sequence[float],
        magnitudes: Sequence[float],
        rgba: Sequence[tuple[float, float, float, float]],
        opacity_unit: float | None,
        of_fields: bool,
    ) -> TransferFunction: ...
    def evaluate(self, values: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def evaluate_at(self, values: NDArray[np.float64], magnitudes: NDArray[np.float64]) -> NDArray[np.float64]: ...

@final
class Camera:
    """`parallel_scale` (half the view's height, world units) or `view_angle` (vertical, degrees), one of them."""

    def __new__(
        cls,
        position: tuple[float, float, float],
        focal_point: tuple[float, float, float],
        view_up: tuple[float, float, float],
        parallel_scale: float | None,
        view_angle: float | None,
    ) -> Camera: ...

@final
class Shading:
    """Phong coefficients and lights. A light: ("camera" | "world", direction to the light, colour)."""

    def __new__(
        cls,
        ambient: float,
        diffuse: float,
        specular: float,
        specular_power: float,
        gradient_smoothing: float,
        gradient_offset: float,
        unoriented: float,
        even_cuts: float,
        shoulder: float,
        lights: Sequence[tuple[str, tuple[float, float, float], tuple[float, float, float]]],
        ambient_occlusion: float,
        occlusion_radius: float | None,
        shadow: float,
    ) -> Shading: ...

@final
class Labels:
    """Codes [z, y, x], indices into `looks`: (name, (red, green, blue), opacity, scan, tint)."""

    def __new__(
        cls,
        codes: NDArray[np.uint8] | NDArray[np.uint16],
        looks: Sequence[tuple[str, tuple[float, float, float], float, float, float]],
        world_from_index: NDArray[np.float64],
        smooth: bool,
    ) -> Labels: ...

@type_check_only
class ShapePaint(TypedDict):
    """Colours of vertices, positions or points: exactly one of the three is not `None`."""

    rgb: tuple[float, float, float] | None
    #: [n, 4], straight.
    rgba: NDArray[np.float32] | None
    #: A value each, the values of the first and the last colour, and the colours [m, 4]; NaN is not drawn.
    mapped: tuple[NDArray[np.float32], tuple[float, float], NDArray[np.float32]] | None

@type_check_only
class MeshArrays(TypedDict):
    """`vertices` [n, 3], `faces` [m, 3], `normals` [n, 3] or `None` for flat faces; `style`: opacity, lit, clipped."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    normals: NDArray[np.float32] | None
    paint: ShapePaint
    style: tuple[float, bool, bool]

@type_check_only
class PathArrays(TypedDict):
    """`positions` [n, 3]; `starts`: the first position of each path, then n. Either `radius` (world) or `width_px`."""

    positions: NDArray[np.float64]
    starts: NDArray[np.uint32]
    radius: float | None
    width_px: float | None
    paint: ShapePaint
    style: tuple[float, bool, bool]

@type_check_only
class PointArrays(TypedDict):
    """`centers` [n, 3]. Either `radii` [n] (world) or `diameters_px` [n]."""

    centers: NDArray[np.float64]
    radii: NDArray[np.float64] | None
    diameters_px: NDArray[np.float64] | None
    paint: ShapePaint
    style: tuple[float, bool, bool]

@type_check_only
class CardArrays(TypedDict):
    """A picture `rgba` [height, width, 4], straight, on the parallelogram of a corner and two ways."""

    corner: tuple[float, float, float]
    along_x: tuple[float, float, float]
    along_y: tuple[float, float, float]
    rgba: NDArray[np.float32]
    style: tuple[float, bool, bool]

@final
class Shapes:
    """Surfaces, lines, points and pictures in space, in world coordinates (crates/core/src/shapes.rs)."""

    def __new__(
        cls,
        *,
        meshes: Sequence[MeshArrays],
        paths: Sequence[PathArrays],
        points: Sequence[PointArrays],
        cards: Sequence[CardArrays],
    ) -> Shapes: ...
    def bounds(self) -> tuple[list[float], list[float]] | None:
        """Corners of the box that holds all; `None` without shapes."""

def normals_of_faces(vertices: NDArray[np.float64], faces: NDArray[np.uint32]) -> NDArray[np.float64]:
    """Sum [n, 3] of the faces' vectors, of twice their areas, around each vertex (crates/core/src/normals.rs)."""

@final
class Ablation:
    """Parts of the method that are left out or changed; `footprint_entries` count where `footprint` is a table."""

    def __new__(
        cls,
        view_angle_correction: bool,
        kernel_slicing: bool,
        gradient: str,
        footprint: str,
        footprint_entries: int,
    ) -> Ablation: ...

def render(
    layers: Sequence[
        tuple[
            Volume | DecodedVolume | LazyVolume,
            TransferFunction,
            Shading | None,
            tuple[Volume, TransferFunction] | None,
        ]
    ],
    camera: Camera,
    frame: FrameArguments,
    progress: Callable[[float], object] | None,
) -> RenderResult: ...
def smallest_budget(
    layers: Sequence[_LazyLayer],
    camera: Camera,
    frame: FrameArguments,
    segment_slices: int | None,
) -> int:
    """The smallest budget, bytes, with which a stream of these arguments can be drawn."""

_Vector: TypeAlias = tuple[float, float, float]
#: Position, focal point and up of a camera; then `parallel_scale` or `view_angle`, degrees.
_CameraFields: TypeAlias = tuple[_Vector, _Vector, _Vector, float | None, float | None]
#: Axis of a turn, degrees, and number of frames.
_Turn: TypeAlias = tuple[_Vector, float, int]

# Cameras (crates/view). Axes: rows right, up and back, [3, 3]; points [n, 3], world units; angles in degrees.

def sin_cos_deg(angle: float) -> tuple[float, float]: ...
def view_angles(name: str, is_anatomical: bool) -> tuple[float, float]: ...
def orbit_axes(azimuth: float, elevation: float) -> NDArray[np.float64]: ...
def camera_axes(camera: _CameraFields) -> NDArray[np.float64]: ...
def camera_turned(camera: _CameraFields, azimuth: float, elevation: float, roll: float) -> _CameraFields: ...
def camera_zoomed(camera: _CameraFields, factor: float) -> _CameraFields: ...
def camera_widened(camera: _CameraFields, shown: NDArray[np.float64], zoom: float, aspect: float) -> _CameraFields: ...
def camera_project(
    camera: _CameraFields, shown: NDArray[np.float64], size: tuple[int, int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def camera_unproject(
    camera: _CameraFields, places: NDArray[np.float64], depths: NDArray[np.float64], size: tuple[int, int]
) -> NDArray[np.float64]: ...
def fit_view(
    seen_from: NDArray[np.float64],
    corners: NDArray[np.float64],
    shown: NDArray[np.float64] | None,
    zoom: float,
    view_angle: float | None,
    aspect: float,
    is_turn: bool,
) -> _CameraFields: ...
def camera_in_perspective(camera: _CameraFields) -> _CameraFields: ...
def camera_all_around(camera: _CameraFields) -> _CameraFields: ...
def camera_within(camera: _CameraFields, is_level: bool) -> _CameraFields: ...

# Two eyes: their distance and where they converge, world units.

def eyes_settled(camera: _CameraFields, distance: float | None, convergence: float | None) -> tuple[float, float]: ...
def eyes_cut(eyes: tuple[float, float], camera: _CameraFields, height: int) -> tuple[int, float | None]:
    """Columns that are cut off each eye's picture, and the convergence that they give; None is infinity."""

def eye_of(eyes: tuple[float, float], camera: _CameraFields, is_right: bool) -> _CameraFields: ...

@final
class Face:
    """A perspective picture of a panorama of a size (width, height)."""

    @staticmethod
    def of_cube() -> list[Face]: ...
    @staticmethod
    def of_turns(n: int = ...) -> list[Face]: ...
    def camera(
        self, camera: _CameraFields, panorama: tuple[int, int], eye: tuple[bool, float] | None
    ) -> tuple[_CameraFields, tuple[int, int]]:
        """Its camera and its size; `eye`: whether it is the right one of two, and their distance."""

    def places(self, panorama: tuple[int, int]) -> tuple[NDArray[np.uintp], NDArray[np.float64], NDArray[np.float64]]:
        """Numbers of the pixels that it shows, row by row, its weights there, and columns and rows in it."""

@final
class Stack:
    """Samples (x, y, z), affine, spacings and sides in the world of a volume, which choose the view that suits it."""

    def __new__(
        cls, size: tuple[int, int, int], world_from_index: NDArray[np.float64], spacing: _Vector, sides: _Vector
    ) -> Stack: ...
    @property
    def is_thin(self) -> bool: ...
    @property
    def is_placed_by_default(self) -> bool: ...
    @property
    def axis_of_few_slices(self) -> int | None: ...
    @property
    def axis_of_distant_slices(self) -> int | None: ...
    def natural_view(
        self, is_anatomical: bool, is_upright: Callable[[], bool], is_of_patient: Callable[[], bool]
    ) -> tuple[float, float]:
        """Azimuth and elevation, degrees; the questions are asked only where they decide."""

def shown_positions(
    index: NDArray[np.float64],
    values: NDArray[np.float64],
    step: float,
    within: tuple[_Vector, _Vector],
    look: tuple[TransferFunction, bool] | None,
    is_whole: bool,
) -> NDArray[np.float64]:
    """Index positions around what a look, and whether it is of an opaque projection, shows of some samples."""

def turn_angles(turned: _Turn) -> list[float]: ...
def turn_around(turned: _Turn, first: _CameraFields) -> list[_CameraFields]: ...
def turn_in_place(turned: _Turn, camera: _CameraFields) -> list[_CameraFields]: ...
def turn_in_view(
    turned: _Turn,
    azimuth: float,
    elevation: float,
    corners: NDArray[np.float64],
    shown: NDArray[np.float64] | None,
    zoom: float,
    view_angle: float | None,
    aspect: float,
) -> list[_CameraFields]: ...

@final
class CameraPath:
    """A camera for every time between the first and the last key frame."""

    def __new__(cls, keys: Sequence[_CameraFields], times: Sequence[float]) -> CameraPath: ...
    def at(self, time: float) -> _CameraFields: ...

def cameras_evenly(keys: Sequence[_CameraFields], n: int, is_closed: bool) -> list[_CameraFields]: ...
def step_for(n_samples: int, most: int) -> int:
    """The step from one sample to the next along each axis that leaves about `most` of them."""

def robust_range(values: NDArray[np.float64]) -> tuple[float, float]: ...
def otsu(values: NDArray[np.float64], low: float, high: float) -> float: ...
def otsu_of_scan(values: NDArray[np.float64], low: float, high: float) -> tuple[float, float, float]: ...
def looks_like_hounsfield(values: NDArray[np.float64], says_ct: bool, may_be_fractional: bool) -> bool: ...
def stored_offset(values: NDArray[np.float64]) -> float: ...

#: Samples, flat, and their two neighbours along each axis that has any.
_Around: TypeAlias = tuple[NDArray[np.float64], list[tuple[NDArray[np.float64], NDArray[np.float64]]]]

@type_check_only
class KindFacts(TypedDict):
    """Facts of a volume that its kind depends on; `KindFacts` of `crates/look` describes them."""

    name: str
    modality: str | None
    value_unit: str | None
    quantity: str | None
    is_lengths: bool
    has_channel: bool
    is_anatomical: bool
    is_of_wavelets: bool
    is_placed_by_default: bool
    has_no_place: bool
    metres: float | None
    spacing: tuple[float, float, float]
    range: tuple[float, float]
    numbers: str
    is_single: bool

def kind_of_data(
    facts: KindFacts,
    looked_at: _Around,
    finest: _Around | None,
    spread: Callable[[], NDArray[np.float64]],
    is_whole: Callable[[], bool],
) -> tuple[str, str, bool, bool, bool, bool, NDArray[np.float64], NDArray[np.float64], float | None]:
    """Kind; reason; whether samples have noise, few are bright, they were calculated, and they show a patient where
    they are placed as by default; values; their gradients; and the value of samples without data.

    finest : samples side by side, where those looked at are of a coarser level. spread : some millions of samples at
    most, [z, y, x]. is_whole : whether floating-point numbers in memory are all whole.
    """

#: Values and opacities; values, red, green, blue.
_Nodes: TypeAlias = tuple[list[tuple[float, float]], list[tuple[float, float, float, float]]]

#: Name, colour and wavelength of a channel.
_ChannelFacts: TypeAlias = tuple[str, tuple[float, float, float] | None, float | None]
#: The channel of a volume, all of its file, the file's window, whether samples are the red, green or blue of a colour
#: picture, and the largest whole number that their type can hold.
_VolumeChannel: TypeAlias = tuple[
    _ChannelFacts | None, Sequence[_ChannelFacts], tuple[float, float] | None, bool, float | None
]
#: Samples [z, y, x] spread over a volume, its own shape, and its spacing along x, y and z.
_Spread: TypeAlias = tuple[NDArray[np.float64], tuple[int, int, int], tuple[float, float, float]]

@type_check_only
class Subject(TypedDict):
    """A volume whose look is chosen; `Subject` of `crates/look` describes it."""

    facts: KindFacts
    kind: str
    reason: str
    has_few_bright: bool
    values: NDArray[np.float64]
    gradients: NDArray[np.float64]
    fill: float | None
    size: tuple[int, int, int]
    #: Whether there are but a few, the axis along which they are far apart, and whether they are a thin stack.
    slices: tuple[bool, int | None, bool]
    channel: _VolumeChannel
    #: Samples [z, y, x] spread over the volume.
    spread: Callable[[], NDArray[np.float64]]

def look_refused(range: tuple[float, float], has_missing: bool, composite: str | None) -> str | None:
    """Why a volume has no automatic look: "uniform" or "too far apart"; None where it has one."""

def automatic_look(
    subject: Subject, composite: str | None, color: tuple[float, float, float] | None
) -> tuple[_Nodes, float | None, list[tuple[str, Any]] | None, str, bool, str | None, bool, str]:
    """Nodes, opacity unit, settings of the light, operator, whether it is for white, view, whether the volume is cut
    open, and why it was chosen."""

def is_block(samples: NDArray[np.float64], function: TransferFunction) -> bool: ...
def greys_of_projection(of: _Spread, composite: str, is_hounsfield: bool) -> _Nodes: ...
def greys_of_pixels(pixels: NDArray[np.float64], composite: str, range: tuple[float, float]) -> _Nodes: ...
def attenuation(of: _Spread, is_hounsfield: bool) -> tuple[float, float]: ...
def channel_window(
    of: _VolumeChannel, largest: float, samples: Callable[[], NDArray[np.float64]]
) -> tuple[float, float, str]: ...
def is_whole_range(window: tuple[float, float], largest: float) -> bool: ...
def map_over(
    places: NDArray[np.float64],
    colors: NDArray[np.float64],
    is_diverging: bool,
    values: tuple[float, float],
    is_window: bool,
    longest_side: float,
) -> tuple[_Nodes, float | None] | None:
    """Nodes and opacity unit of a map for a volume over another one; None of a window that a diverging map has not."""

def cleared(
    function: TransferFunction,
    made_for: str,
    has_name: bool,
    composite: str,
    range: tuple[float, float],
    longest_side: float,
) -> tuple[list[tuple[float, float]], float | None] | None:
    """Opacities, and their unit, that are clear where the values are least; None where the look is so already."""

def has_two_signs(function: TransferFunction) -> bool: ...
def channel_light(
    color: Sequence[tuple[float, float, float, float]], is_projection: bool
) -> tuple[float, float, tuple[float, float, float], list[tuple[float, float, float, float]]]: ...
def light_step(shape: tuple[int, int, int], world_from_index: NDArray[np.float64]) -> tuple[int, int, int]:
    """Steps (z, y, x) between the samples that light is worked out from."""

def samples_for(
    shape: tuple[int, int, int], part: _Box, kernel: str, n_nonfinite: int, world_from_index: NDArray[np.float64]
) -> _Box:
    """The box of samples that a box of coefficients, or of samples whose holes are filled, is made of."""

def render_standard(
    volume: Volume | DecodedVolume,
    transfer_function: TransferFunction,
    camera: Camera,
    *,
    width: int,
    height: int,
    kernel: str,
    shading: Shading | None,
    oversampling: float,
    buffer: str,
    view_angle_correction: bool,
    crop_index: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    crop_world: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    clip_planes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
    background: tuple[float, float, float, float] | None,
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> RenderResult: ...
def raycast(
    layers: Sequence[tuple[Volume, TransferFunction, Shading | None, tuple[Volume, TransferFunction] | None]],
    camera: Camera,
    *,
    labels: Labels | None,
    width: int,
    height: int,
    kernel: str,
    step: float,
    rays_per_pixel: int,
    crop_index: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    crop_world: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    clip_planes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
    shapes: Shapes | None,
    threads: int | None,
) -> NDArray[np.float32]: ...
def splat_literal(
    volume: Volume,
    transfer_function: TransferFunction,
    camera: Camera,
    *,
    width: int,
    height: int,
    kernel: str,
    shading: Shading | None,
    sheets_per_slice: float,
    threads: int | None,
) -> NDArray[np.float32]: ...
def splat_ablated(
    volume: Volume,
    transfer_function: TransferFunction,
    camera: Camera,
    *,
    ablation: Ablation,
    width: int,
    height: int,
    kernel: str,
    shading: Shading | None,
    sheets_per_slice: float,
    oversampling: float,
    crop_index: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    crop_world: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    clip_planes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> NDArray[np.float32]: ...
def plane(
    volume: Volume | DecodedVolume,
    *,
    origin: tuple[float, float, float],
    across: tuple[float, float, float],
    down: tuple[float, float, float],
    width: int,
    height: int,
    kernel: str,
    slab: str,
    n_planes: int,
    step: tuple[float, float, float],
    threads: int | None,
) -> NDArray[np.float32]: ...
def quality_settings(
    name: str,
    layers: Sequence[
        tuple[
            Volume | DecodedVolume | LazyVolume,
            TransferFunction,
            Shading | None,
            tuple[Volume | LazyVolume, TransferFunction] | None,
        ]
    ],
    operator: tuple[str, Sequence[float]],
    camera: Camera,
    height: int,
) -> tuple[float, float]: ...
def gpu_adapters() -> list[dict[str, Any]]: ...
def gpu_check(name: str) -> dict[str, Any]: ...
def gpu_memory(n_bytes: int | None) -> int: ...
def gpu_count(counts: bool) -> None: ...
def gpu_settle() -> None: ...
def unit_name(text: str) -> str | None: ...
def unit_metres(unit: str | None) -> float | None: ...
def reported_unit(unit: str) -> str: ...
def unit_factor(own: str | None, wanted: str | None) -> float | None: ...
def in_one_unit(
    units: tuple[str | None, str | None, str | None],
) -> tuple[str | None, tuple[float, float, float]]: ...
def unit_guesses(units: tuple[str | None, str | None, str | None]) -> list[str]: ...
def label_color(place: int) -> tuple[float, float, float]: ...
def channel_color(
    facts: tuple[str, tuple[float, float, float] | None, float | None],
    others: Sequence[tuple[str, tuple[float, float, float] | None, float | None]],
) -> tuple[float, float, float] | None: ...
def distinct_colors(
    wanted: Sequence[tuple[float, float, float] | None], own: Sequence[tuple[float, float, float] | None]
) -> list[tuple[float, float, float]]: ...
def opaque_after(n_samples: tuple[int, int, int], spacing: tuple[float, float, float]) -> float: ...
def lightened(color: tuple[float, float, float]) -> tuple[float, float, float]: ...
def channel_ramp(color: tuple[float, float, float], low: float, high: float, n_voxels: float) -> _Nodes: ...
def ramp_of_part(
    color: tuple[float, float, float], low: float, high: float, n_voxels: float
) -> tuple[list[tuple[float, float]], list[tuple[float, float, float, float]]]: ...
def window_of(
    opacity: Sequence[tuple[float, float]], color: Sequence[tuple[float, float, float, float]]
) -> tuple[float, float] | None: ...
def in_window(
    opacity: Sequence[tuple[float, float]],
    color: Sequence[tuple[float, float, float, float]],
    gradients: Sequence[tuple[float, float]],
    window: tuple[float, float],
    wanted: tuple[float, float],
) -> tuple[tuple[list[tuple[float, float]], list[tuple[float, float, float, float]]], list[tuple[float, float]]]: ...
def bent(
    color: Sequence[tuple[float, float, float, float]], window: tuple[float, float], gamma: float
) -> list[tuple[float, float, float, float]]: ...
def exposed(
    opacity: Sequence[tuple[float, float]],
    color: Sequence[tuple[float, float, float, float]],
    exposure: float,
    is_channel: bool,
    is_projection: bool,
) -> tuple[list[tuple[float, float]], list[tuple[float, float, float, float]]]: ...
def plain_name(name: str) -> str: ...
def presets() -> list[dict[str, Any]]: ...
def slicer_presets() -> list[tuple[str, bool, dict[str, Any]]]: ...
def scale_nodes(
    scale: str, nodes: Sequence[Sequence[float]], low: float, high: float, widths: bool
) -> list[list[float]] | None: ...
def map_colors(name: str) -> NDArray[np.float64] | None: ...
def map_is_diverging(name: str) -> bool | None: ...
def map_nodes(
    places: NDArray[np.float64], colors: NDArray[np.float64], range: tuple[float, float, bool, float]
) -> list[tuple[float, float, float, float]]: ...
def rise_nodes(
    name: str | None, numbers: Sequence[float], range: tuple[float, float, bool, float]
) -> list[tuple[float, float]] | None: ...
def encode_png(rgba: NDArray[np.float32], bits: int) -> bytes: ...
def straight_bytes(rgba: NDArray[np.float32]) -> bytes: ...
def rgb_bytes(rgba: NDArray[np.float32], paper: Sequence[float]) -> bytes: ...
def is_number(value: object) -> TypeGuard[float]:
    """Whether a value in a JSON document is a number of absolute value up to 1e30."""

def is_point(value: object) -> bool:
    """Whether a value in a JSON document is three such numbers."""

def check_values(value: object, what: str) -> None:
    """Refuse a document that has whole numbers beyond float64 or texts with half a surrogate pair, by the field."""

def patched(document: Any, operations: Any) -> Any:
    """The document with all operations of a JSON Patch done; it shares what they do not touch with the one before."""

def checked_view(view: Any, crosshair: Sequence[float]) -> dict[str, Any]:
    """The field `view` of a viewer's state, checked, with the defaults of all that it leaves out."""

def check_part(part: object, place: str, name: str) -> None:
    """Refuse a part of a scene's document that lacks a field, or has one too many or of a wrong value."""

def check_state(document: object, before: dict[str, Any]) -> None:
    """Refuse a document that is no state of the viewer; fields that are the same objects as before are right."""

def curves_fields(
    document: Mapping[str, Any], in_look: bool
) -> tuple[
    str,
    list[list[float]],
    list[list[float]],
    float | None,
    list[list[float]],
    float | None,
]:
    """Scale, opacity, colour, unit, gradient opacity and share of the unit of a transfer function's object."""

def table_fields(
    document: Mapping[str, Any],
) -> tuple[list[float], list[float], list[list[float]], float | None, bool]:
    """Values, magnitudes, colours, unit of a table's object, and whether its rows are of a second field."""

def look_texts(document: Mapping[str, Any]) -> list[str | None]:
    """Name, description, kind, view, composite, background and part of a look's object, whose fields are checked."""

def lights_of(shading: object) -> list[Any]:
    """The lights of an object of shading, which may have none."""

def check_settings(document: object, is_light: bool) -> None:
    """Refuse what is no object of a light, or of shading, or has a setting that is not known."""

def materials_fields(document: Mapping[str, Any]) -> tuple[list[Any], float | None]:
    """The entries and the unit of the object of materials."""

def check_material(entry: object, number: int) -> None:
    """Refuse an entry of materials that is no object, or has a field missing or too many."""

def camera_fields(
    document: Mapping[str, Any],
) -> tuple[
    tuple[float, float, float], tuple[float, float, float], tuple[float, float, float], float | None, float | None
]:
    """Position, focal point, up, parallel scale and view angle of a camera's object, or an `ArgumentError`."""
