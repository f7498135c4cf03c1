"""The page for requests under another address than the server's own: how to reach it over SSH.

Addresses of other hosts and ports are refused, so that no page from elsewhere gets in by a name that resolves to this
machine. Most requests of this kind come through an SSH tunnel from another port.
"""

from __future__ import annotations

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Wavesplat: another address</title>
<h1>This viewer answers at port {port} alone</h1>
<p>The address of this page has another host or port than the viewer&#x27;s own, http://127.0.0.1:{port}/.
Through an SSH tunnel both ends must have the same port: stop the tunnel, run</p>
<pre>ssh -N -L {port}:127.0.0.1:{port} SERVER</pre>
<p>on the machine before you, with the name of the machine that draws for SERVER, and open the link that the command
printed there. If port {port} is taken on your machine, start the command with another one:
<code>wavesplat view --port PORT</code>.</p>
</html>
"""


def page_of(port: int) -> str:
    """The text of the page. It has nothing from the request, and no link that lets in."""
    return PAGE.format(port=port)
