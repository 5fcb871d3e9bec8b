"""Who runs the tasks of a sweep: this process, processes beside it, or the workers of a cluster.

Nothing here imports the simulation: ``simmpp sweep`` begins to start its processes before it has
imported the rest itself.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from simmpp.common.errors import ConfigError
from simmpp.common.modules import PRELOAD, SERVED
from simmpp.sweeps.deadline import note_worker

if TYPE_CHECKING:
    from simmpp.sweeps.journal import Outcome
    from simmpp.sweeps.task import Task

P = ParamSpec("P")
T = TypeVar("T")
RunTask = Callable[["Task"], "Outcome"]
"""What workers do with a task; must be picklable where they are other processes."""

START_METHOD = "spawn" if sys.platform == "win32" else "forkserver"
"""Of processes: a fork of this one would copy the locks of its threads."""
CONNECT_S, WORKERS_S = 10, 60
"""Seconds to wait for a cluster's scheduler, and for its first worker."""


class Pool:
    """An executor as in ``concurrent.futures``, what its workers do, and how much it is given."""

    def __init__(self, executor: Executor, most_in_flight: int, run: RunTask) -> None:
        self.executor, self.run = executor, run
        self.most_in_flight = most_in_flight
        """Tasks that are given out and not back: enough to keep all busy, no more to be lost."""
        self.timeout_s: float | None = None
        """What its tasks are given, where that is known."""

    def submit(self, task: Task) -> Future[Outcome]:
        """Give a task out; to a broken executor it is lost like those already in flight."""
        try:
            return self.executor.submit(self.run, task)
        except BrokenExecutor as error:
            future: Future[Outcome] = Future()
            future.set_exception(error)
            return future

    def renew(self) -> None:
        """Make the executor anew after one of its workers died, if it doesn't do so itself."""

    def close(self) -> None:
        """End at once, whatever is still in flight."""
        self.executor.shutdown(wait=False, cancel_futures=True)


def pool_for(
    workers: int, cluster: str | None, run: RunTask, timeout_s: float | None = None
) -> Pool:
    """A cluster's workers, or that many processes; one works right here.

    Raises ConfigError if there is no such cluster.
    """
    if cluster is not None:
        return DaskCluster(cluster, run)
    pool = Pool(SerialExecutor(), 1, run) if workers == 1 else LocalProcesses(workers, run)
    pool.timeout_s = timeout_s
    return pool


class SerialExecutor(Executor):
    """Runs each task when it is given."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Its outcome, already there."""
        future: Future[T] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


class LocalProcesses(Pool):
    """Processes on this machine, which end with this one however it ends.

    Each holds one end of a pipe, the leash, and ends when the other end is gone: a process that is
    killed can't tell its children, but its end of the pipe is closed for it.
    """

    def __init__(self, workers: int, run: RunTask) -> None:
        self._workers = workers
        executor, self._leash = _leashed(workers)
        super().__init__(executor, 2 * workers, run)  # one runs, one waits beside it

    def renew(self) -> None:
        """A pool is broken for good when one of its processes dies."""
        self.close()
        self.executor, self._leash = _leashed(self._workers)

    def close(self) -> None:
        """Workers end when the leash does."""
        self._leash.close()
        self.executor.shutdown(wait=True, cancel_futures=True)


@contextmanager
def processes(workers: int, preload: str) -> Iterator[Executor]:
    """Processes that have loaded a module, for work that is no task; one works right here.

    In the end, also when interrupted, what they are at is finished and the rest is dropped.
    """
    if workers == 1:
        yield SerialExecutor()
        return
    executor, leash = _leashed(workers, preload)
    try:
        yield executor
    finally:
        executor.shutdown(wait=True, cancel_futures=True)
        leash.close()


def start_server(preload: str = PRELOAD) -> None:
    """Begin to load what workers need while this process imports the same for a second.

    The workers are forks of this server, so they need not load it again. The terminal sends Ctrl-C
    to all processes; this one's children are spared, as it ends them.
    """
    if START_METHOD == "forkserver":
        context: Any = multiprocessing.get_context(START_METHOD)
        context.set_forkserver_preload([preload])
        with _in_environment("PYTHONWARNINGS", "ignore:resource_tracker"):
            # Tells of what a process that was ended has left, and cleans up. Would the server
            # begin it, that unblocked the signals.
            resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # children inherit it
        try:
            with _in_environment(SERVED, str(os.getpid())):
                forkserver.ensure_running()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _in_environment(name: str, value: str) -> Iterator[None]:
    """What processes that are begun here find."""
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before


Leashed = tuple[Executor, Connection]
"""An executor whose processes are there, and what holds them."""


def _leashed(workers: int, preload: str = PRELOAD) -> Leashed:
    """Begin ``workers`` processes. It takes seconds, but Ctrl-C is heard at once.

    So they are begun in another thread, where no signal can leave half a process behind.
    """
    start_server(preload)
    begun: Future[Leashed] = Future()
    threading.Thread(target=_begin_processes, args=(workers, begun), daemon=True).start()
    try:
        return begun.result()
    except KeyboardInterrupt:
        begun.add_done_callback(_let_go)
        raise


def _begin_processes(workers: int, begun: Future[Leashed]) -> None:
    from simmpp.common.cache import cache_folder

    try:
        context: Any = multiprocessing.get_context(START_METHOD)
        held, leash = context.Pipe(duplex=False)
        executor = ProcessPoolExecutor(workers, context, _begin, (held, str(cache_folder())))
        wait([executor.submit(os.getpid) for _ in range(workers)])
        begun.set_result((executor, leash))
    except BaseException as error:
        begun.set_exception(error)


def _let_go(begun: Future[Leashed]) -> None:
    if begun.exception() is None:
        executor, leash = begun.result()
        leash.close()
        executor.shutdown(wait=False)


def _begin(held: Connection, cache: str) -> None:
    """In a new worker: Ctrl-C is the parent's to handle; end when the leash is let go."""
    note_worker()
    warnings.simplefilter("ignore")  # the parent has told them; here they would be told again
    os.environ["SIMMPP_CACHE"] = cache  # the server that forks workers may be older
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(held,), daemon=True).start()


def _end_with(held: Connection) -> None:
    try:
        held.recv_bytes()  # nothing is ever sent: this returns when the other end is closed
    except (EOFError, OSError):
        os._exit(1)  # from a thread, and with a task that may take another hour: no clean way out


class DaskCluster(Pool):
    """The workers of a Dask scheduler, which gives the tasks of a dead worker to others itself."""

    def __init__(self, address: str, run: RunTask) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise ConfigError(
                "--cluster: needs Dask's distributed: pip install 'simmpp[cluster]'"
            ) from None
        try:
            client: Any = Client  # has no types
            with ThreadPoolExecutor(1) as apart:  # from the event loop of a notebook
                apart.submit(asyncio.run, _reach(address)).result()
            self._client = client(address, timeout=CONNECT_S, set_as_default=False)
            self._client.wait_for_workers(1, timeout=WORKERS_S)
        except (OSError, ValueError, TimeoutError) as error:
            raise ConfigError(f"--cluster: value {address!r}: {_line(error)}") from None
        threads = sum(self._client.nthreads().values())
        # not pure: Dask would give equal tasks, as after a failure, the outcome of the first
        super().__init__(self._client.get_executor(pure=False), 2 * threads, run)

    def close(self) -> None:
        """Leave the cluster as it was."""
        self.executor.shutdown(wait=False)  # cancels what is in flight
        self._client.close()


async def _reach(address: str) -> None:
    """Raise OSError or ValueError unless a scheduler can be reached there.

    Asked before a Client is made: one that fails leaves a traceback behind.
    """
    from distributed import Security
    from distributed.comm import connect

    security: Any = Security()  # from Dask's own configuration, as a Client's
    link = await connect(address, timeout=CONNECT_S, **security.get_connection_args("client"))
    link.abort()


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
