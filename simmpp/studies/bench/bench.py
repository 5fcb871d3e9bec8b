"""``simmpp bench``: every method at every point, timed, and enough simulations to judge it by."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv
from simmpp.common.folders import BENCH as BENCH_FOLDER
from simmpp.common.folders import claimed, note_call
from simmpp.config.axes import keys_of
from simmpp.config.config import Config, with_key
from simmpp.config.settings import long_policies
from simmpp.methods.columns import PLACE
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.policy.parameters import DEFAULT_POLICY, REFERENCE
from simmpp.run.provenance import result_versions
from simmpp.run.rows import has_ended
from simmpp.studies.bench.errors import CPU, Rung, bench_columns, bench_rows, rungs
from simmpp.studies.bench.figure import bench_panels
from simmpp.studies.nebel98.figures import NAMES
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.profits import SIMULATION
from simmpp.sweeps.stopping import seeds_in_order
from simmpp.sweeps.sweep import Watcher, run_plans
from simmpp.workload.picture import Picture
from simmpp.workload.trace.tracer import trace

BENCH = "bench.csv"
FEW_PIXELS = 4
"""Along each side of a picture that is traced only to have the tracer compiled."""


@dataclass(frozen=True)
class Bench:
    """What came out."""

    rungs: list[Rung]
    files: list[Path]
    failed: list[str]
    """The error of each run that has one; it is left out."""


def bench(
    config: Config,
    *,
    seeds: int,
    out: Path,
    workers: int = 1,
    watcher: Watcher | None = None,
    call: str = "",
) -> Bench:
    """Run every method that isn't run yet in the folder ``out``; write ``bench.csv`` and its plot.

    ``seeds`` is the number that is simulated at full fidelity; more of them add to what is there.
    ``call`` is the command that goes on if this is interrupted.
    Raises ConfigError if the folder holds results of other versions.
    """
    refuse_unfit(config)
    plans = {method: plan_of(_tried(config, method, seeds)) for method in METHODS}
    full = plans[SIMULATE]
    with (
        claimed(out, BENCH_FOLDER),
        closing(Journal(out, {"versions": result_versions()})) as journal,
    ):
        note_call(out, call)
        _time_tracing(full, journal, watcher or Watcher())
        run_plans(plans.values(), journal, workers, watcher)
        return _written(plans, journal, out, watcher or Watcher())


def _written(plans: Mapping[str, Plan], journal: Journal, out: Path, watcher: Watcher) -> Bench:
    full, outcomes = plans[SIMULATE], journal.outcomes
    runs = [row for plan in plans.values() for row in plan.rows(outcomes)]
    good = [row | {CPU: outcomes[row[SIMULATION]].cpu_s} for row in runs if has_ended(row)]
    keys = (*PLACE, *full.further)
    trace_s = {
        planned.scene: journal.trace_s[planned.task.digest]
        for planned in full.points
        if planned.task.digest in journal.trace_s
    }
    rows = bench_rows(good, keys, trace_s)
    write_csv(rows, bench_columns(keys), out / BENCH)
    ladder, files = rungs(rows, keys), [out / BENCH]
    if ladder:
        # Not at the top: pages, which read these tables, need no matplotlib.
        from simmpp.plot.matplotlib_panels import draw

        seeds = len(full.config.settings.seeds)
        watcher.drawing(0, 1)
        files += draw(bench_panels(ladder, NAMES, seeds), out / Path(BENCH).stem)
    return Bench(ladder, files, [row["error"] for row in runs if row["error"]])


def refuse_unfit(config: Config) -> None:
    """Raise ConfigError for what a bench sets itself."""
    swept = [key for axis in config.axes.values() for key in keys_of(axis)]
    for key in swept:
        if key.split(".")[0] in ("method", "policy"):
            raise ConfigError(f"sweep: {key}: expected no such axis; bench tries every method")
    if config.settings.tolerance is not None:
        raise ConfigError("tolerance: expected none; bench takes the number of seeds as --seeds")


def _tried(config: Config, method: str, seeds: int) -> Config:
    """The configuration for one method: the policies and as many seeds as it is tried with."""
    most, known = METHODS[method].most_seeds or seeds, METHODS[method].policies
    source = config.source.data if config.source else {}
    policies = [
        entry
        for entry in long_policies(source.get("policy", DEFAULT_POLICY))
        if known is None or not isinstance(entry, dict) or entry["name"] in known
    ]
    first = seeds_in_order(config.settings.seeds, min(most, seeds))
    config = with_key(with_key(config, "method", method), "seeds", first)
    return with_key(config, "policy", policies or [REFERENCE])


def _time_tracing(full: Plan, journal: Journal, watcher: Watcher) -> None:
    """Trace each picture anew, whatever is cached; other rays' time is not told."""
    firsts = {planned.task.digest: planned for planned in reversed(full.points)}
    for digest, first in firsts.items():
        config = first.point.config
        load_scene, is_picture = config.ray_source.scene, not config.ray_source.has_own_picture
        if digest in journal.trace_s or load_scene is None or not is_picture:
            continue
        scene = load_scene()
        trace(scene, Picture(resolution=FEW_PIXELS))  # compiles, or loads what was compiled
        began_s = time.process_time()
        trace(scene, config.picture, progress=partial(watcher.tracing, first.scene))
        journal.add_trace(digest, time.process_time() - began_s)
