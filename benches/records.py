"""Dated records: `records/DATE.md` holds the last run of each command of that day, with machine and commit."""

from __future__ import annotations

import datetime as dt
import re
import subprocess
import sys
from pathlib import Path

import scenes

sys.path.append(str(scenes.ROOT / "studies"))
import machine

FOLDER = scenes.ROOT / "benches" / "records"


def keep(command: str, text: str) -> Path:
    """Write what a command printed, over what it printed earlier on the same day; the day's file."""
    git = ["git", "-C", str(scenes.ROOT), "describe", "--always", "--dirty"]
    commit = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip()
    day = f"{dt.datetime.now(dt.UTC):%Y-%m-%d}"
    path = FOLDER / f"{day}.md"
    head = f"# Measured on {day}\n\nHow stands at the head of each command's script, what is drawn in `cases.toml`.\n\n"
    kept = path.read_text(encoding="utf-8") if path.exists() else head
    title = f"## `{command}`\n"
    kept = re.sub(rf"^{re.escape(title)}.*?(?=^## |\Z)", "", kept, flags=re.DOTALL | re.MULTILINE)
    section = f"{title}\n{machine.describe()}, commit {commit}.\n\n{text}\n"
    FOLDER.mkdir(exist_ok=True)
    path.write_text(f"{kept.rstrip()}\n\n{section}", encoding="utf-8")
    return path
