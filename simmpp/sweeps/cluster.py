"""The workers of a Dask cluster, which may be on other machines."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from simmpp.errors import ConfigError
from simmpp.sweeps.crew import Crew

CONNECT_S, WORKERS_S = 10, 60
"""Seconds to wait for a cluster's scheduler, and for its first worker."""


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
