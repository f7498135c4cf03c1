"""Playback of a video in Chromium: the facts that its player reports."""

from __future__ import annotations

import json
import queue
import shutil
import subprocess
import tempfile
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
TYPES = {".mp4": "video/mp4", ".webm": "video/webm"}
FLAGS = (
    "--headless=new",
    "--no-sandbox",  # in containers, where the tests are root
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--autoplay-policy=no-user-gesture-required",
)
PAGE = """<!doctype html><video id="film" muted playsinline></video><script>
const film = document.getElementById("film");
const tell = facts => fetch("/told", {method: "POST", body: JSON.stringify(facts)});
const until = name => new Promise(done => film.addEventListener(name, done, {once: true}));
film.onerror = () => tell({error: film.error.message});
(async () => {
  const loaded = until("loadeddata"), ended = until("ended");
  film.src = "/film";
  await loaded;
  const canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
  [canvas.width, canvas.height] = [film.videoWidth, film.videoHeight];
  // On a busy machine the decoded frame may reach the page a little after its data, and black is drawn until then.
  let first = [];
  for (let tries = 0; tries < 200 && !first.some((value, k) => value && k % 4 < 3); tries++) {
    if (tries) await new Promise(done => setTimeout(done, 25));
    pen.drawImage(film, 0, 0);
    first = [...pen.getImageData(0, 0, canvas.width, canvas.height).data];
  }
  await film.play();
  await ended;
  const {totalVideoFrames} = film.getVideoPlaybackQuality();
  tell({size: [film.videoWidth, film.videoHeight], seconds: film.duration, frames: totalVideoFrames, first});
})().catch(error => tell({error: String(error)}));
</script>"""


def chromium():
    """Path of the browser's program, or None."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


def played(path, *, timeout_secs=90):
    """Facts that the browser reports once it has played a video: size, seconds, frames, bytes of the first frame."""
    told = queue.Queue()

    class Handler(BaseHTTPRequestHandler):
        def log_message(self, *args):
            pass

        def do_GET(self):
            pages = {"/": (PAGE.encode(), "text/html"), "/film": (path.read_bytes(), TYPES[path.suffix])}
            if self.path not in pages:
                self.send_error(404)
                return
            content, kind = pages[self.path]
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def do_POST(self):
            told.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    try:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            address = f"http://127.0.0.1:{server.server_port}/"
            browser = subprocess.Popen(
                [chromium(), *FLAGS, f"--user-data-dir={profile}", address],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            try:
                return told.get(timeout=timeout_secs)
            finally:
                browser.terminate()
                browser.wait(timeout=30)
    finally:
        server.shutdown()
        server.server_close()
