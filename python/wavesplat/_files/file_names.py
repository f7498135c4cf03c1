"""Names of volumes that were taken from files, and whether they may be a patient's.

A name stays of this type wherever a volume hands its own on, so that what shows names knows which nobody gave.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Self

#: Name in place of a folder's.
NAMELESS = "volume"


class FileName(str):
    """The name of a file, without its folders.

    is_private : of a scan of a patient by its format, or in place of the name of a folder; such are not shown.
    """

    is_private: bool

    def __new__(cls, text: str, *, is_private: bool = False) -> Self:
        """The name, as text that can be written: bytes that are no UTF-8 are replaced."""
        made = super().__new__(cls, text.encode("utf-8", "surrogatepass").decode("utf-8", "replace"))
        made.is_private = is_private
        return made
