"""Files with the transform of a registration, as freeview writes them: `pet.nii.gz:hot:2,8:reg=pet_to_ct.lta`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wavesplat._model.grid import Grid

__all__ = ["MARK", "REG", "REG_HELP", "map_of", "split"]

REG = "[:reg=TRANSFORM]"
MARK = ":reg="
#: Sentence for the help of options.
REG_HELP = "reg=: the file of an affine transform onto INPUT, of ITK, FreeSurfer (.lta) or FLIRT (.mat)."


def split(text: str, option: str) -> tuple[str, str | None]:
    """The text before `:reg=`, and the transform's file behind it, or None."""
    if MARK not in text or Path(text).exists():
        return text, None
    rest, _, transform = text.rpartition(MARK)
    if not (rest and transform):
        raise ArgumentError(f"{option} {text!r} lacks a file; it is FILE{REG}, such as pet.nii.gz:reg=pet_to_ct.lta")
    return rest, transform


def map_of(transform: str, moving: Grid, fixed: Grid, *, quiet: bool) -> NDArray[Any]:
    """The map from the moving scan's world to the fixed one's; what had to be guessed is printed as a note."""
    from wavesplat._cli.printing import warnings_as_notes
    from wavesplat._readers.transform_files import transform_between

    with warnings_as_notes(quiet=quiet):
        return transform_between(transform, moving, fixed)
