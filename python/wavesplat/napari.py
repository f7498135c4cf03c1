"""The plugin for napari, by functions: layers of files, pictures of viewers, and cameras both ways.

In napari itself: File > Open, and Plugins > Draw with Wavesplat.
"""

from __future__ import annotations

from wavesplat._napari.cameras import camera_of, is_mirrored, set_camera
from wavesplat._napari.drawing import draw, scene_of
from wavesplat._napari.reading import layers_of

__all__ = ["camera_of", "draw", "is_mirrored", "layers_of", "scene_of", "set_camera"]
