"""Ctrl-C while compiled code runs."""

import os
import signal
import subprocess
import sys
import textwrap
import threading

import interrupts
import pytest
from cases_of_the_day import nightly

from wavesplat._model.volume.wavelet_volume import interruptible


def test_what_is_given_and_raised_comes_through():
    assert interruptible(lambda: 3) == 3
    for error in (KeyError("a"), TimeoutError("b"), KeyboardInterrupt()):

        def fail(error=error):
            raise error

        with pytest.raises(type(error)) as told:
            interruptible(fail)
        assert told.value is error
    found = []
    thread = threading.Thread(target=lambda: found.append(interruptible(threading.current_thread)))
    thread.start()
    thread.join()
    assert found == [thread]


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_ctrl_c_does_not_wait_for_the_work():
    let_go, threads = threading.Event(), []

    def work():
        threads.append(threading.current_thread())
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        let_go.wait(60)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            interruptible(work)
        assert threads[0].is_alive()
    finally:
        signal.signal(signal.SIGINT, before)
        let_go.set()
        threads[0].join()


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@pytest.mark.parametrize(
    "work",
    [
        "ws.WaveletVolume.from_volume(volume, psnr=60)",
        "volume.smoothed(80)",
        "volume.save('a.nrrd')",
        # By day `test_progress.py` interrupts frames, `test_movie_command.py` movies.
        *nightly(
            "wavelets.to_volume()",
            "ws.movie(volume, 'a.gif', ws.Turn(frames=12), size=(400, 400), device='cpu', threads=2)",
            "ws.render(volume, size=(120, 120), quality='high', device='cpu', threads=2)",
        ),
    ],
)
def test_ctrl_c_is_answered_long_before_the_work_is_done(work, tmp_path):
    """Ctrl-C comes after a tenth of the work; less than half of the work is done until it is answered."""
    code = f"""
        import os, signal, time
        from pathlib import Path
        import numpy as np, wavesplat as ws
        from interrupts import ctrl_c_after
        signal.signal(signal.SIGINT, signal.default_int_handler)
        volume = ws.Volume(np.random.default_rng(1).random((200, 200, 200), np.float32))
        wavelets = ws.WaveletVolume.from_volume(volume, keep=0.3) if "wavelets." in {work!r} else None
        begun = time.process_time()
        {work}
        whole = time.process_time() - begun
        for made in Path().iterdir():
            made.unlink()
        with ctrl_c_after(0.1 * whole) as seconds_since:
            try:
                {work}
            except KeyboardInterrupt:
                print(seconds_since() / whole)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=tmp_path,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([os.path.dirname(interrupts.__file__), *sys.path])},  # noqa: PTH120
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 0.5
    assert list(tmp_path.iterdir()) == []
