"""A whole sweep: what isn't simulated yet is, and the tables are written from what is there."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache, partial
from itertools import chain
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING

from simmpp.common.displayed import Displayed
from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.files import Row, as_arrow, write_csv, write_parquet
from simmpp.common.folders import SWEEP, claimed, note_call
from simmpp.common.units import shown
from simmpp.common.validate import require_kind, require_whole
from simmpp.config.config import Config, config_from_mapping, load_config, with_key
from simmpp.policy.policy import Policy
from simmpp.run.inputs import cache_workload
from simmpp.run.provenance import result_versions
from simmpp.run.record import write_record
from simmpp.run.rows import KNEES, PARQUET, PROFITS, RECORD, RESULTS, TIMINGS
from simmpp.sweeps.adaptive import AdaptiveSampler
from simmpp.sweeps.executors import Pool, pool_for
from simmpp.sweeps.journal import Journal, Outcome, Results
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.profits import profit_columns, profit_rows
from simmpp.sweeps.scheduler import outcomes
from simmpp.sweeps.task import Task
from simmpp.sweeps.winners.knee import knee_tables
from simmpp.sweeps.worker import keep_workload, run_task

if TYPE_CHECKING:
    import pandas

SHOWN_S, SHARE = 5.0, 20
"""Seconds between two writings of the tables of a sweep that runs at least, and how many times as
long as one writing takes."""
TablesByFile = dict[str, tuple[list[Row], Sequence[str]]]
"""Rows and columns by the name of their file."""


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

    def drawing(self, done: int, total: int) -> None:
        """Figures drawn of the rows, and how many there will be."""

    def notice(self, text: str) -> None:
        """Something that the user should know."""


@documented
@dataclass(frozen=True, eq=False)
class SweepResult(Displayed):
    """The tables of a sweep: ``rows, profits = simmpp.sweep(...)``."""

    rows: pandas.DataFrame
    """As results.csv: one row per point and seed."""
    profits: pandas.DataFrame
    """As profits.csv: one row per point."""
    folder: Path | None = None
    """Where they were written, if anywhere."""

    def __iter__(self) -> Iterator[pandas.DataFrame]:
        """Both tables."""
        return iter((self.rows, self.profits))


def run_sweep(
    config: Config | Mapping[str, object] | str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    pool: Pool | None = None,
    engine: str | None = None,
    timeout_s: float | None = None,
    out: str | Path | None = None,
    watcher: Watcher | None = None,
    call: str = "",
) -> SweepResult:
    """Simulate all points of a configuration, given as data or as the name of a YAML file.

    Points run in this process, in ``workers`` processes, on the Dask ``cluster`` of that address,
    or on a ``pool`` of one's own, which is closed; rows are the same. With ``out``, a folder,
    finished points are kept there, a second call continues, and the tables are written as files;
    one with more seeds, values or policies adds to what is there. Whoever looks at an unfinished
    folder is told ``call``, the command that goes on. One point may take ``timeout_s`` seconds;
    one that fails has its row with an ``error``.
    Raises InputError if the configuration is wrong or the folder holds another sweep's results.
    """
    require_kind("config", config, Mapping, Config, str, Path)
    _check(workers, cluster, timeout_s, out)
    if isinstance(config, str | Path):
        config = load_config(config)
    elif not isinstance(config, Config):
        config = config_from_mapping(config)
    if engine is not None:
        config = with_key(config, "engine", engine)
    plan, folder = plan_of(config), None if out is None else Path(out)
    if pool is not None or workers > 1 or cluster is not None:
        _refuse_objects(plan)
    with (
        claimed(folder, SWEEP),
        closing(_results(plan, folder)) as results,
        closing(pool or _pool(workers, cluster, timeout_s)) as own,
    ):
        if folder is not None:
            note_call(folder, call)
        tables = _run(plan, results, own, folder, watcher or Watcher())
    return SweepResult(_frame(*tables[RESULTS]), _frame(*tables[PROFITS]), folder)


def _check(workers: object, cluster: object, timeout_s: object, out: str | Path | None) -> None:
    """Raise ConfigError for arguments that can't be."""
    require_whole("workers", workers, 1)
    require_kind("cluster", cluster, str, NoneType)
    require_kind("out", out, str, Path, NoneType)
    require_kind("timeout_s", timeout_s, float, int, NoneType)
    if isinstance(timeout_s, float | int) and not timeout_s > 0:
        raise ConfigError(f"timeout_s: value {shown(timeout_s)}: expected seconds above 0")


def _refuse_objects(plan: Plan) -> None:
    """Raise ConfigError for policies that other processes can't be sent."""
    for planned in plan.points:
        if isinstance(planned.point.policy.file, Policy):
            problem = "is an object of Python: workers are sent files: expected one, or workers=1"
            raise ConfigError(f"policy {planned.point.policy.title!r} {problem}")


def _results(plan: Plan, folder: Path | None) -> Results:
    return Results() if folder is None else Journal(folder, plan.identity)


def _pool(workers: int, cluster: str | None, timeout_s: float | None) -> Pool:
    """Workers elsewhere may have other versions installed than this process: they are told."""
    versions = None if cluster is None else result_versions()
    run = partial(run_task, timeout_s=timeout_s, versions=versions)
    return pool_for(workers, cluster, run, timeout_s)


def _run(
    plan: Plan, results: Results, pool: Pool, folder: Path | None, watcher: Watcher
) -> TablesByFile:
    """Run what isn't finished; the tables are written even when interrupted."""
    sampler = AdaptiveSampler(plan, results)
    if folder is None:
        run_pending(sampler, results, pool, watcher)
        return tables_of(sampler.plan, results)

    def write() -> TablesByFile:
        return write_tables(sampler.plan, results, folder)

    showing = Showing(write)
    try:
        run_pending(sampler, results, pool, watcher, showing)
    finally:
        tables = write()
    return tables


def run_plans(
    plans: Iterable[Plan], results: Results, workers: int = 1, watcher: Watcher | None = None
) -> None:
    """Run what isn't finished of several plans, what they have in common once."""
    plans = list(plans)
    together = Plan(plans[0].config, tuple(chain(*(plan.points for plan in plans))), ())
    sampler = AdaptiveSampler(together, results)
    with closing(pool_for(max(1, min(workers, len(sampler.pending))), None, run_task)) as pool:
        run_pending(sampler, results, pool, watcher or Watcher())


def run_pending(
    sampler: AdaptiveSampler,
    results: Results,
    pool: Pool,
    watcher: Watcher,
    after_each: Callable[[], None] = lambda: None,
) -> None:
    """Run what isn't finished, and what that shows to be needed; ``results`` grow one by one."""
    for text in results.notices:
        watcher.notice(text)
    pending = deque(sampler.pending)
    watcher.planned(sampler.plan, results.outcomes)
    _trace(sampler.plan, pending, results, watcher)
    for outcome in outcomes(pending, pool):
        results.add(outcome)
        if more := sampler.tell(outcome):
            pending.extend(more)  # while these wait, others run
            watcher.asked(len(more))
        watcher.simulated(outcome)
        after_each()


def _trace(plan: Plan, tasks: Iterable[Task], results: Results, watcher: Watcher) -> None:
    """Bring the workloads that are needed into the cache, from where workers share them."""
    scenes = {planned.task.digest: planned.scene for planned in plan.points}
    say = cache(watcher.notice)  # once, what holds for each picture of a scene
    first_tasks: dict[str, Task] = {}
    for task in tasks:
        first_tasks.setdefault(task.digest, task)
    for digest, task in first_tasks.items():
        began_s = time.perf_counter()
        progress = partial(watcher.tracing, scenes[digest])
        workload = cache_workload(task.config, digest, progress=progress, notice=say)
        if workload is not None:
            keep_workload(workload)
            results.add_trace(digest, time.perf_counter() - began_s)


def tables_of(plan: Plan, results: Results) -> TablesByFile:
    """The tables of the points that are finished; what reads them computes no profits again."""
    rows, keys = plan.rows(results.outcomes), plan.profit_keys
    profits = profit_rows(rows, keys, plan.config.settings.tolerance)
    timings = plan.timings(results.outcomes, results.trace_s)
    return {
        RESULTS: (rows, plan.result_columns(rows)),
        PROFITS: (profits, profit_columns(keys)),
        TIMINGS: (timings, plan.timing_columns),
        **knee_tables(rows, keys, profits),
    }


def write_tables(plan: Plan, results: Results, folder: Path) -> TablesByFile:
    """Write them, and what they are of."""
    tables = tables_of(plan, results)
    for name, (rows, columns) in tables.items():
        write_csv(rows, columns, folder / name)
    if KNEES not in tables:
        (folder / KNEES).unlink(missing_ok=True)  # of a sweep that had more values
    write_parquet(*tables[RESULTS], folder / PARQUET)
    write_record(plan.record(results.outcomes), folder / RECORD)
    return tables


class Showing:
    """Writes the tables of a sweep that runs now and then, for those who watch it.

    At once, then every SHOWN_S seconds, or less often if writing takes more than a twentieth.
    """

    def __init__(self, write: Callable[[], object]) -> None:
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


def _frame(rows: list[Row], columns: Sequence[str]) -> pandas.DataFrame:
    """A table for Python; integers stay integers where some are missing."""
    import pandas
    import pyarrow

    table = as_arrow(rows, columns)
    gaps = any(table[name].null_count for name in columns if table[name].type == pyarrow.int64())
    nullable = {pyarrow.int64(): pandas.Int64Dtype()}
    return table.to_pandas(types_mapper=nullable.get if gaps else None)
