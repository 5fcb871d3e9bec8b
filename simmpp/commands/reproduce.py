"""``simmpp reproduce``: the figures and claims of Nebel 1998, simulated."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from simmpp.commands.options import NamedPath, available_cores, workers_option

if TYPE_CHECKING:
    from simmpp.studies.nebel98.reproduce import Reproduction

POINTS_FAILED = 1


@click.command("reproduce")
@click.option(
    "--out",
    type=NamedPath(),
    default=Path("results", "nebel98"),
    show_default=True,
    help="Folder of rows, figures and claims.csv.",
)
@click.option(
    "--seeds",
    type=click.IntRange(1, 10_000),
    metavar="N",
    help="Draws of each point.  [default: the experiments' 8]",
)
@workers_option("Processes on this machine.  [default: one for each core]")
@click.option(
    "--resolution",
    type=click.IntRange(1, 16384),
    metavar="R",
    help="Pixels along each side, for a quick look.  [default: the paper's 512]",
)
def reproduce_command(
    out: Path, seeds: int | None, workers: int | None, resolution: int | None
) -> None:
    """Repeat the experiments of Nebel 1998 and judge each of its claims.

    Writes the rows of each figure (CSV) with the configuration they are of, the figures (PNG and
    SVG) and claims.csv. The same command continues what was interrupted; more seeds, or another
    resolution, add to what is there. Exits with 1 if a point failed.
    """
    from simmpp.commands.options import folder
    from simmpp.commands.sweeping import progress_of_sweep
    from simmpp.commands.terminal import announce_compilation
    from simmpp.studies.nebel98.reproduce import reproduce

    folder(out, "--out")
    announce_compilation()
    began_s = time.monotonic()
    with progress_of_sweep() as watcher:
        done = reproduce(
            out,
            seeds=seeds,
            resolution=resolution,
            workers=workers or available_cores(),
            watcher=watcher,
        )
    _print(done)
    click.echo(f"\n{out}: rows, figures and claims.csv, in {time.monotonic() - began_s:.0f} s")
    sys.exit(POINTS_FAILED if done.failed else 0)


def _print(done: Reproduction) -> None:
    from simmpp.commands.terminal import notice, output, table

    shown = [
        {"claim": each.claim, "holds": each.holds, "simulated": each.simulated}
        for each in done.verdicts
    ]
    output().print(table(shown))
    for error in sorted(set(done.failed)):
        notice(f"{done.failed.count(error)} points failed: {error}")
