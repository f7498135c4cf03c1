"""Content that tasks take from workers, and the results of tasks, whatever happens to workers meanwhile.

Scattered data are lost with the workers that have them, and scattering to a worker that has just died waits for it. The
result of a task is made again by another worker instead, from what the scheduler keeps. A scheduler that is gone is
waited for shortly, since it may have been started anew, and so it is for workers.

Measured by `python benches/killed_workers.py` on two loaded cores: one of two workers killed at 20 moments, from before
the first task to after the last one, gave the same bytes 20 times, within 3.1 s; 1.2 s where nobody was killed.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from wavesplat._system.libraries import library
from wavesplat.errors import ClusterError, LibraryError, WavesplatError

#: Retries of a task: a read may fail for once.
N_RETRIES = 3
#: Times that lost tasks are sent again: where the scheduler has forgotten them.
N_TIMES = 3
#: Seconds that are waited for a worker where there is none: nannies start lost ones again.
PATIENCE_S = 60.0
#: Seconds that are waited for a scheduler which does not answer.
SCHEDULER_S = 15.0
#: Seconds between looks at whether the scheduler and any worker are left.
LOOK_S = 5.0
#: States of a client that takes no tasks any more.
CLOSED = ("closing", "closed")


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
    """The result of a future; errors of `done`, a `ClusterError` where workers died of it, and a `LibraryError`."""
    distributed: Any = library("distributed", extra="dask")
    (one,) = done(client, [future])
    try:
        return one.result()
    except distributed.KilledWorker as error:
        raise ClusterError(
            f"workers died while they drew the same part of a picture, the last one {error.last_worker.address}; "
            "they may have too little memory (see their logs), or less of it must be used: memory= of lazy volumes"
        ) from error
    except RuntimeError as error:
        if "deserialization of the task graph" not in str(error):
            raise
        raise LibraryError(
            f"the scheduler cannot read the tasks of a picture ({error.__cause__ or 'see its log'}); it needs the "
            "packages that this process has, the same release of wavesplat among them"
        ) from error


def release(client: Any, futures: Sequence[Any]) -> None:
    """Cancel futures of which nobody wants the results any more."""
    # A client that was closed has released its futures.
    if client.status not in CLOSED:
        client.cancel(futures)


def wait_for_scheduler(client: Any) -> None:
    """Wait while the client has no scheduler. A `ClusterError` where it gets none, or was closed."""
    begun = time.monotonic()
    while client.status != "running":
        if client.status in CLOSED:
            raise ClusterError(
                "the client was closed, by the program or since it has lost its scheduler; draw again with a new "
                "dask.distributed.Client"
            )
        if time.monotonic() - begun > SCHEDULER_S:
            raise ClusterError(
                f"the client has lost the scheduler of its cluster, and for {SCHEDULER_S:.0f} s could not reach it; "
                "start the cluster again, and draw with a new dask.distributed.Client"
            )
        time.sleep(0.1)


def check_times_lost(attempt: int, error: BaseException) -> None:
    """Raise a `ClusterError`, caused by the error, if this attempt, of which the first is 0, was the last."""
    if attempt == N_TIMES:
        raise ClusterError(
            f"the cluster has lost the tasks of a picture {attempt + 1} times; if it draws data that were scattered, "
            "they are lost with their worker: read them from files instead, or scatter them again"
        ) from error


@contextmanager
def lost_scheduler_named(client: Any) -> Iterator[None]:
    """Errors of a client that has no scheduler, which may be of any type, as the `ClusterError` that says so."""
    try:
        yield
    except WavesplatError:
        raise
    except Exception:
        wait_for_scheduler(client)
        raise


def facts_of_workers(client: Any, facts: Callable[..., Any]) -> dict[str, Any]:
    """The answers of a function on each worker; workers that have just died are left out.

    The answer of a worker that cannot import the function is a text that says why.
    """
    begun = time.monotonic()
    while True:
        wait_for_scheduler(client)
        answers: dict[str, Any] = {}
        with suppress(OSError):  # a scheduler that has just gone
            answers = client.run(facts, on_error="return")
        answered = {worker: _import_error(answer) or answer for worker, answer in answers.items()}
        answered = {worker: answer for worker, answer in answered.items() if not isinstance(answer, Exception)}
        # None where the cluster knows of workers, and all of them are gone.
        if answered or not client.scheduler_info()["workers"] or time.monotonic() - begun > PATIENCE_S:
            return answered
        time.sleep(0.5)


def _import_error(answer: Any) -> str | None:
    """The error of a worker that could not import the function it was asked to run; None of all other answers."""
    if not isinstance(answer, Exception):
        return None
    # The scheduler hands on the text of an error that it does not unpickle.
    text = str(answer) if type(answer) is Exception else repr(answer)
    return text if text.startswith(("ImportError", "ModuleNotFoundError", "AttributeError")) else None


def _checked(client: Any, alone_since: float | None) -> float | None:
    """When workers were first missed; None where there are some."""
    wait_for_scheduler(client)
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
