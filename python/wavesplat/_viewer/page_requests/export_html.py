"""A page with the picture in it, for mail and archives: it opens anywhere, and holds the state, but runs no script."""

from __future__ import annotations

import base64
import html
import json

from wavesplat._picture.picture import Picture
from wavesplat._viewer.server import messages
from wavesplat._viewer.session.state import ViewerState

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>{title}</title>
<style>
body {{ margin: 0; padding: 1rem; background: #111; color: #ddd; font: 1rem/1.5 system-ui, sans-serif }}
img {{ max-width: 100%; height: auto; display: block; margin: auto }}
pre {{ overflow: auto; max-height: 24rem; background: #1c1c1c; padding: 1rem }}
</style>
</head>
<body>
<main>
<h1>{title}</h1>
<img src="data:image/png;base64,{picture}" width="{width}" height="{height}" alt="{alt}">
<details>
<summary>How it was made</summary>
<p>The state of the viewer. Save it as view.json, put the paths of the volumes in, and open it with
<code>wavesplat view --state view.json</code>.</p>
<pre>{state}</pre>
</details>
</main>
</body>
</html>
"""


def page_of(state: ViewerState, picture: Picture) -> str:
    """The text of the page. It holds names of volumes, and no paths."""
    names = ", ".join(layer["name"] for layer in state.document["layers"])
    looks = ", ".join(layer["look"]["name"] for layer in state.document["layers"])
    width, height = picture.size
    return PAGE.format(
        title=html.escape(names),
        alt=html.escape(f"{names}, drawn as {looks}", quote=True),
        picture=base64.b64encode(messages.png_bytes(picture.rgba)).decode(),
        width=width,
        height=height,
        state=html.escape(json.dumps(state.document, indent=2, ensure_ascii=False)),
    )
