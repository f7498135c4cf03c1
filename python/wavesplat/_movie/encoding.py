"""Files of moving pictures, written from frames as they come: floats, associated, shape (height, width, 4).

Videos are encoded by the FFmpeg that PyAV's wheels bring: H.264 by x264, VP9 by libvpx. Colours are converted by BT.709
and marked as such, so that players show the colours of the pictures.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture.picture_files import straight_bytes
from wavesplat._system.libraries import how_to_install, library
from wavesplat.errors import ArgumentError, LibraryError

#: Frames in order, each as `Picture.rgba`.
Frames: TypeAlias = Iterator[NDArray[np.float32]]

#: Codec and options of each kind of video. x264's veryfast is a tenth larger than medium in a third of the time.
VIDEOS: dict[str, tuple[str, dict[str, str]]] = {
    ".mp4": ("libx264", {"preset": "veryfast"}),
    ".webm": ("libvpx-vp9", {"deadline": "good", "cpu-used": "5", "row-mt": "1", "b": "0"}),
}
#: Constant rate factors at which a loss can hardly be seen in a moving picture.
CRF = {".mp4": 18, ".webm": 24}
#: Largest constant rate factors that the encoders take.
MAX_CRF = {".mp4": 51, ".webm": 63}

#: Code points of ITU-T H.273, and FFmpeg's number of the range 16 to 235.
BT709, LIMITED = 1, 1
#: Largest rate of videos, frames a second.
MAX_FPS = 240.0
#: Least rate, frames a second: a frame that stands longer than 100 seconds is a picture, and formats count in
#: milliseconds, in few bits.
MIN_FPS = 0.01
#: Threads of the encoder, which runs beside the renderer.
ENCODER_THREADS = 1
#: Unit of frames' times in a format, and least time of a frame, milliseconds: browsers slow down animations that are
#: faster.
TICK_MS = {".gif": 10, ".webp": 1}
MIN_MS = {".gif": 20, ".webp": 10}
WEBP_QUALITY = 90


def needed_library(suffix: str) -> None:
    """Raise a `LibraryError` if the encoder of a kind of file is not installed."""
    library("av" if suffix in VIDEOS else "PIL.Image", extra="movie")


def check_speed(suffix: str, fps: float) -> None:
    """Raise an `ArgumentError` for more frames a second than a kind of file can show."""
    most = 1000 / MIN_MS[suffix] if suffix in MIN_MS else MAX_FPS
    if not MIN_FPS <= fps <= most:
        raise ArgumentError(
            f"fps is {fps:g}; a {suffix} file shows at least {MIN_FPS:g} and at most {most:g} frames a second"
        )


def check_crf(suffix: str, crf: int) -> None:
    """Raise an `ArgumentError` for a constant rate factor that a kind of file does not have."""
    if suffix not in MAX_CRF:
        raise ArgumentError(f"crf is for videos, {' and '.join(MAX_CRF)}; leave it out for {suffix} files")
    if not 0 <= crf <= MAX_CRF[suffix]:
        raise ArgumentError(f"crf is {crf}; a {suffix} file has 0 to {MAX_CRF[suffix]}, {CRF[suffix]} if not given")


def encode(path: Path, frames: Frames, n: int, *, fps: float, crf: int | None) -> None:
    """Write a video or an animation of `n` frames of one size; the suffix decides."""
    suffix = path.suffix.lower()
    if suffix in VIDEOS:
        _video(path, frames, fps=fps, crf=CRF[suffix] if crf is None else crf)
    else:
        _animation(path, frames, n, fps)


def _video(path: Path, frames: Frames, *, fps: float, crf: int) -> None:
    suffix = path.suffix.lower()
    av = library("av", extra="movie")
    codec, options = VIDEOS[suffix]
    convert = library("av.video.reformatter", extra="movie").VideoReformatter()
    # Chroma has half the resolution, so sides are even: a row or a column more of the same.
    first = next(frames)
    height, width = first.shape[:2]
    padding = ((0, height % 2), (0, width % 2), (0, 0))
    # The same frames give the same file, since it has no time stamps.
    container = {"fflags": "bitexact", **({"movflags": "faststart"} if suffix == ".mp4" else {})}
    with av.open(str(path), "w", options=container) as out:
        try:
            stream = out.add_stream(codec, rate=Fraction(float(fps)).limit_denominator(1001))
        except av.error.FFmpegError as error:
            raise LibraryError(f"this build of PyAV has no encoder {codec}; {how_to_install('movie')}") from error
        stream.width, stream.height = width + width % 2, height + height % 2
        stream.pix_fmt = "yuv420p"
        stream.options = {"crf": str(crf), **options}
        context = stream.codec_context
        context.thread_count = ENCODER_THREADS
        context.color_range, context.colorspace, context.color_primaries, context.color_trc = (
            LIMITED,
            BT709,
            BT709,
            BT709,
        )
        for rgba in chain([first], frames):
            rgb = np.ascontiguousarray(np.pad(_on_black(rgba), padding, mode="edge"))
            frame = convert.reformat(
                av.VideoFrame.from_ndarray(rgb, format="rgb24"),
                format="yuv420p",
                dst_colorspace=BT709,
                dst_color_range=LIMITED,
            )
            frame.color_range, frame.colorspace = LIMITED, BT709
            out.mux(stream.encode(frame))
        out.mux(stream.encode(None))


def _animation(path: Path, frames: Frames, n: int, fps: float) -> None:
    suffix = path.suffix.lower()
    images = library("PIL.Image", extra="movie")
    pictures = (_image(images, rgba, suffix) for rgba in frames)
    first = next(pictures)
    tick = TICK_MS[suffix]
    # Times are rounded, and durations are their differences, so that errors of rounding do not add up.
    ends = [round(1000 / tick * (k + 1) / fps) * tick for k in range(n)]
    durations = [end - start for start, end in zip([0, *ends], ends, strict=False)]
    # Opened here, so that errors of the disk are the system's own `OSError`.
    with path.open("wb") as file:
        options: dict[str, Any] = {"save_all": True, "append_images": pictures, "duration": durations, "loop": 0}
        if suffix == ".gif":
            first.save(file, "GIF", **options)
        else:
            first.save(file, "WEBP", quality=WEBP_QUALITY, **options)


def _image(images: Any, rgba: NDArray[np.float32], suffix: str) -> Any:
    if suffix == ".gif":
        return images.fromarray(_on_black(rgba)).quantize(256)
    return images.fromarray(straight_bytes(rgba))


def _on_black(rgba: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Bytes of red, green and blue over black: associated colours are that already."""
    return np.asarray((np.clip(rgba[..., :3], 0, 1) * 255 + 0.5).astype(np.uint8))
