"""Worker processes on this machine: begun early, gone with the sweep however it ends."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, wait
from contextlib import contextmanager
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from typing import Any

from simmpp.modules import PRELOAD
from simmpp.sweeps.crew import Crew

METHOD = "spawn" if sys.platform == "win32" else "forkserver"
"""A fork of this process would copy the locks of its threads."""


class Processes(Crew):
    """Processes on this machine, which end with this one however it ends."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        executor, self._leash = _pool(workers)
        super().__init__(executor, 2 * workers)

    def renew(self) -> None:
        """A pool is broken for good when one of its processes dies."""
        self.close()
        self.executor, self._leash = _pool(self._workers)

    def close(self) -> None:
        """Workers end when the leash does, those that are only starting included."""
        self._leash.close()
        self.executor.shutdown(wait=True, cancel_futures=True)


def start_server() -> None:
    """Begin to load what workers need while this process imports the same for a second.

    The workers are forks of this server, so they need not load it again.
    """
    if METHOD == "forkserver":
        context: Any = multiprocessing.get_context(METHOD)
        context.set_forkserver_preload([PRELOAD])
        with _sigint(signal.SIG_IGN):  # the terminal sends it to all; the server is spared
            forkserver.ensure_running()


def _pool(workers: int) -> tuple[Executor, Connection]:
    """A pool whose processes are there, and what holds them."""
    from simmpp.compiled import cache_folder

    start_server()
    context: Any = multiprocessing.get_context(METHOD)
    held, leash = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(workers, context, _begin, (held, str(cache_folder())))
    interrupts: list[int] = []
    with _sigint(lambda number, frame: interrupts.append(number)):  # half a process is untidy
        wait([pool.submit(os.getpid) for _ in range(workers)])
    if interrupts:
        leash.close()
        pool.shutdown()
        raise KeyboardInterrupt
    return pool, leash


@contextmanager
def _sigint(handler: Any) -> Iterator[None]:
    """Another answer to Ctrl-C, where there is one: in the main thread."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _begin(held: Connection, cache: str) -> None:
    """In a new worker: Ctrl-C is the parent's to handle; end when the leash is let go."""
    os.environ["SIMMPP_CACHE"] = cache  # the server that forks workers may be older
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(held,), daemon=True).start()


def _end_with(held: Connection) -> None:
    try:
        held.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)
