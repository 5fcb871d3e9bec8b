"""Who runs the tasks of a sweep: this process, others beside it, or the workers of a cluster."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Any, ParamSpec, TypeVar

from simmpp.errors import ConfigError

P = ParamSpec("P")
T = TypeVar("T")

CONNECT_S, WORKERS_S = 10, 60
"""Seconds to wait for a cluster's scheduler, and for its first worker."""


class Crew:
    """Anything with the interface of ``concurrent.futures.Executor``."""

    is_elsewhere = False
    """Workers may have other versions installed than this process."""

    def __init__(self, executor: Executor, most_in_flight: int) -> None:
        self.executor = executor
        self.most_in_flight = most_in_flight
        """Tasks that are given out and not back: enough to keep all busy, no more to be lost."""

    def renew(self) -> None:
        """Make the executor anew after one of its workers died, if it doesn't do so itself."""

    def close(self) -> None:
        """End at once, whatever is still in flight."""
        self.executor.shutdown(wait=False, cancel_futures=True)


class _Here(Executor):
    """Runs each task when it is given."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


class Cluster(Crew):
    """The workers of a Dask scheduler, which gives the tasks of a dead worker to others itself."""

    is_elsewhere = True

    def __init__(self, address: str) -> None:
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
        super().__init__(self._client.get_executor(pure=False), 2 * threads)

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


def crew_for(workers: int, cluster: str | None) -> Crew:
    """A cluster's workers, or that many processes; one works right here.

    Raises ConfigError if there is no such cluster.
    """
    from simmpp.sweeps.processes import Processes  # is a Crew itself

    if cluster is not None:
        return Cluster(cluster)
    return Crew(_Here(), 1) if workers == 1 else Processes(workers)
