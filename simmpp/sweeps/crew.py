"""Who runs the tasks of a sweep: anything that takes one and gives its outcome back later."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


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


class Here(Executor):
    """Runs each task when it is given."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Its outcome, already there."""
        future: Future[T] = Future()
        future.set_result(fn(*args, **kwargs))
        return future
