"""Options of a picture: its size and quality, what draws it, and how its scene is seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, get_args

from wavesplat._cli.options.groups import kernel, option, part, picture_size, threads
from wavesplat._cli.options.scene import SceneOptions
from wavesplat._cli.options.view import EyeOptions, ViewOptions, check_eyes, check_view_options
from wavesplat._model.arguments.sampling import Quality


@dataclass(repr=False)
class SamplingOptions:
    """Kernel, quality, threads and device. Without a quality, what is drawn has its own: "normal" for pictures."""

    TITLE: ClassVar = "Size and quality"

    size: Any = picture_size()
    kernel: Any = kernel()
    quality: Any = option(
        help=f"{', '.join(get_args(Quality))}. Normal if not given; of movies between draft and normal.",
        choices=get_args(Quality),
    )
    sheets_per_slice: float | None = option("N", "Instead of what the quality says.")
    oversampling: float | None = option("N", "Instead of what the quality says.")
    psnr: float | None = option("DB", "Choose both for this PSNR against the converged picture.")
    threads: int | None = threads()
    device: str = option(
        "NAME", "What draws: auto, cpu, gpu, or part of a GPU's name (gpu-check lists them).", default="auto"
    )

    def arguments(self) -> dict[str, Any]:
        """The options but the size as arguments of `Scene.render`."""
        from wavesplat._model.arguments.sampling import Sampling

        return {
            "kernel": self.kernel,
            "quality": Sampling(self.sheets_per_slice, self.oversampling, self.quality or "normal"),
            "psnr": self.psnr,
            "threads": self.threads,
            "device": self.device,
        }


@dataclass(repr=False)
class PictureOptions:
    """A scene, and how it is seen and drawn."""

    scene: SceneOptions = part(SceneOptions)
    viewing: ViewOptions = part(ViewOptions)
    eyes: EyeOptions = part(EyeOptions)
    sampling: SamplingOptions = part(SamplingOptions)

    def check(self) -> None:
        """Refuse options that cannot work, before anything is read."""
        self.scene.check()
        check_view_options(self.viewing)
        check_eyes(self.eyes)
