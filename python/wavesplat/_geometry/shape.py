"""The base of surfaces, lines, points, slices and frames: names, looks, copies that know their file."""

from __future__ import annotations

from collections.abc import Collection
from copy import copy
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

from wavesplat._model.arguments.types import check_text
from wavesplat._system.values import described, share
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Self


class Shape:
    """Something that stands in space with the volumes of a scene."""

    #: Name of the type in messages and reports.
    KIND: ClassVar[str] = "shape"
    #: Fields that come from the file of a shape that was opened.
    OF_FILE: ClassVar[Collection[str]] = ()
    #: File and options that it was opened with, by which documents name it.
    _source: dict[str, Any] | None = None
    name: str | None
    visible: bool
    #: Assumptions where its file says nothing, and changes of the file's numbers; a sentence each.
    guesses: tuple[str, ...] = ()

    def with_(self, **changes: Any) -> Self:
        """A copy with other fields, of those that it is made with, such as `color` or `opacity`.

        Raises
        ------
        ArgumentError
            If there is no field of that name, or it cannot work.
        """
        known = [field.name for field in fields(self) if field.init]  # type: ignore[arg-type]
        for name in changes:
            if name not in known:
                raise ArgumentError(f"{self._title} has no {name!r} to change; it has {', '.join(known)}")
        changed = replace(self, **changes)  # type: ignore[type-var]
        if not set(changes) & set(self.OF_FILE):
            # A value for each of its parts is not in the file.
            kept = self._source if all(is_one(*change) for change in changes.items()) else None
            changed._set(_source=kept, guesses=self.guesses)
        return changed

    def _with_visible(self, visible: bool) -> Self:
        """A copy that is shown or hidden and shares all arrays, which are not checked again."""
        if visible == self.visible:
            return self
        changed = copy(self)
        changed._set(visible=visible)
        return changed

    @property
    def _is_seen(self) -> bool:
        """Whether something of it is drawn."""
        return self.visible and getattr(self, "opacity", 1.0) > 0

    @property
    def _title(self) -> str:
        """The shape in messages."""
        name = getattr(self, "name", None)
        return f"the {self.KIND} {name!r}" if name else f"the {self.KIND}"

    @property
    def _mapped(self) -> Any:
        """Values, colour map and its ends, of a shape that has values."""
        values = getattr(self, "values", None)
        return None if values is None else (values, getattr(self, "cmap", None), getattr(self, "clim", None))

    def _take(self, found: dict[str, Any]) -> None:
        """Take the fields of an object of another library; what was given by name counts more than what it has."""
        if not found:
            return
        given_values, given_color = getattr(self, "values", None), getattr(self, "color", None)
        own = {name: value for name, value in found.items() if name in self.OF_FILE or getattr(self, name) is None}
        if given_color is not None or (given_values is not None and not isinstance(given_values, str)):
            own.pop("values", None)
        if isinstance(given_values, str):  # the name of an array, which was found
            own["values"] = found["values"]
        if given_values is not None or own.get("values") is not None:
            own.pop("color", None)
        self._set(**own)

    def _set(self, **values: Any) -> None:
        """Set checked fields."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check_style(self) -> None:
        """Check name, opacity and switches, as all shapes have them."""
        for field in ("name", "quantity", "value_unit"):
            given = getattr(self, field, None)
            check_text(given, f"{field} of the {self.KIND}")
            if not isinstance(given, str | None):
                raise ArgumentError(f"{field} of the {self.KIND} is {described(given)}; give a text or None")
        for switch in ("lit", "clipped", "visible"):
            given = getattr(self, switch, None)
            if not isinstance(given, bool | None):
                raise ArgumentError(f"{switch} of {self._title} is {described(given)}; give True or False")
        form = "a number 0..1: 1 is opaque, 0 leaves it out"
        self._set(opacity=share(getattr(self, "opacity", 1.0), f"opacity of {self._title}", form))


def is_one(name: str, value: Any) -> bool:
    """Whether the value of a field is one for all of a shape, and not one for each of its parts."""
    if value is None or isinstance(value, str | int | float):
        return True
    return name in ("color", "clim") and all(isinstance(part, str | int | float) for part in value)
