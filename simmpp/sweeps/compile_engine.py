"""The engine's machine code, made by another process while this one compiles and runs the tracer.

numba compiles under a lock, so a second thread would only wait.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def engine_compiled_beside() -> Iterator[None]:
    """Let another process compile the engine; it ends with this one, however that ends.

    Whoever needs the engine waits in :func:`~simmpp.sweeps.worker.warm_up` until it is done.
    """
    command = [sys.executable, "-P", "-m", __name__]  # -P: not what lies in the working directory
    ignored = subprocess.DEVNULL
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=ignored, stderr=ignored
    ) as process:
        try:
            yield
        finally:
            process.kill()


def _compile() -> None:
    from simmpp.engine.simulate import DEFAULT_ENGINE
    from simmpp.sweeps.worker import warm_up

    threading.Thread(target=_end_with_parent, daemon=True).start()
    warm_up(DEFAULT_ENGINE)


def _end_with_parent() -> None:
    """A process that is killed closes what it holds."""
    sys.stdin.read()
    os._exit(1)


if __name__ == "__main__":
    _compile()
