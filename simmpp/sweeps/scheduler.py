"""Running tasks on a pool: a few in flight at a time, none lost when a worker dies."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait

from simmpp.common.errors import ConfigError
from simmpp.sweeps.executors import Pool
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.task import Task

WORKER_DIED = "the worker died (out of memory?)"
ENDED = "timeout: heard nothing after {:g} s and was ended with its worker (an endless hook?)"


def outcomes(waiting: deque[Task], pool: Pool) -> Iterator[Outcome]:
    """The outcome of each task, in the order in which they are finished.

    Tasks are taken from the left; whoever gets an outcome may add further ones on the right.

    When a worker dies, those in flight are run again one at a time, so that the one at fault is
    found and only that one fails.
    """
    suspects, began_s = deque[Task](), 0.0
    flying: dict[Future[Outcome], Task] = {}
    while waiting or suspects or flying:
        # One dead process breaks an executor of concurrent.futures for all its tasks, and does not
        # say which it ran. A suspect that flies alone and is lost is the one.
        alone = bool(suspects)
        queue, room = (suspects, 1) if alone else (waiting, pool.most_in_flight)
        while queue and len(flying) < room:
            task, began_s = queue.popleft(), time.monotonic()
            flying[pool.submit(task)] = task
        lost: list[Task] = []
        for future in wait(flying, return_when=FIRST_COMPLETED).done:
            task = flying.pop(future)
            outcome = _outcome(future, task)
            if outcome is None:
                lost.append(task)
            else:
                yield outcome
        if lost:
            lost += flying.values()  # broken too, though their futures may not know yet
            flying.clear()
            pool.renew()
            if alone:
                error = _why(pool.timeout_s, time.monotonic() - began_s)
                yield from (Outcome(task.key, error=error) for task in lost)
            else:
                suspects.extend(lost)


def _why(timeout_s: float | None, took_s: float) -> str:
    """What a task died of, all alone: whoever takes longer than it may is ended."""
    return WORKER_DIED if timeout_s is None or took_s < timeout_s else ENDED.format(timeout_s)


def _outcome(future: Future[Outcome], task: Task) -> Outcome | None:
    """What came back; None if the executor broke."""
    try:
        return future.result()
    except BrokenExecutor:
        return None
    except CancelledError:
        raise ConfigError("--cluster: the scheduler is gone; what is finished is kept") from None
    except Exception as error:  # a Dask worker that died again and again, a task it can't read
        return Outcome(task.key, error=" ".join(f"{type(error).__name__}: {error}".split()))
