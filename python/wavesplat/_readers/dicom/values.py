"""Values of DICOM elements, from their bytes: pydicom's own conversion warns of what scanners write."""

from __future__ import annotations

from collections.abc import Container
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

NONE = float("nan")
MANUFACTURER = 0x00080070


class Creator(NamedTuple):
    """A private creator element, the beginning of its value, and the beginning of the manufacturer's name."""

    tag: int
    name: str
    maker: str

    def owns(self, creator: str, manufacturer: str) -> bool:
        """Whether a block is of this creator: anonymisation often removes the creator's name and keeps the block."""
        return creator.startswith(self.name) or (not creator and manufacturer.upper().startswith(self.maker))

    def is_in(self, dataset: Any) -> bool:
        """Whether the block of a dataset is of this creator."""
        return self.owns(text(dataset, self.tag), text(dataset, MANUFACTURER))


def raw_value(dataset: Any, tag: int) -> tuple[bytes, bool]:
    """The bytes of a value, and whether the low ones come first; no bytes where there is no such element."""
    if tag not in dataset:
        # Only the sequences of the file's own group are converted.
        return b"", True
    element = dataset.get_item(tag)
    value = element.value
    if isinstance(value, bytes):
        return value, bool(getattr(element, "is_little_endian", True))
    return ("" if value is None else str(value)).encode("latin-1", "replace"), True


def as_text(raw: tuple[bytes, bool]) -> str:
    """Bytes as text, without padding."""
    return raw[0].decode("latin-1").strip(" \0")


def as_numbers(raw: tuple[bytes, bool], encoding: str) -> list[float]:
    """All numbers of a value. "decimal": text, split at backslashes, none if a part is no number; or "f4", "u2", ..."""
    content, is_little = raw
    if encoding == "decimal":
        parts = (part.strip(" \0") for part in as_text(raw).split("\\"))
        try:
            return [float(part) for part in parts if part]
        except ValueError:
            return []
    dtype = np.dtype(encoding).newbyteorder("<" if is_little else ">")
    whole = content[: len(content) // dtype.itemsize * dtype.itemsize]
    found: list[float] = np.frombuffer(whole, dtype).astype(np.float64).tolist()
    return found


def text(dataset: Any, tag: int) -> str:
    """The text of an element; empty where there is none."""
    return as_text(raw_value(dataset, tag))


def numbers(dataset: Any, tag: int, count: int, encoding: str = "decimal") -> NDArray[np.float64]:
    """`count` numbers of an element; all NaN if it has another count of them."""
    found = as_numbers(raw_value(dataset, tag), encoding)
    return np.array(found if len(found) == count else [NONE] * count)


def whole_numbers(dataset: Any, tag: int, encoding: str) -> tuple[int, ...]:
    """Whole numbers of an element, such as of 16 ("u2") or 32 bits ("u4")."""
    return tuple(int(number) for number in as_numbers(raw_value(dataset, tag), encoding))


def integer(dataset: Any, tag: int) -> int:
    """The first number of an element of 16-bit numbers; 0 where there is none."""
    return next(iter(whole_numbers(dataset, tag, "u2")), 0)


def items(dataset: Any, tag: int) -> Any:
    """The items of a sequence; none where there is no such element."""
    return dataset[tag].value or () if tag in dataset else ()


def first_items(dataset: Any, tags: Container[int]) -> dict[int, Any]:
    """The first item of each of these sequences that is there."""
    found = {}
    for tag in dataset.keys():  # noqa: SIM118 - a dataset iterates over its elements, and converts them
        if tag in tags and (value := dataset[tag].value):
            found[int(tag)] = value[0]
    return found
