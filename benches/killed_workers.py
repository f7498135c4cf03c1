"""A worker of a Dask cluster that is killed while it draws: `python benches/killed_workers.py [MOMENTS]`.

Two worker processes draw blocks of a made-up volume that is read slowly. One of them is killed at moments from before
the first task to after the last one, evenly apart, of a new cluster each time. Each line tells when it was killed, how
much of the picture had been drawn by then, whether the picture has the bytes of the one that nobody disturbed, or the
error, and how long it took.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections import Counter

import dask
import distributed
import numpy as np

import wavesplat as ws

#: Samples along an axis and along a chunk, and seconds that each read takes.
SIDE, CHUNK, READ_S = 96, 16, 0.04
SIZE = (200, 150)
#: Seconds before the picture of the first moment, and after the undisturbed time of the last.
MARGIN_S = 0.2
#: Share of the picture above which all of it is drawn, but for rounding.
ALL = 1 - 1e-9
LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])


class SlowArray:
    """Shells that are read slowly; it has all that a lazy volume asks of an array."""

    def __init__(self) -> None:
        z, y, x = np.ogrid[-1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j]
        radius = np.sqrt(z * z + y * y + x * x)
        self.samples = (200 * np.exp(-(((radius - 0.6) / 0.1) ** 2))).astype(np.uint8)
        self.shape, self.dtype, self.chunks = self.samples.shape, self.samples.dtype, (CHUNK,) * 3
        self.is_in_memory, self.n_readers, self.reads_together = False, 4, False
        self.name, self.token, self.files = "shells", None, None
        self.seconds = 0.0

    def read(self, lo: tuple[int, ...], hi: tuple[int, ...]) -> np.ndarray:
        """Read a box, slowly."""
        time.sleep(self.seconds)
        return np.ascontiguousarray(self.samples[tuple(slice(a, b) for a, b in zip(lo, hi, strict=True))])

    def read_many(self, boxes: list[tuple[tuple[int, ...], tuple[int, ...]]]) -> list[np.ndarray]:
        """Read several boxes."""
        return [self.read(*box) for box in boxes]


def main(n_moments: int) -> None:
    """Kill a worker at each moment, and print what became of the picture."""
    array = SlowArray()
    lazy = ws.Volume.lazy(array, memory="50 MB", cache=False)
    lazy.survey(0, "linear")
    array.seconds = READ_S
    # Workers import this file.
    os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")])  # noqa: PTH120
    patience = {"distributed.comm.timeouts.connect": "300s", "distributed.comm.timeouts.tcp": "300s"}
    options = {"dashboard_address": None, "host": "127.0.0.1", "memory_limit": "1GiB", "silence_logs": 50}

    def drawn(moment: float | None) -> tuple[np.ndarray | str, float, float]:
        """The picture of a new cluster of which a worker is killed, or its error; seconds; share drawn by then."""
        shares, seen = [0.0], []

        def kill(pid: int) -> None:
            os.kill(pid, signal.SIGKILL)
            seen.append(shares[-1])

        with (
            dask.config.set(patience),
            distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **options) as cluster,
            distributed.Client(cluster, timeout=300) as client,
        ):
            ws.render(lazy, LOOK, "front", size=(40, 30), client=client)  # workers import what they need
            pid = next(iter(client.run(os.getpid).values()))
            killer = threading.Timer(max(moment or 0.0, 0.0), kill, (pid,))
            if moment is not None:
                killer.start()
                time.sleep(max(-moment, 0.0))
            begun = time.perf_counter()
            try:
                frame = {"size": SIZE, "client": client, "progress": shares.append}
                got: np.ndarray | str = ws.render(lazy, LOOK, "isometric", **frame).rgba
            except ws.errors.WavesplatError as error:
                got = f"{type(error).__name__}: {error}"
            taken = time.perf_counter() - begun
            if moment is not None:
                killer.join()
            return got, taken, max(seen, default=1.0)

    wanted, undisturbed, _ = drawn(None)
    print(f"nobody killed: {undisturbed:.1f} s", flush=True)
    longest, counts = 0.0, Counter[str]()
    for moment in np.linspace(-MARGIN_S, undisturbed + MARGIN_S, n_moments):
        got, taken, share = drawn(float(moment))
        told = got if isinstance(got, str) else "same bytes" if np.array_equal(got, wanted) else "OTHER BYTES"
        print(f"killed at {moment:5.2f} s, {100 * share:3.0f} % drawn: {told}, {taken:.1f} s", flush=True)
        longest = max(longest, taken)
        when = "before the picture" if moment < 0 else "before its first block" if share == 0 else "among its blocks"
        counts["after its last block" if share > ALL else when] += 1
    print(f"{n_moments} moments: at most {longest:.1f} s, {undisturbed:.1f} s undisturbed")
    print("; ".join(f"{n} {when}" for when, n in counts.items()))


if __name__ == "__main__":
    # As a module, so that workers can unpickle its class.
    import killed_workers

    killed_workers.main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
