"""Draw anew the converged pictures that tests compare with, and keep them; a quarter of an hour of the processor."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def main() -> int:
    """Run the tests that use references, with the option that writes these; return the exit code."""
    tests = [
        path for path in sorted((ROOT / "python" / "tests").rglob("test_*.py")) if "kept_picture" in path.read_text()
    ]
    command = [sys.executable, "-m", "pytest", "-n", "0", "-m", "", "--make-references", *map(str, tests)]
    return subprocess.run(command, cwd=ROOT, check=False).returncode  # noqa: S603 - our own command


if __name__ == "__main__":
    sys.exit(main())
