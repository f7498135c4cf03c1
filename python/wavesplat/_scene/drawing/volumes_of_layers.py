"""The volumes of a scene's layers as they are drawn: without a table, the brain alone, or cut open."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from wavesplat._looks.body.brain import brain_of
from wavesplat._looks.body.lazy_table import without_table_in_parts
from wavesplat._looks.body.table import without_table
from wavesplat._looks.look import Look
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render.notes import note_on_table
from wavesplat._render.opened import cut_open_from

if TYPE_CHECKING:
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene


def identity_of(volume: Volume | WaveletVolume) -> tuple[object, int]:
    """Identity of a volume's samples: another one after a change, since `Volume.changed` makes the core anew."""
    if isinstance(volume, LazyVolume):
        return volume._identity
    return (volume._core if isinstance(volume, Volume) else volume), 0


def drawn_volumes(scene: Scene) -> list[Volume | WaveletVolume]:
    """The volumes of the visible layers, and of the fields that colour them."""
    shown = [layer for layer in scene.layers if layer.is_shown]
    fields = [layer.color_from for layer in shown if layer.color_from is not None]
    return [layer.drawn for layer in (*shown, *fields)]


def part_of(
    scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look, *, is_tableless: bool
) -> Volume | WaveletVolume:
    """The part of the volume that is drawn: the look's, or all but a CT's table; all where it is not found."""
    if look.part == "brain":
        found = brain_of(volume)
        return volume if isinstance(found, str) else found
    if look.part == "cut open":
        find = partial(cut_open_from, volume, look.view)
        return scene._cache.get_or_compute((id(volume), "cut open", look.view), identity_of(volume), find)
    if not is_tableless:
        return volume
    if isinstance(volume, LazyVolume | WaveletVolume):
        return _part_of_parts(scene, volume, layer.looked_at if isinstance(layer.volume, Series) else volume, look)
    decided_by = layer.looked_at if isinstance(layer.volume, Series) else volume
    return without_table(volume, decided_by if isinstance(decided_by, Volume) else None) or volume


def _part_of_parts(
    scene: Scene, volume: LazyVolume | WaveletVolume, decided_on: Volume | WaveletVolume, look: Look
) -> Volume | WaveletVolume:
    """The same of samples that are read or decoded as they are drawn, of which more are needed to find a table."""
    if note_on_table(decided_on, look.transfer_function) is None:
        return volume
    key: Any = id(volume), "without table", id(decided_on)
    find = partial(without_table_in_parts, volume, decided_on)
    return scene._cache.get_or_compute(key, identity_of(volume), find) or volume
