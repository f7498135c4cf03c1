"""What the compiled module offers; the public package wraps it and holds the docs that users read."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypedDict, final, type_check_only

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Ablation",
    "Camera",
    "DecodedVolume",
    "Labels",
    "Shading",
    "TransferFunction",
    "Volume",
    "WaveletVolume",
    "__version__",
    "encode_png",
    "plane",
    "quality_settings",
    "raycast",
    "render",
    "render_standard",
    "rgb_bytes",
    "splat_ablated",
    "splat_literal",
    "straight_bytes",
]

__version__: str

@type_check_only
class RenderResult(TypedDict):
    """`rgba` [height, width, 4] associated; `depth` and `value` [height, width], NaN where nothing is hit."""

    rgba: NDArray[np.float32]
    depth: NDArray[np.float32] | None
    value: NDArray[np.float32] | None
    report: dict[str, Any]

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
        shoulder: float,
        lights: Sequence[tuple[str, tuple[float, float, float], tuple[float, float, float]]],
        ambient_occlusion: float,
        occlusion_radius: float | None,
        shadow: float,
    ) -> Shading: ...

@final
class Labels:
    """Codes [z, y, x], places in `looks`: (name, (red, green, blue), opacity, scan, tint)."""

    def __new__(
        cls,
        codes: NDArray[np.uint8] | NDArray[np.uint16],
        looks: Sequence[tuple[str, tuple[float, float, float], float, float, float]],
        world_from_index: NDArray[np.float64],
        smooth: bool,
    ) -> Labels: ...

@final
class Ablation:
    """Which part of the method is left out or changed; `footprint_entries` count where `footprint` is a table."""

    def __new__(
        cls,
        view_angle_correction: bool,
        kernel_slicing: bool,
        gradient: str,
        footprint: str,
        footprint_entries: int,
    ) -> Ablation: ...

def render(
    layers: Sequence[tuple[Volume | DecodedVolume, TransferFunction, Shading | None]],
    camera: Camera,
    *,
    labels: Labels | None,
    width: int,
    height: int,
    kernel: str,
    composite: str,
    iso_value: float | None,
    local_threshold: float | None,
    depth_shading: tuple[float, float] | None,
    attenuation: tuple[float, float] | None,
    sheets_per_slice: float,
    oversampling: float,
    psnr: float | None,
    like: Mapping[str, float | bool | list[float]] | None,
    crop_index: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    crop_world: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    clip_planes: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]],
    background: tuple[float, float, float, float] | None,
    threads: int | None,
    depth: bool,
    pre_integration: bool,
    early_ray_termination: bool,
    progress: Callable[[float], object] | None,
) -> RenderResult: ...
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
    layers: Sequence[tuple[Volume, TransferFunction, Shading | None]],
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
    layers: Sequence[tuple[Volume | DecodedVolume, TransferFunction, Shading | None]],
    camera: Camera,
    height: int,
) -> tuple[float, float]: ...
def encode_png(rgba: NDArray[np.float32], bits: int) -> bytes: ...
def straight_bytes(rgba: NDArray[np.float32]) -> bytes: ...
def rgb_bytes(rgba: NDArray[np.float32], paper: Sequence[float]) -> bytes: ...
