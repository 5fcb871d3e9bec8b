"""What hears no timeout is ended with the process that it runs in, where that is a sweep's own."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_is_worker = threading.Event()


def note_worker() -> None:
    """This process is one of LocalProcesses, and nobody else's."""
    _is_worker.set()


@contextmanager
def ended_after(timeout_s: float | None) -> Iterator[None]:
    """``with ended_after(60):`` what hears nothing, as a hook that never returns, ends the worker.

    Compiled code can't be broken off, only the process that it runs in, a few seconds later than
    what hears. Does nothing elsewhere.
    """
    if timeout_s is None or not _is_worker.is_set():
        yield
        return
    end = threading.Timer(timeout_s + 1 + min(timeout_s, 4), os._exit, (1,))
    end.daemon = True
    end.start()
    try:
        yield
    finally:
        end.cancel()
