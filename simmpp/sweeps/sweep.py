"""A whole sweep: what isn't simulated yet is, and the tables are written from what is there."""

from __future__ import annotations

import json
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from simmpp.common.files import Row, as_arrow, write_csv, write_parquet, write_text
from simmpp.config.config import Config, config_from_mapping, load_config, with_key
from simmpp.methods.columns import result_columns
from simmpp.run.inputs import cache_workload
from simmpp.run.provenance import all_versions
from simmpp.sweeps.adaptive import Frontier
from simmpp.sweeps.executors import Crew, crew_for
from simmpp.sweeps.journal import Journal, Outcome, Results
from simmpp.sweeps.plan import Plan, plan
from simmpp.sweeps.profits import profit_columns, profit_rows
from simmpp.sweeps.scheduler import outcomes as execute
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import keep_workload

if TYPE_CHECKING:
    import pandas

RESULTS, PARQUET, PROFITS, TIMINGS, RECORD = (
    "results.csv",
    "results.parquet",
    "profits.csv",
    "timings.csv",
    "run.json",
)


class Watcher:
    """Is told how a sweep gets on; this one says nothing."""

    def planned(self, plan: Plan, finished: Mapping[str, Outcome]) -> None:
        """The points are known; some may be finished from before."""

    def tracing(self, scene: str, done: int, total: int) -> None:
        """Rays done and rays known of a workload that is being traced."""

    def asked(self, tasks: int) -> None:
        """That many more tasks are found to be needed."""

    def simulated(self, outcome: Outcome) -> None:
        """One more task is finished."""

    def notice(self, text: str) -> None:
        """Something that the user should know."""


class SweepResult(NamedTuple):
    """The tables of a sweep."""

    rows: pandas.DataFrame
    """As results.csv: one row per point and seed."""
    profits: pandas.DataFrame
    """As profits.csv: one row per point."""


def run_sweep(
    config: Config | Mapping[str, object] | str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    engine: str | None = None,
    timeout_s: float | None = None,
    out: str | Path | None = None,
    watcher: Watcher | None = None,
) -> SweepResult:
    """Simulate all points of a configuration, given as data or as the name of a YAML file.

    Points run in this process, in ``workers`` processes, or on the Dask ``cluster`` of that
    address; rows are the same. With ``out``, a folder, finished points are kept there, a second
    call continues, and the tables are written as files. One point may take ``timeout_s`` seconds;
    one that fails has its row with an ``error``.
    Raises InputError if the configuration is wrong or the folder holds another sweep's results.
    """
    if isinstance(config, str | Path):
        config = load_config(config)
    elif not isinstance(config, Config):
        config = config_from_mapping(config)
    if engine is not None:
        config = with_key(config, "engine", engine)
    made = plan(config)
    folder = None if out is None else Path(out)
    with closing(_results(made, folder)) as results, closing(crew_for(workers, cluster)) as crew:
        made = _simulate(made, results, crew, timeout_s, folder, watcher or Watcher())
    rows, tolerance = made.rows(results.outcomes), config.settings.tolerance
    return SweepResult(
        _frame(rows, result_columns(made.further)),
        _frame(profit_rows(rows, made.profit_keys, tolerance), profit_columns(made.profit_keys)),
    )


def _results(plan: Plan, folder: Path | None) -> Results:
    if folder is None:
        return Results()
    folder.mkdir(parents=True, exist_ok=True)
    return Journal(folder, plan.identity)


def _simulate(
    plan: Plan,
    results: Results,
    crew: Crew,
    timeout_s: float | None,
    folder: Path | None,
    watcher: Watcher,
) -> Plan:
    """Run what isn't finished; the tables are written even when interrupted.

    Returns the plan with all that turned out to be needed.
    """
    frontier = Frontier(plan, results)
    if folder is None:
        run_pending(frontier, results, crew, timeout_s, watcher)
        return frontier.plan

    def write() -> None:
        write_tables(frontier.plan, results, folder)

    showing = Showing(write)
    try:
        run_pending(frontier, results, crew, timeout_s, watcher, showing)
    finally:
        write()
    return frontier.plan


def run_pending(
    frontier: Frontier,
    results: Results,
    crew: Crew,
    timeout_s: float | None,
    watcher: Watcher,
    after_each: Callable[[], None] = lambda: None,
) -> None:
    """Run what isn't finished, and what that shows to be needed; ``results`` grow one by one."""
    for text in results.notices:
        watcher.notice(text)
    pending = deque(frontier.pending)
    watcher.planned(frontier.plan, results.outcomes)
    _trace(frontier.plan, pending, results, watcher)
    for outcome in execute(pending, crew, timeout_s):
        results.add(outcome)
        if more := frontier.take(outcome):
            pending.extend(more)  # while these wait, others run
            watcher.asked(len(more))
        watcher.simulated(outcome)
        after_each()


def _trace(plan: Plan, tasks: Iterable[Task], results: Results, watcher: Watcher) -> None:
    """Bring the workloads that are needed into the cache, from where workers share them."""
    scenes = {each.task.digest: each.scene for each in plan.points}
    first_tasks: dict[str, Task] = {}
    for task in tasks:
        first_tasks.setdefault(task.digest, task)
    for digest, task in first_tasks.items():
        began_s = time.perf_counter()
        tell = partial(watcher.tracing, scenes[digest])
        workload = cache_workload(task.config, digest, progress=tell, notice=watcher.notice)
        if workload is not None:
            keep_workload(workload)
            results.add_trace(digest, time.perf_counter() - began_s)


def write_tables(plan: Plan, results: Results, folder: Path) -> None:
    """Write the tables of the points that are finished, and what they are of."""
    rows, columns, keys = (
        plan.rows(results.outcomes),
        result_columns(plan.further),
        plan.profit_keys,
    )
    write_csv(rows, columns, folder / RESULTS)
    write_parquet(rows, columns, folder / PARQUET)
    profits = profit_rows(rows, keys, plan.config.settings.tolerance)
    write_csv(profits, profit_columns(keys), folder / PROFITS)
    timings = plan.timings(results.outcomes, results.trace_s)
    write_csv(timings, plan.timing_columns, folder / TIMINGS)
    write_text(json.dumps(_record(plan), indent=1) + "\n", folder / RECORD)


def _record(plan: Plan) -> dict[str, object]:
    """``run.json``: nothing in it depends on when, where or how fast the sweep ran."""
    machines: dict[str, dict[str, object]] = {}
    for each in plan.points:
        config = each.point.config
        constants = asdict(config.machine_for(config.processors))
        machines.setdefault(json.dumps(constants), constants)
    return {
        **plan.identity,
        "versions": all_versions(),
        "points": len(plan.points),
        "simulations": len(plan.tasks),
        "further_columns": list(plan.further),
        "machines": list(machines.values()),
    }


def _frame(rows: list[Row], columns: Sequence[str]) -> pandas.DataFrame:
    """A table for Python; integers stay integers where some are missing."""
    import pandas
    import pyarrow

    table = as_arrow(rows, columns)
    gaps = any(table[name].null_count for name in columns if table[name].type == pyarrow.int64())
    nullable = {pyarrow.int64(): pandas.Int64Dtype()}
    return table.to_pandas(types_mapper=nullable.get if gaps else None)


# --- when to write the tables of a sweep that is still running ---


SHOWN_S, SHARE = 5.0, 20
"""Seconds between two writings at least, and how many times as long as one writing takes."""


class Showing:
    """Writes the tables of a sweep that runs now and then, for those who watch it.

    At once, then every SHOWN_S seconds, or less often if writing takes more than a twentieth.
    """

    def __init__(self, write: Callable[[], None]) -> None:
        self._write = write
        write()  # takes its time to import, which is not counted
        self._next_s = time.monotonic() + SHOWN_S

    def __call__(self) -> None:
        """Write if it is time."""
        began_s = time.monotonic()
        if began_s >= self._next_s:
            self._write()
            ended_s = time.monotonic()
            self._next_s = ended_s + max(SHOWN_S, SHARE * (ended_s - began_s))
