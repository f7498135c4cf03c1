"""Content that tasks take from workers, and the results of tasks, whatever happens to workers meanwhile.

Scattered data are lost with the workers that have them, and scattering to a worker that has just died waits for it. The
result of a task is made again by another worker instead, from what the scheduler keeps.

Measured by `python benches/killed_workers.py` on two loaded cores: one of two workers killed at 20 moments, from before
the first task to after the last one, gave the same bytes 20 times, within 4.6 s; 1.8 s where nobody was killed.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any

from wavesplat._files.libraries import library
from wavesplat.errors import ClusterError

__all__ = ["N_RETRIES", "done", "facts_of_workers", "held", "result_of"]

#: Retries of a task: a read may fail for once.
N_RETRIES = 3
#: Seconds that are waited for a worker where there is none: nannies start lost ones again.
PATIENCE_S = 60.0
#: Seconds between looks at whether any worker is left.
LOOK_S = 10.0


def held(client: Any, content: bytes, token: str) -> Any:
    """A future of the content, which tasks take as an argument; `token` names it."""
    with warnings.catch_warnings():
        # It goes to the scheduler once, and from there to one worker, which hands it on.
        warnings.filterwarnings("ignore", "Sending large graph", UserWarning)
        return client.submit(_same, content, key=f"wavesplat-frame-{token}", retries=N_RETRIES)


def done(client: Any, futures: Sequence[Any]) -> Iterator[Any]:
    """Futures as they are done. A `ClusterError` where no worker is left for a minute."""
    distributed: Any = library("distributed", extra="dask")
    left = dict.fromkeys(futures)
    alone_since: float | None = None
    while left:
        with suppress(TimeoutError):
            for future in distributed.as_completed(list(left), timeout=LOOK_S):
                del left[future]
                yield future
        if left:
            alone_since = _checked(client, alone_since)


def result_of(client: Any, future: Any) -> Any:
    """The result of a future; errors as of `done`, and a `ClusterError` where workers died of it."""
    distributed: Any = library("distributed", extra="dask")
    (one,) = done(client, [future])
    try:
        return one.result()
    except distributed.KilledWorker as error:
        raise ClusterError(
            f"workers died while they drew the same part of a picture, the last one {error.last_worker}; they may "
            "have too little memory (see their logs), or less of it must be used: memory= of lazy volumes"
        ) from error


def facts_of_workers(client: Any, facts: Callable[..., Any]) -> dict[str, Any]:
    """The answers of a function on each worker; workers that have just died are left out."""
    begun = time.monotonic()
    while True:
        told: dict[str, Any] = client.run(facts, on_error="ignore")
        # None where the cluster knows of workers, and all of them are gone.
        if told or not client.scheduler_info()["workers"] or time.monotonic() - begun > PATIENCE_S:
            return told
        time.sleep(0.5)


def _checked(client: Any, alone_since: float | None) -> float | None:
    """When workers were first missed; None where there are some."""
    if client.scheduler_info()["workers"]:
        return None
    now = time.monotonic()
    if alone_since is not None and now - alone_since > PATIENCE_S:
        raise ClusterError(
            f"all workers of the cluster were lost, and for {PATIENCE_S:.0f} s none has come; start workers, and draw "
            "again"
        )
    return now if alone_since is None else alone_since


def _same(content: bytes) -> bytes:
    """Task: the content."""
    return content
