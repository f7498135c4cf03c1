"""Workers that draw pictures: the workers of a Dask client, or the threads of this process."""

from __future__ import annotations

import importlib
import os
import sys
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from wavesplat import _native
from wavesplat._cluster.waiting import CLOSED, facts_of_workers, lost_scheduler_named
from wavesplat._model.lazy.volume import default_memory
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, LibraryError

#: Most tasks of a picture: schedulers get slow beyond tens of thousands, and a task takes them about a millisecond.
MAX_TASKS = 4000
#: Blocks for each task that runs at once, so that those that are done early get another one.
BLOCKS_PER_THREAD = 4
#: Share of a worker's memory per thread that samples may take: Dask does not see what the renderer holds, and its nanny
#: ends a worker that takes nearly all.
SHARE = 0.3


@dataclass(frozen=True)
class Machines:
    """Number and resources of the tasks that workers run at once."""

    #: Tasks that run at once.
    n_at_once: int
    #: Threads, and bytes for samples, of a task.
    threads: int
    memory: int

    @property
    def n_blocks(self) -> int:
        """Least number of blocks that a picture is cut into."""
        return min(max(1, BLOCKS_PER_THREAD * self.n_at_once), MAX_TASKS // 2)


def machines_of(client: Any) -> Machines:
    """The machines of a client's workers, or of "threads" in this process.

    Raises
    ------
    ArgumentError
        If that is neither, or there is no worker.
    LibraryError
        If workers lack this package, or have another release of it.
    """
    library("dask", extra="dask")
    if isinstance(client, str):
        if client != "threads":
            raise ArgumentError(f'client is {client!r}; give a dask.distributed.Client, or "threads"')
        return Machines(n_at_once=os.cpu_count() or 1, threads=1, memory=default_memory() // (os.cpu_count() or 1))
    if not (hasattr(client, "scheduler_info") and hasattr(client, "compute")):
        raise ArgumentError(f'client is {described(client)}; give a dask.distributed.Client, or "threads"')
    if getattr(client, "asynchronous", False):
        raise ArgumentError(
            "this client is asynchronous, and pictures are drawn synchronously; give Client(..., asynchronous=False), "
            "and draw in a thread if an event loop runs here"
        )
    if client.status in CLOSED:
        raise ArgumentError("this client was closed; give a new dask.distributed.Client")
    with lost_scheduler_named(client):
        facts = facts_of_workers(client, _machine_facts)
    if not facts:
        raise ArgumentError("the cluster has no workers yet; wait for them with client.wait_for_workers(1)")
    _check_releases(facts)
    n_at_once = sum(n_threads for _, _, n_threads, _, _ in facts.values())
    # Several workers of one machine share its processors.
    on_host = Counter[str]()
    for _, host, n_threads, _, _ in facts.values():
        on_host[host] += n_threads
    threads = min(max(1, n_cores // on_host[host]) for _, host, _, n_cores, _ in facts.values())
    limits = [limit // n_threads for _, _, n_threads, _, limit in facts.values() if limit]
    memory = int(SHARE * min(limits)) if limits else default_memory()
    return Machines(n_at_once, threads, memory)


def _check_releases(facts: dict[str, Any]) -> None:
    """Raise a `LibraryError` unless all workers have this release of the package."""
    missing = {worker: found for worker, answer in facts.items() if (found := _other_release(answer)) is not None}
    if missing:
        worker = min(missing)
        raise LibraryError(
            f"{len(missing)} of {len(facts)} workers, such as {worker}, have {missing[worker]}, and this is "
            f"{_native.__version__}; install the same release there (client.run, a plugin such as "
            "distributed.PipInstall, or the image of the workers)"
        )


def _other_release(answer: Any) -> str | None:
    """The package that a worker has, by its answer; None where it is the one of this process."""
    if isinstance(answer, str):
        return f"no wavesplat, or one that cannot be imported ({answer})"
    version = answer[0]
    if version == _native.__version__:
        return None
    return "no wavesplat" if version is None else f"wavesplat {version}"


def _machine_facts(dask_worker: Any = None) -> tuple[str | None, str, int, int, int]:
    """Facts of a worker: release, host, threads, processors, memory."""
    import platform

    version = getattr(sys.modules.get("wavesplat._native"), "__version__", None)
    if version is None:
        with suppress(ImportError):
            version = importlib.import_module("wavesplat._native").__version__
    n_threads = int(dask_worker.state.nthreads)
    limit = getattr(getattr(dask_worker, "memory_manager", None), "memory_limit", None)
    try:
        n_cores = len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        n_cores = os.cpu_count() or 1
    return version, platform.node(), n_threads, n_cores, int(limit or 0)
