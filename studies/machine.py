"""The machine that numbers were measured on, in a few words; for `benches` and the studies."""

# ruff: noqa: INP001 - scripts, not a package
from __future__ import annotations

import os
import platform
import re
from pathlib import Path


def describe() -> str:
    """Number of cores and name of the processor."""
    cpuinfo = Path("/proc/cpuinfo")
    text = cpuinfo.read_text(encoding="utf-8") if cpuinfo.exists() else ""
    found = re.search(r"^model name\s*: *(.*)$", text, re.MULTILINE)
    widest = next((f", {name}" for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in text), "")
    return f"{os.cpu_count()} cores, {found[1] if found else platform.machine()}{widest}"
