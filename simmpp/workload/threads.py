"""Threads that share the batches of what is traced; compiled code lets others run beside it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

Run = Callable[..., Iterable[Any]]
"""Maps a function on lists, as ``map`` does."""


@contextmanager
def mapping(threads: int | None) -> Iterator[Run]:
    """What maps a function on batches, in order: this thread, or as many as asked for.

    ``None`` takes as many as there are cores.
    """
    if threads is None:
        only = getattr(os, "sched_getaffinity", None)
        threads = len(only(0)) if only else os.cpu_count() or 1
    if threads == 1:
        yield map
        return
    pool = ThreadPoolExecutor(threads)
    try:
        yield pool.map
    finally:
        pool.shutdown(cancel_futures=True)
