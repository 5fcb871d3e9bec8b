"""What each skip saves, and on which scene: `python tests/bench/bench_skips.py [FILE.csv]`.

CPU seconds, the best of five, with the skip and with it turned off, in one process: the ratio holds
on any machine, the seconds do not. That results are the same is the matter of the tests
(tests/contract/test_skips.py). Rays that miss everything are no skip: they are measured to see what
keeping them as counts could save at most.
"""

from __future__ import annotations

import csv
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from unittest.mock import patch

import numpy as np

import simmpp
from simmpp.config.config import config_from_mapping
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.records import MISS
from simmpp.engine.compiled_engine import CompiledRun
from simmpp.engine.initial import new_state
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.sweep import run_sweep
from simmpp.sweeps.worker import run_task
from simmpp.workload.cache.store import workload_for
from simmpp.workload.trace import tracer
from simmpp.workload.trace.shading import render
from simmpp.workload.workload import Workload

SCENES = ("mountain:5", "rings:1", "tetra:6")
PROCESSORS = 64
REPEATS = 5
SWEEP = {
    "reading": "plain",
    "picture": {"resolution": 256},
    "policy": ["object", "ray", "concurrent", "replicated"],
    "sweep": {"memory.fraction": ["1/64", "5%", "10%", "20%", "40%", "60%", "80%", 1]},
}
Row = tuple[str, str, str, float, float]
"""Skip, scene, unit, with it, without it."""


def best_s(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """The shortest of some runs, in CPU seconds; the first one may compile."""
    times = []
    for _ in range(repeats):
        began_s = time.process_time()
        work()
        times.append(time.process_time() - began_s)
    return min(times)


def workload_of(spec: str) -> Workload:
    """The picture of the paper, 512 x 512."""
    return workload_for(simmpp.load_scene(spec), simmpp.Picture())


def simulation(
    workload: Workload, policy: str, fraction: Fraction, processors: int = PROCESSORS
) -> Callable[[], object]:
    """One run of the compiled engine."""
    memory = simmpp.Memory(fraction=fraction)
    placement = simmpp.place(workload, processors, memory, simmpp.PlacementRules(), seed=0)
    machine, parameters = (
        simmpp.make_machine(processors=processors),
        simmpp.PolicyParameters(policy),
    )
    return lambda: simmpp.simulate(workload, machine, placement, parameters)


def no_events(spec: str) -> Iterator[Row]:
    """Nothing remote needs no events."""
    cases = (("object", "1", PROCESSORS), ("replicated", "1/10", PROCESSORS), ("object", "1", 1))
    for policy, x, processors in cases:
        run = simulation(workload_of(spec), policy, Fraction(x), processors)
        skipping = best_s(run)
        with patch("simmpp.engine.compiled_engine.run_alone", lambda runs: False):
            every_event = best_s(run)
        yield f"no events: {policy}, {processors} PEs", spec, "s", skipping, every_event


def failed_attempt(spec: str) -> Iterator[Row]:
    """What it costs to see that something is remote."""
    run = simulation(workload_of(spec), "object", Fraction(1, 10))
    attempting = best_s(run)
    with patch("simmpp.engine.compiled_engine.run_alone", lambda runs: False):
        not_attempting = best_s(run)
    yield "no events: attempted in vain, x = 10 %", spec, "s", attempting, not_attempting


def passes(spec: str) -> Iterator[Row]:
    """No reflection without reflective material, no refraction without transparent material."""
    scene, chosen = simmpp.load_scene(spec), tracer.spawning
    skipping = best_s(lambda: simmpp.trace(scene, simmpp.Picture()))

    def all_passes(*arguments: object):
        return replace(chosen(*arguments), reflection=True, refraction=True)

    with patch("simmpp.workload.trace.tracer.spawning", all_passes):
        every_pass = best_s(lambda: simmpp.trace(scene, simmpp.Picture()))
    yield "no pass without material", spec, "s", skipping, every_pass


def kept_workload(spec: str) -> Iterator[Row]:
    """A workload is traced once, and read from the cache afterwards."""
    scene = simmpp.load_scene(spec)
    traced = best_s(lambda: simmpp.trace(scene, simmpp.Picture()))
    yield "traced once and cached", spec, "s", best_s(lambda: workload_of(spec)), traced


def no_shading(spec: str) -> Iterator[Row]:
    """A picture is shaded only when it is asked for: tracing, with shading and without."""
    scene, picture = simmpp.load_scene(spec), simmpp.Picture()
    workload = workload_of(spec)
    traced = best_s(lambda: simmpp.trace(scene, picture))
    yield "no shading", spec, "s", traced, traced + best_s(lambda: render(scene, picture, workload))


def no_state(spec: str) -> Iterator[Row]:
    """Objects that no itinerary names, or no PE lacks, take no state: bytes of object dataflow."""
    workload, parameters = workload_of(spec), simmpp.PolicyParameters("object")
    rules = simmpp.Memory(), simmpp.PlacementRules()
    placement = simmpp.place(workload, PROCESSORS, *rules, seed=0)
    machine = simmpp.make_machine(processors=PROCESSORS)
    state = new_state(workload, machine, placement, parameters, ready_order="depth-first")
    CompiledRun(state).run()
    touched = int(state.arrays["miss_marks"][USED]) * MISS.itemsize
    dense = PROCESSORS * workload.n_objects * MISS.itemsize
    yield "state of (PE, object) pairs in use only", spec, "bytes", touched, dense


def sweeps(spec: str) -> Iterator[Row]:
    """Equal points run once; finished points are not run again."""
    config = config_from_mapping({**SWEEP, "scene": spec})
    made = plan_of(config)
    run_task(made.tasks[0], None, None)  # reads the workload
    once = best_s(lambda: [run_task(task, None, None) for task in made.tasks], 2)
    with patch("simmpp.sweeps.task._holds_everything", lambda config: False):
        apart = plan_of(config)
    tasks = [each.task for each in apart.points]
    each_time = best_s(lambda: [run_task(task, None, None) for task in tasks], 2)
    what = f"equal points once: {len(made.tasks)} of {len(tasks)} runs"
    yield what, spec, "s", once, each_time
    with tempfile.TemporaryDirectory() as out:
        first = best_s(lambda: run_sweep(config, out=out), 1)
        again = best_s(lambda: run_sweep(config, out=out), 2)
    yield "finished points are not run again", spec, "s", again, first


def only_counts(spec: str) -> Iterator[Row]:
    """Primary rays that miss everything take so much of a run; as counts they could save that."""
    workload = workload_of(spec)
    n = int((np.diff(workload.itinerary_offsets)[: workload.n_primaries] == 0).sum())
    misses = replace(
        workload,
        picture=(1, n),
        kinds=np.zeros(n, np.uint8),
        parents=np.full(n, -1, np.int32),
        child_offsets=np.full(n + 1, n, np.int32),
        pixels=np.arange(n, dtype=np.int32),
        hits=np.full(n, -1, np.int32),
        hit_distances=np.full(n, np.inf),
        itinerary_offsets=np.zeros(n + 1, np.int64),
        itinerary_objects=np.zeros(0, np.int32),
    )
    for policy in ("object", "ray"):
        whole = best_s(simulation(workload, policy, Fraction(1, 10)))
        with patch("simmpp.engine.compiled_engine.run_alone", lambda runs: False):
            alone = best_s(simulation(misses, policy, Fraction(1, 10))) if n else 0.0
        yield f"(not built) misses as counts: {policy}", spec, "s", whole - alone, whole


MEASUREMENTS = (
    no_events,
    failed_attempt,
    passes,
    kept_workload,
    no_shading,
    no_state,
    sweeps,
    only_counts,
)


def main() -> None:
    """Print a line per skip and scene, and write them as a table if a file is named."""
    rows = []
    for measure in MEASUREMENTS:
        for spec in SCENES:
            for skip, scene, unit, skipping, without in measure(spec):
                cells = (f"{skipping:.4g}", f"{without:.4g}", f"{skipping / without:.2f}")
                rows.append((skip, scene, unit, *cells))
                print(f"{skip:45} {scene:12} {unit:6}", *cells, flush=True)
    if len(sys.argv) > 1:
        with Path(sys.argv[1]).open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["skip", "scene", "unit", "skipping", "not_skipping", "ratio"])
            table.writerows(rows)


if __name__ == "__main__":
    main()
