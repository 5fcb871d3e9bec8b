"""What a second worker saves: `python tests/bench/bench_sweep.py [--workers 1 2 4] [CONFIG]`.

Runs the same sweep with different numbers of workers, rays traced and code compiled before. *whole*
is the elapsed time with the start of processes; *CPU* the processor time of all tasks, with what
each worker loads first. Where other programs take part of the cores, elapsed times are theirs too;
*CPU / workers*, against that of one worker, is what is left of the time on cores of one's own.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from simmpp.config.config import load_config
from simmpp.sweeps import scheduler as execute
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.sweep import Watcher, run_sweep
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import run_task

CONFIG = Path(__file__).with_name("sweep.yaml")
"""So much that simulating takes longer than starting processes."""


def on_the_processor(
    task: Task, timeout_s: float | None, versions: Mapping[str, str] | None
) -> Outcome:
    """Run a task, and say how long it had a processor."""
    began_s = time.process_time()
    outcome = run_task(task, timeout_s, versions)
    return replace(outcome, wall_s=time.process_time() - began_s)


class Adder(Watcher):
    """Adds up what the tasks say."""

    def __init__(self) -> None:
        self.cpu_s = 0.0

    def simulated(self, outcome: Outcome) -> None:
        if outcome.error:
            raise RuntimeError(outcome.error)
        self.cpu_s += outcome.wall_s


def measure(path: Path, workers: int) -> tuple[float, float]:
    """Elapsed and processor seconds of a sweep."""
    config = load_config(path)
    adder, began_s = Adder(), time.perf_counter()
    run_sweep(config, workers=workers, watcher=adder)
    return time.perf_counter() - began_s, adder.cpu_s


def main() -> None:
    """Print a line for each number of workers."""
    parser = argparse.ArgumentParser()
    parser.add_argument("config", nargs="?", type=Path, default=CONFIG)
    parser.add_argument("--workers", nargs="+", type=int, default=[1, 2])
    arguments = parser.parse_args()
    measure(arguments.config, 1)  # traces and compiles
    execute.run_task = on_the_processor
    print("workers   whole s  ratio     CPU s  CPU / workers s  ratio")
    first: tuple[float, float] | None = None
    for workers in arguments.workers:
        whole_s, cpu_s = measure(arguments.config, workers)
        first = first or (whole_s, cpu_s / workers)
        print(
            f"{workers:7}  {whole_s:8.2f}  {whole_s / first[0]:5.2f}  {cpu_s:8.2f}"
            f"  {cpu_s / workers:15.2f}  {cpu_s / workers / first[1]:5.2f}"
        )


if __name__ == "__main__":
    main()
