"""``simmpp bench``: every method at every point, timed, and enough simulations to judge it by."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_csv
from simmpp.config.axes import axes_of, keys_of
from simmpp.config.config import Config, with_key
from simmpp.config.settings import long_policies
from simmpp.methods.columns import KEYS
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.plot.matplotlib_panels import draw
from simmpp.policy.registry import DEFAULT_POLICY, REFERENCE
from simmpp.run.provenance import result_versions
from simmpp.scene.load import load_scene
from simmpp.studies.bench.errors import CPU, Rung, bench_columns, bench_rows, rungs
from simmpp.studies.bench.figure import bench_panels
from simmpp.studies.nebel98.figures import NAMES
from simmpp.sweeps.adaptive import Frontier
from simmpp.sweeps.executors import crew_for
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import Plan, plan
from simmpp.sweeps.profits import SIMULATION
from simmpp.sweeps.stopping import seeds_in_order
from simmpp.sweeps.sweep import Watcher, run_pending
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
    config: Config, *, seeds: int, out: Path, workers: int = 1, watcher: Watcher | None = None
) -> Bench:
    """Run every method that isn't run yet in the folder ``out``; write ``bench.csv`` and its plot.

    ``seeds`` is the number that is simulated at full fidelity; more of them add to what is there.
    Raises ConfigError if the folder holds results of other versions.
    """
    refuse_unfit(config)
    plans = {method: plan(_tried(config, method, seeds)) for method in METHODS}
    full = plans[SIMULATE]
    together = Plan(full.config, tuple(chain(*(each.points for each in plans.values()))), ())
    out.mkdir(parents=True, exist_ok=True)
    with closing(Journal(out, {"versions": result_versions()})) as journal:
        _time_tracing(full, journal, watcher or Watcher())
        with closing(crew_for(workers, None)) as crew:
            run_pending(Frontier(together, journal), journal, crew, None, watcher or Watcher())
        return _written(plans, journal, out)


def _written(plans: Mapping[str, Plan], journal: Journal, out: Path) -> Bench:
    full, outcomes = plans[SIMULATE], journal.outcomes
    runs = [row for each in plans.values() for row in each.rows(outcomes)]
    good = [row | {CPU: outcomes[row[SIMULATION]].cpu_s} for row in runs if not row["error"]]
    keys = (*KEYS[:3], *full.further)
    trace_s = {
        each.scene: journal.trace_s[each.task.digest]
        for each in full.points
        if each.task.digest in journal.trace_s
    }
    rows = bench_rows(good, keys, trace_s)
    write_csv(rows, bench_columns(keys), out / BENCH)
    found, files = rungs(rows, keys), [out / BENCH]
    if found:
        seeds = len(full.config.settings.seeds)
        files += draw(bench_panels(found, NAMES, seeds), out / Path(BENCH).stem)
    return Bench(found, files, [row["error"] for row in runs if row["error"]])


def refuse_unfit(config: Config) -> None:
    """Raise ConfigError for what a bench sets itself."""
    swept = [key for axis in axes_of(config.settings.sweep).values() for key in keys_of(axis)]
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
    chosen = seeds_in_order(config.settings.seeds, min(most, seeds))
    config = with_key(with_key(config, "method", method), "seeds", chosen)
    return with_key(config, "policy", policies or [REFERENCE])


def _time_tracing(full: Plan, journal: Journal, watcher: Watcher) -> None:
    """Trace each picture anew, whatever is cached; rays of another renderer take no tracing."""
    firsts = {each.task.digest: each for each in reversed(full.points)}
    for digest, first in firsts.items():
        config = first.point.config
        if digest in journal.trace_s or config.settings.scene.workload is not None:
            continue
        scene = load_scene(config.scene_spec)
        trace(scene, Picture(resolution=FEW_PIXELS))  # compiles, or loads what was compiled
        began_s = time.process_time()
        trace(scene, config.picture, progress=partial(watcher.tracing, first.scene))
        journal.add_trace(digest, time.process_time() - began_s)
