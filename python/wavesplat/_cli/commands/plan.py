"""`wavesplat plan`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from wavesplat._cli.options.crop import CropOptions, chosen_crop
from wavesplat._cli.options.geometry import GeometryOptions, opened_geometry
from wavesplat._cli.options.groups import Input, Json, option, picture_size
from wavesplat._cli.options.reader import ReaderOptions, open_samples
from wavesplat._cli.printing import print_result


@dataclass(repr=False)
class CostOptions:
    """The picture and the machines whose cost is estimated: arguments of `wavesplat.plan`."""

    size: Any = picture_size("Pixels of the picture.")
    workers: int = option("N", "Machines, or processes, that draw together.", default=1)
    cores: int | None = option("N", "Cores of each; the cores of this machine.")
    segments: int | None = option("N", "Slices of a segment of the rays.")
    read_rate: str | None = option("SIZE", "Bytes a second that a worker reads, such as 250MB; else measured.")
    draw_ns: float | None = option("NS", "Nanoseconds of a texel on a core; else measured.")


def plan(
    input: Input,
    *,
    own: CostOptions,
    cuts: CropOptions,
    showing: GeometryOptions,
    reader: ReaderOptions,
    json: Json = False,
) -> None:
    """Say what a picture of a large file costs before it is drawn: boxes, bytes, tasks, memory, time."""
    from wavesplat._model.lazy.volume import default_memory
    from wavesplat._scene.drawing.cost import plan as plan_of

    lazy = replace(reader, memory=reader.memory or str(default_memory()))
    volume = open_samples(input, lazy, quiet=True)
    geometry = opened_geometry(showing, volume.facts.unit, quiet=True)
    cost = plan_of(volume, geometry=geometry, crop=chosen_crop(cuts), **vars(own))
    print_result(cost.as_json(), "\n".join(cost.lines()), as_json=json)
