"""Draw the golden pictures anew: `make golden`, in a commit of its own that says why they change.

    python python/tools/make_goldens.py [NAME ...]

Look at each picture that changes before it is committed.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "shared"))

from golden_scenes import GOLDENS, MAX_BYTES, SCENES, path_of, png


def main() -> None:
    """Draw all goldens, or those that are named."""
    unknown = [name for name in sys.argv[1:] if name not in SCENES]
    if unknown:
        sys.exit(f"no such golden picture: {', '.join(unknown)}; there are {', '.join(SCENES)}")
    GOLDENS.mkdir(exist_ok=True)
    for name in sys.argv[1:] or SCENES:
        content, path = png(SCENES[name]()), path_of(name)
        if len(content) > MAX_BYTES:
            sys.exit(f"{name} has {len(content)} bytes, more than the {MAX_BYTES} of a golden picture; draw it smaller")
        same = path.exists() and path.read_bytes() == content
        path.write_bytes(content)
        print(f"{path.relative_to(GOLDENS.parent)}: {len(content)} bytes, {'as it was' if same else 'new'}")


if __name__ == "__main__":
    main()
