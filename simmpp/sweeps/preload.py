"""Imported by the server that worker processes are forked from: they find all of this loaded."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from simmpp.common.modules import SERVED

LOOK_S = 0.1


@contextmanager
def _ended_with_parent() -> Iterator[None]:
    """The server notices only afterwards, seconds later, that nobody needs it any more."""
    served, is_over = int(os.environ[SERVED]), threading.Event()

    def look() -> None:
        while not is_over.wait(LOOK_S):
            if os.getppid() != served:
                os._exit(1)

    watch = threading.Thread(target=look, daemon=True)
    watch.start()
    try:
        yield
    finally:
        is_over.set()
        watch.join()  # a fork copies no threads


with _ended_with_parent():
    from simmpp.common.code.kept import is_compiled
    from simmpp.common.modules import ENGINE
    from simmpp.engine.simulate import DEFAULT_ENGINE
    from simmpp.sweeps.worker import run_task as run_task
    from simmpp.sweeps.worker import warm_up

    if is_compiled(ENGINE):  # else the workers compile, and can be interrupted
        warm_up(DEFAULT_ENGINE)
