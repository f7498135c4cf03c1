"""Stand-ins for pages of the viewer: they keep the messages that they get, and confirm frames or not."""

import threading
import time
import zlib

import numpy as np

import wavesplat as ws
from wavesplat._viewer.session.session import Session
from wavesplat._viewer.session.state import ViewerState


def ball(n=24):
    z, y, x = (step - (n - 1) / 2 for step in np.mgrid[:n, :n, :n])
    return ws.Volume((255 - 12 * (x**2 + y**2 + z**2) ** 0.5 * 24 / n).clip(0).astype("uint8"), name="ball")


def state_of(volume=None, **options):
    return ViewerState.of(ws.Scene(ball() if volume is None else volume), **options)


def turned(camera, degrees):
    return {"op": "replace", "path": "/camera", "value": camera.turned(azimuth=degrees).as_json()}


def decoded_values(header, payload):
    """Values of each layer of a slice, and codes of its labels, shape (height, width) each, as the page reads them."""
    shape = header["height"], header["width"]
    pairs = np.frombuffer(zlib.decompress(payload), np.uint8).reshape(-1, 2, *shape).astype(np.uint16)
    codes = np.cumsum(pairs[:, 0] + (pairs[:, 1] << 8), axis=-1, dtype=np.uint16)
    layers = header["values"]["layers"]
    values = [
        np.where(plane == 0xFFFF, np.nan, layer["low"] + plane.astype(np.float64) * layer["step"])
        for layer, plane in zip(layers, codes, strict=False)
    ]
    return [*values, *codes[len(layers) :]]


class Page:
    """A page that confirms every frame, unless `confirms` is False."""

    def __init__(self, session: Session, *, confirms=True):
        self.session, self.confirms = session, confirms
        self.messages = []
        self.seq = 0
        self._new = threading.Condition()
        self.client = session.connect(self._take)

    def _take(self, header, payload):
        with self._new:
            self.messages.append((time.monotonic(), header, payload))
            self._new.notify_all()
        if header["type"] == "frame" and self.confirms:
            self.client.receive({"type": "shown", "view": header["view"], "frame": header["number"]})

    def show(self, view="3d", size=(64, 48)):
        self.client.receive({"type": "view", "view": view, "size": None if size is None else list(size)})

    def patch(self, *operations, moving=False):
        self.seq += 1
        self.client.receive({"type": "patch", "seq": self.seq, "operations": list(operations), "moving": moving})

    def ask(self, question, number=1, **arguments):
        self.client.receive({"type": "ask", "id": number, "question": question, "arguments": arguments})
        return self.wait(lambda header: header.get("id") == number and header["type"] in ("answer", "failed"))

    def wait(self, wanted, timeout=20.0):
        """Wait for the first message that `wanted` accepts; its header and payload."""
        until = time.monotonic() + timeout
        with self._new:
            while True:
                for _, header, payload in self.messages:
                    if wanted(header):
                        return header, payload
                left = until - time.monotonic()
                assert left > 0, [header.get("type") for _, header, _ in self.messages]
                self._new.wait(left)

    def frames(self, **wanted):
        return [
            (header, payload)
            for _, header, payload in list(self.messages)
            if header["type"] == "frame" and all(header[name] == value for name, value in wanted.items())
        ]

    def at_rest(self, view="3d", seq=None):
        """Wait for the picture at rest of the newest change, or of `seq`; its header and payload."""
        last = self.seq if seq is None else seq
        return self.wait(
            lambda header: (
                header["type"] == "frame" and header["view"] == view and header["at_rest"] and header["seq"] >= last
            )
        )
