"""Key frames: the views, looks, clips and times at moments of a movie, which changes between them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY, dataclass

from wavesplat._model.arguments.clips import Clip, clip_tuple
from wavesplat._model.camera.camera import Camera
from wavesplat._public import public
from wavesplat._scene.layer import AnyLook
from wavesplat._system.values import described, number, whole
from wavesplat.errors import ArgumentError


@public
@dataclass(frozen=True)
class KeyFrame:
    """A moment of a movie; between two of them the camera moves, and colours, opacities and clips change evenly.

    A property that a key frame leaves out changes between the key frames beside it that set it, and is the scene's own
    if none does.

    Parameters
    ----------
    time_s : float
        Time of the moment, seconds.
    camera : Camera or str, optional
        Or a view's name. Cameras between are found by `Camera.interpolate`: all are orthographic or all are
        in perspective.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How values are shown; of several layers one for each, in a list, in which None leaves a layer as it is.
    clip : Crop, ClipPlane, CutOut or several of them, optional
        Clips; of the same kinds in all key frames that have any.
    time : int, optional
        Which volume of a series; frames between show the nearest one.

    Raises
    ------
    ArgumentError
        If an argument is of another kind.

    Examples
    --------
    >>> import wavesplat as ws
    >>> keys = [ws.KeyFrame(0, camera="front", look="ct-skin"), ws.KeyFrame(3, camera="left", look="ct-bone")]
    >>> keys[1].time_s
    3.0
    """

    time_s: float
    _: KW_ONLY
    camera: Camera | str | None = None
    look: AnyLook | Sequence[AnyLook] = None
    clip: Clip | Iterable[Clip] | None = None
    time: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_s", number(self.time_s, "time_s of the key frame", "seconds"))
        if not (self.camera is None or isinstance(self.camera, Camera | str)):
            raise ArgumentError(
                f"camera of the key frame is {described(self.camera)}; give a Camera or the name of a view"
            )
        if self.clip is not None:
            object.__setattr__(self, "clip", clip_tuple(self.clip))
        if self.time is not None:
            time = whole(self.time, "time of the key frame", "the number of a volume, from 0")
            object.__setattr__(self, "time", time)
