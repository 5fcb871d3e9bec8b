"""``simmpp reproduce``: the figures and claims of Nebel 1998, simulated."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

from simmpp.commands import options
from simmpp.commands.progress import progress_of_sweep
from simmpp.commands.terminal import FAILED, announce_compilation, notice, output, table
from simmpp.studies.nebel98.reproduce import Reproduction, reproduce


@click.command(
    "reproduce",
    epilog=options.examples(
        "simmpp reproduce", "simmpp reproduce --resolution 64 --seeds 2 --out results/look"
    ),
)
@options.path(
    "--out",
    "Folder of rows, figures and claims.csv.",
    default=Path("results", "nebel98"),
    show_default=True,
)
@click.option(
    "--seeds",
    type=options.Whole(1, 10_000),
    metavar="N",
    help="Draws of each point.  [default: the experiments' 8]",
)
@options.workers("Processes on this machine.  [default: one for each core]")
@click.option(
    "--resolution",
    type=options.Whole(1, 16384),
    metavar="R",
    help="Pixels along each side, for a quick look.  [default: the paper's 512]",
)
def reproduce_command(
    out: Path, seeds: int | None, workers: int | None, resolution: int | None
) -> None:
    """Repeat the experiments of Nebel 1998 and judge its claims.

    Writes the rows of each figure (CSV) with the configuration they are of, the figures (PNG and
    SVG) and claims.csv. The same command continues what was interrupted; more seeds, or another
    resolution, add to what is there. Exits with 1 if a point failed.
    """
    options.folder(out, "--out")
    announce_compilation()
    began_s = time.monotonic()
    with progress_of_sweep() as watcher:
        outcome = reproduce(
            out,
            seeds=seeds,
            resolution=resolution,
            workers=workers or options.available_cores(),
            watcher=watcher,
        )
    _print(outcome)
    click.echo(f"\n{out}: rows, figures and claims.csv, in {time.monotonic() - began_s:.0f} s")
    sys.exit(FAILED if outcome.failed else 0)


def _print(outcome: Reproduction) -> None:
    columns = ("claim", "holds", "simulated")
    output().print(table([{c: getattr(v, c) for c in columns} for v in outcome.verdicts]))
    for error in sorted(set(outcome.failed)):
        notice(f"{outcome.failed.count(error)} points failed: {error}")
