"""``simmpp reproduce``: the figures and claims of Nebel 1998, simulated."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.progress import progress_of_sweep
from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import FAILED, announce_compilation, go_on, notice, say
from simmpp.common.errors import ConfigError
from simmpp.config.reading import load_reading
from simmpp.studies.nebel98.reproduce import Reproduction, named, reproduce
from simmpp.studies.nebel98.verdict import PAPER


@click.command(
    "reproduce",
    epilog=options.examples(
        "simmpp reproduce --reading plain --reading mixed",
        "simmpp reproduce --resolution 64 --seeds 2 --out results/look",
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
@click.option(
    "--reading",
    "readings",
    multiple=True,
    metavar="NAME",
    help="What the paper is taken to mean (see `simmpp reading`), or a file; repeatable.",
)
@options.workers("Processes on this machine.  [default: one for each core]")
@click.option(
    "--resolution",
    type=options.Whole(1, 16384),
    metavar="R",
    help="Pixels along each side, for a quick look.  [default: the paper's 512]",
)
def reproduce_command(
    out: Path,
    seeds: int | None,
    readings: tuple[str, ...],
    workers: int | None,
    resolution: int | None,
) -> None:
    """Repeat the experiments of Nebel 1998 and judge its claims.

    Writes the rows of each figure (CSV) with the configuration they are of, the figures (PNG and
    SVG) and claims.csv. The same command continues what was interrupted; more seeds, or another
    resolution, add to what is there. With several readings each has its folder in --out, and
    claims.csv says first which it is of. Exits with 1 if a point failed.
    """
    _refuse_unknown(readings)
    options.folder(out, "--out")
    announce_compilation()
    began_s = time.monotonic()
    with progress_of_sweep(options.call()) as watcher:
        done = reproduce(
            out,
            readings=readings,
            seeds=seeds,
            resolution=resolution,
            workers=workers or options.available_cores(),
            watcher=watcher,
            call=options.call(),
        )
    _print(done)
    say(f"\n{out}: rows, figures and claims.csv, in {time.monotonic() - began_s:.0f} s")
    for one in done:
        go_on("report", out if len(done) == 1 else out / one.reading)
    sys.exit(FAILED if any(one.failed for one in done) else 0)


def _refuse_unknown(readings: Sequence[str]) -> None:
    """Before the folder is made: a mistake in a file is told with its place."""
    try:
        for reading in readings:
            load_reading(reading)
        named(readings)
    except ConfigError as error:
        raise error if error.where else ConfigError(f"--reading: {error.problem}") from None


def _print(done: Sequence[Reproduction]) -> None:
    """The paper's words and the verdict: of one reading with what was simulated, or of several."""
    names, last = (["holds"], ["simulated"]) if len(done) == 1 else ([o.reading for o in done], [])
    rows = [
        [
            verdict.claim,
            *(one.verdicts[n].holds for one in done),
            verdict.paper.removeprefix(PAPER),
            *([verdict.simulated] if last else []),
        ]
        for n, verdict in enumerate(done[0].verdicts)
    ]
    say(texts(["claim", *names, "the paper", *last], rows, whole=1 + len(names)))
    failed = [error for one in done for error in one.failed]
    for error in sorted(set(failed)):
        notice(f"{failed.count(error)} points failed: {error}")
