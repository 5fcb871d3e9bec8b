"""Workers that die: their tasks are run again, and only the one at fault fails."""

import dataclasses
from collections import deque
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool

from hypothesis import given
from hypothesis import strategies as st

from simmpp.config.config import config_from_mapping
from simmpp.sweeps.executors import Pool
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.scheduler import WORKER_DIED, outcomes
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import run_task


class Fragile(Executor):
    """A pool that breaks, with all that is in flight, when it is given one of some tasks."""

    def __init__(self, deadly: set[str]) -> None:
        self.deadly, self.flying, self.broken = deadly, list[Future[Outcome]](), False

    def submit(self, fn, task, *arguments):  # type: ignore[no-untyped-def]
        if self.broken:
            raise BrokenProcessPool
        future: Future[Outcome] = Future()
        self.flying.append(future)
        if task.key in self.deadly:
            self.broken = True
            for each in self.flying:
                if not each.done():
                    each.set_exception(BrokenProcessPool())
        elif len(self.flying) % 3 == 0:
            future.set_result(Outcome(task.key, {"messages": 1}))
        else:
            future.set_result(Outcome(task.key))
        return future


class Renewing(Pool):
    def renew(self) -> None:
        assert isinstance(self.executor, Fragile)
        self.executor = Fragile(self.executor.deadly)


@given(st.sets(st.integers(0, 11), max_size=4), st.integers(1, 6))
def test_only_the_task_that_kills_its_worker_fails(numbers: set[int], in_flight: int) -> None:
    tasks = [dataclasses.replace(SOME_TASK, key=str(n)) for n in range(12)]
    deadly = {str(n) for n in numbers}
    found = list(outcomes(deque(tasks), Renewing(Fragile(deadly), in_flight, run_task)))
    assert sorted(o.key for o in found) == sorted(task.key for task in tasks)
    assert {o.key: o.error for o in found if o.error} == dict.fromkeys(deadly, WORKER_DIED)


SOME_TASK = Task("", "", "", config_from_mapping({"scene": "tetra:1"}), None, 0)  # type: ignore[arg-type]
