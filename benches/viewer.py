"""How the viewer moves: a drag in Chromium before a server, both on this machine; `make bench-viewer` runs this.

1024 x 768 pixels, the bundled CT and MRI. Told are the time from the command to its link and to the first picture, from
an event to the picture that shows it, frames a second, bytes, how well moving frames agree with the picture at rest
from where they were seen (PSNR over all pixels), and memory. `--record` writes the table to `benches/records`.

`--beside CHECKOUT` measures each case by another checkout's package right after this one's, to compare two versions on
a machine that is not quiet.
"""

from __future__ import annotations

import argparse
import base64
import datetime as dt
import io
import itertools
import json
import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import wavesplat as ws
from wavesplat._viewer.page_requests.questions import state_from_text
from wavesplat._viewer.session.picturing import picture_of
from wavesplat._viewer.session.state import ViewerState

ROOT = Path(__file__).resolve().parents[1]
#: Name, example, preset, and the PSNR that is asked for while moving.
CASES = (
    ("CT, hard (ct-bone)", "ct_pelvis", "ct-bone", 30),
    ("CT, soft (ct-soft-tissue)", "ct_pelvis", "ct-soft-tissue", 28),
    ("MRI (mr-head)", "mri_head", "mr-head", 30),
    ("MRI, soft (auto)", "mri_head", "auto", 40),
)


def environment(checkout: Path) -> dict[str, str]:
    """Environment in which Python imports the package of a checkout."""
    return {**os.environ, "PYTHONPATH": str(checkout / "python")}


def started(example: str, preset: str, checkout: Path) -> tuple[subprocess.Popen[str], str, float]:
    """Start the command; return its process, its link, and the seconds until it printed the link."""
    begun = time.perf_counter()
    command = [sys.executable, "-m", "wavesplat", "view", "--example", example, "--preset", preset, "--no-browser"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment(checkout)
    )
    assert process.stdout is not None
    return process, process.stdout.readline().strip(), time.perf_counter() - begun


def first_frame_s(example: str, preset: str, checkout: Path) -> float:
    """Seconds from the command to the first frame, for a page that is there already."""
    code = """
import asyncio, json, sys, tornado.httpclient, tornado.websocket
from wavesplat._viewer.server.messages import packed, unpacked
async def run(link):
    address, _, token = link.partition("/#token=")
    request = tornado.httpclient.HTTPRequest(address.replace("http", "ws") + "/socket", headers={"Origin": address})
    socket = await tornado.websocket.websocket_connect(request)
    await socket.write_message(packed({"type": "hello", "protocol": 1, "token": token}), binary=True)
    while unpacked(await socket.read_message())[0]["type"] != "welcome":
        pass
    await socket.write_message(packed({"type": "view", "view": "3d", "size": [1024, 768]}), binary=True)
    while unpacked(await socket.read_message())[0]["type"] != "frame":
        pass
print("ready", flush=True)
asyncio.run(run(sys.stdin.readline().strip()))
print("frame", flush=True)
"""
    page = subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment(checkout),
    )
    assert page.stdin is not None
    assert page.stdout is not None
    page.stdout.readline()
    begun = time.perf_counter()
    process, link, _ = started(example, preset, checkout)
    page.stdin.write(link + "\n")
    page.stdin.flush()
    page.stdout.readline()
    took = time.perf_counter() - begun
    ended(process)
    page.wait()
    return took


def ended(process: subprocess.Popen[str]) -> None:
    """End the command by SIGTERM: jobs that a shell runs in the background ignore Ctrl-C."""
    process.terminate()
    process.wait(timeout=20)


def resident(pid: int) -> float:
    """Megabytes of memory of a process."""
    text = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    found = re.search(r"VmRSS:\s+(\d+)", text)
    return int(found[1]) / 1024 if found else float("nan")


def psnr_of(kept: list[dict[str, Any]], state: ViewerState, size: tuple[int, int]) -> float:
    """Median PSNR, dB, of the pictures that were seen against those at rest from the same cameras."""
    found = []
    for one in kept:
        seen = np.asarray(Image.open(io.BytesIO(base64.b64decode(one["png"].partition(",")[2]))).convert("RGB"), float)
        camera = ws.Camera.from_json(one["camera"])
        exact = np.asarray(picture_of(state.with_camera(camera), "3d", size).to_pil().convert("RGB"), float)
        found.append(10 * np.log10(255**2 / np.mean((seen - exact) ** 2)))
    return statistics.median(found)


def measured(case: tuple[str, str, str, int], seconds: float, checkout: Path) -> dict[str, Any]:
    """Measurements of a case by a checkout's package; no PSNR of another's, whose states may be others."""
    name, example, preset, goal_db = case
    first = statistics.median(first_frame_s(example, preset, checkout) for _ in range(3))
    process, link, said = started(example, preset, checkout)
    try:
        bench = ["node", str(ROOT / "web" / "browser" / "bench.mjs"), link, str(seconds)]
        done = subprocess.run(bench, capture_output=True, text=True, check=True, cwd=ROOT / "web")
        memory = resident(process.pid)
    finally:
        ended(process)
    told = json.loads(done.stdout)
    volume, psnr = getattr(ws.examples, example)(), float("nan")
    if checkout == ROOT:
        state = state_from_text(ViewerState.of(ws.Scene(volume, preset)), json.dumps(told["state"]))
        psnr = psnr_of(told["kept"], state, (told["size"][0], told["size"][1]))
    frames = told["frames"]
    latency = sorted(frame["latency"] for frame in frames if frame["latency"] is not None)
    gaps = sorted(b["at"] - a["at"] for a, b in itertools.pairwise(frames))
    return {
        "name": name if checkout == ROOT else f"{name}, beside",
        "goal_db": goal_db,
        "link_s": said,
        "first_s": first,
        "page_s": told["first_picture_ms"] / 1e3,
        "latency": latency[len(latency) // 2],
        "latency95": latency[int(len(latency) * 0.95)],
        "fps": 1000 * (len(frames) - 1) / (frames[-1]["at"] - frames[0]["at"]),
        "fps5": 1000 / gaps[int(len(gaps) * 0.95)],
        "render": statistics.median(frame["ms"]["render"] for frame in frames),
        "encode": statistics.median(frame["ms"]["encode"] for frame in frames),
        "browser": 1000 * told["task_s"] / len(frames),
        "psnr": psnr,
        "kb": statistics.median(frame["bytes"] for frame in frames) / 1000,
        "mb": memory - volume.samples.nbytes / 2**20,
        "heap": told["heap"] / 2**20,
        "size": told["size"],
    }


def table(rows: list[dict[str, Any]]) -> str:
    """Markdown table of the rows, with goals."""
    head = (
        "| | event to picture, ms, median / 95 % | frames/s, median / 5 % | dB while moving | kB a frame "
        "| drawn / encoded, ms | browser, ms a frame | link / first frame sent / first picture in the page, s "
        "| server above the volume / page, MB |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n"
        "| goal | 55 / 100 | 30 / 15 | 40 soft, 30 hard | 90 | | | 0.4 / 0.8 / 1.6 | 200 / 60 |\n"
    )
    lines = [
        f"| {row['name']} | {row['latency']:.0f} / {row['latency95']:.0f} | {row['fps']:.0f} / {row['fps5']:.0f} | "
        f"{row['psnr']:.1f} | {row['kb']:.0f} | {row['render']:.0f} / {row['encode']:.1f} | {row['browser']:.1f} | "
        f"{row['link_s']:.2f} / {row['first_s']:.2f} / {row['page_s']:.2f} | {row['mb']:.0f} / {row['heap']:.0f} |\n"
        for row in rows
    ]
    return head + "".join(lines)


def main() -> None:
    """Measure, print, and keep if wanted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--record", action="store_true", help="write benches/records/viewer-DATE.md")
    parser.add_argument("--seconds", type=float, default=5.0, help="of each drag")
    parser.add_argument("--only", default="", help="cases whose names have this")
    parser.add_argument("--beside", type=Path, help="folder of another checkout, whose package is built")
    given = parser.parse_args()
    checkouts = [ROOT] if given.beside is None else [ROOT, given.beside.resolve()]
    cases = [case for case in CASES if given.only in case[0]]
    rows = [measured(case, given.seconds, checkout) for case in cases for checkout in checkouts]
    sizes = {tuple(row["size"]) for row in rows}
    processors = os.cpu_count()
    text = table(rows)
    print(text)
    print(f"{sizes}, {processors} processors for server and browser")
    if given.record:
        today = dt.datetime.now(tz=dt.UTC).date()
        path = ROOT / "benches" / "records" / f"viewer-{today}.md"
        path.write_text(
            f"# The viewer, {today}\n\n`make bench-viewer`: 1024 x 768, server and Chromium on the same "
            f"{processors} processors, 60 mouse events a second for {given.seconds:g} s.\n\n{text}",
            encoding="utf-8",
        )
        print(f"wrote {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
