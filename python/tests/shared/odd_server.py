"""A web server of a folder that answers some paths oddly."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: An answer: status, headers, and the blocks of the body; None: the file is served as usual.
Answer = tuple[int, dict[str, str], Iterator[bytes]] | None


class OddServer:
    """Serves `folder`; `odd(path)` may give another answer. `asked` lists the requested paths, with their queries."""

    def __init__(self, folder: Path, odd: Callable[[str], Answer] = lambda _: None, missing: int = 404) -> None:
        self.asked: list[str] = []
        own = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self):
                own.asked.append(self.path)
                path = unquote(urlsplit(self.path).path)
                answer = odd(path)
                if answer is None:
                    file = folder / path.lstrip("/")
                    content = file.read_bytes() if file.is_file() else None
                    answer = (missing if content is None else 200, {}, iter([content or b"missing"]))
                status, headers, blocks = answer
                blocks = iter(blocks)
                if "Content-Length" not in headers and "endless" not in headers:
                    body = b"".join(blocks)
                    headers, blocks = {**headers, "Content-Length": str(len(body))}, iter([body])
                self.send_response(status)
                for name, value in headers.items():
                    self.send_header(name, value)
                self.send_header("Connection", "close")
                self.end_headers()
                with contextlib.suppress(OSError):
                    for block in blocks:
                        self.wfile.write(block)

            def log_message(self, *_):
                pass

        class Server(ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, request, client_address):
                pass  # whoever asked went away

        self._server = Server(("127.0.0.1", 0), Handler)
        self.address = f"http://127.0.0.1:{self._server.server_port}"
        threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._server.server_close()
