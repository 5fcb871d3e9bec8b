"""``simmpp bench``: what does a quicker method cost in accuracy, and what does accuracy cost?"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.own_policies import tell_files
from simmpp.commands.parts.progress import progress_of_sweep
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import (
    FAILED,
    announce_compilation,
    go_on,
    notice,
    say,
    wrote,
)
from simmpp.config.config import load_config
from simmpp.studies.bench.bench import bench
from simmpp.studies.bench.errors import Rung

LARGE = 10
"""Error from which on it is told as a factor."""


@click.command("bench", epilog=options.examples("simmpp bench configs/bench.yaml --seeds 16"))
@options.config_argument
@click.option(
    "--seeds",
    type=options.Whole(4, 10_000),
    default=32,
    show_default=True,
    metavar="N",
    help="Simulations of each point at full fidelity, whose mean is the reference.",
)
@options.workers("Processes on this machine; 1 disturbs no times.  [default: one for each core]")
@options.setting("Set a dotted key; repeatable.")
@options.path("--out", "Folder of bench.csv and the figure.  [default: results/NAME-OF-CONFIG]")
@options.no_code
def bench_command(
    config_path: Path,
    seeds: int,
    workers: int | None,
    overrides: tuple[str, ...],
    out: Path | None,
    may_run: bool,
) -> None:
    """Measure the run time of each method against its error.

    Each method (the analytical models, simulation) is tried at every point of CONFIG, simulation
    with 1, 2, 4, ... seeds. Errors are against the mean of the other simulated seeds; times are the
    processor's, tracing apart. Writes bench.csv, bench.png and bench.svg. The same command
    continues what was interrupted, or adds seeds. Exits with 1 if a run failed.
    """
    config = load_config(config_path, overrides, may_run=may_run)
    tell_files(config)
    out = Path("results", config_path.stem) if out is None else out
    options.folder(out, "--out")
    announce_compilation()
    with progress_of_sweep(options.call()) as watcher:
        outcome = bench(
            config,
            seeds=seeds,
            out=out,
            workers=workers or options.available_cores(),
            watcher=watcher,
            call=options.call(),
        )
    _print(outcome.rungs)
    wrote(*outcome.files)
    go_on("report", out)
    for error in sorted(set(outcome.failed)):
        notice(f"{outcome.failed.count(error)} runs failed: {error}")
    sys.exit(FAILED if outcome.failed else 0)


def _print(rungs: Sequence[Rung]) -> None:
    lines = [
        {
            "scene": rung.scene,
            "method": rung.method,
            "seeds": rung.seeds,
            "s per point": f"{rung.seconds:.4f}",
            **{
                name.replace("_", " "): f"{_share(rung.error[name])} ({_share(rung.worst[name])})"
                for name in rung.error
            },
        }
        for rung in rungs
    ]
    say(table(lines, n_keys=3))
    say("\nrelative errors: root mean square over points and policies (and the worst)")


def _share(error: float) -> str:
    """A large one as a factor, which says more."""
    return f"{error:.1%}" if error < LARGE else f"x {1 + error:.3g}"
