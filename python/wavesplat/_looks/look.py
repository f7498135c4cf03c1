"""Look: all that decides how a volume is shown, but the camera's distance and the picture's size.

What 3D Slicer calls a volume property preset, with the operator and the view that go with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from wavesplat._looks.shading import Shading
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.options import Composite
from wavesplat._public import public

if TYPE_CHECKING:
    from wavesplat._looks.labels import Labels
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["Look"]


@public
@dataclass(frozen=True, kw_only=True)
class Look:
    """A transfer function, the light, the operator, the view and the background that it is made for.

    Parameters
    ----------
    transfer_function : TransferFunction or TransferFunction2D
        Colours and opacities of the values.
    shading : Shading or None
        Light; None draws the colours as given.
    composite : str, default "over"
        Operator along a ray, as for `render`.
    view : str, optional
        Name of a view, as for `render`; None is the view that fits the volume.
    background : str, optional
        Colour behind the volume, as for `render`; None leaves it open.
    labels : Labels, optional
        A segmentation that is drawn with it.
    name : str
        Name of the preset, "auto", or "" for one of your own.
    reason : str
        For which data it is, or why it was chosen for these.

    Examples
    --------
    >>> import wavesplat as ws
    >>> look = ws.Look.auto(ws.examples.ct_pelvis())
    >>> look.composite
    'over'
    """

    transfer_function: TransferFunction | TransferFunction2D
    shading: Shading | None = Shading()
    composite: Composite = "over"
    view: str | None = None
    background: str | None = None
    labels: Labels | None = None
    name: str = ""
    reason: str = ""

    @classmethod
    def preset(cls, name: str, volume: Volume | WaveletVolume | None = None) -> Look:
        """A look by name."""
        return cls(transfer_function=TransferFunction.preset(name, volume), name=name)

    @classmethod
    def auto(cls, volume: Volume | WaveletVolume, composite: Composite | None = None) -> Look:
        """A look for a first picture, by what kind of data the volume holds; `reason` says which, and how that is known.

        Parameters
        ----------
        volume : Volume or WaveletVolume
            Any data.
        composite : str, optional
            Operator; None takes the one that suits the kind of data.

        Raises
        ------
        ArgumentError
            If all samples are equal: there is nothing to tell apart.
        """
        from wavesplat._looks import automatic

        return automatic.automatic(volume, composite)
