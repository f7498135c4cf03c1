"""Errors measured for a wanted PSNR, kept for the next pictures that show the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class MeasuredErrors:
    """The measurements of a picture, and those of the last one of its kind."""

    is_wanted: bool
    #: The scene's `Cache`.
    cache: Any
    #: Properties that pictures with the same measurements share, and all that this one shows.
    kind: Any
    shown: Any

    def recalled(self) -> dict[str, Any] | None:
        """The last picture's measurements; None where there are none, or it showed something else."""
        if not self.is_wanted or self.kind not in self.cache.measured:
            return None
        shown, found = self.cache.measured[self.kind]
        measured: dict[str, Any] | None = found if shown == self.shown else None
        return measured

    def remember(self, report: dict[str, Any]) -> None:
        """Keep the measurements in a picture's report."""
        if self.is_wanted and report.get("measured") is not None:
            self.cache.remember(self.kind, self.shown, report["measured"])
