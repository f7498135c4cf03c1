"""A page that sends files to an opener and asks it questions, as the viewer's does, and files for it."""

from __future__ import annotations

import gzip
import threading

import nibabel
import numpy as np

from wavesplat._viewer.opening.opening import Opener


class Asker:
    """A page that sends files and asks questions."""

    def __init__(self, opener, owner="page"):
        self.opener, self.owner, self.number = opener, owner, 0

    def ask(self, question, payload=b"", **arguments):
        self.number += 1
        got, came = [], threading.Event()

        def send(header, data):
            got.append((header, data))
            came.set()

        header = {"type": "ask", "id": self.number, "question": question, "arguments": arguments}
        assert self.opener.answers(header)
        self.opener.receive(self.owner, send, header, payload)
        assert came.wait(60)
        return got[0]

    def answer(self, question, payload=b"", **arguments):
        header, data = self.ask(question, payload, **arguments)
        assert header["type"] == "answer", header
        return header, data

    def refusal(self, question, payload=b"", **arguments):
        header, _ = self.ask(question, payload, **arguments)
        assert header["type"] == "failed", header
        return header["message"]

    def send(self, files, chunk=1 << 16):
        """Send files, by their names in the upload; its number."""
        n_bytes = sum(len(data) for data in files.values())
        upload = self.answer("upload_begin", files=len(files), bytes=n_bytes)[0]["upload"]
        for path, data in files.items():
            for offset in range(0, max(len(data), 1), chunk):
                self.answer("upload", data[offset : offset + chunk], upload=upload, path=path, offset=offset)
        return upload

    def open(self, files, **more):
        return self.answer("open", upload=self.send(files), **more)[0]


def started_page():
    """A page before anything is open, and the states that were begun; for fixtures."""
    begun = []
    opener = Opener(lambda: begun[0] if begun else None, begun.append)
    yield Asker(opener), begun
    opener.close()


def nifti_of(samples, step=2.0):
    image = nibabel.Nifti1Image(np.asarray(samples).T, np.diag([step, step, step, 1]))
    image.header.set_xyzt_units("mm")
    return gzip.compress(image.to_bytes(), mtime=0)


def scan_samples(n=20, seed=1):
    z, y, x = np.mgrid[:n, :n, :n] - (n - 1) / 2
    noise = np.random.default_rng(seed).normal(0, 20, (n, n, n))
    return np.where(x**2 + y**2 + z**2 < (n / 3) ** 2, 500 + noise, noise - 900).astype(np.int16)
