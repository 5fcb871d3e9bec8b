"""``simmpp compare``: sweeps side by side, and what differs more than seeds do."""

from __future__ import annotations

from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.folders import FolderArgument, GivenFolder, by_name
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import at_work, notice, say
from simmpp.report.page.comparison import Comparison, causes, compared, outcome, write_comparison
from simmpp.report.page.difference import NAMES, SideBySide, changes_by_measure, line, ranked
from simmpp.report.page.folder import read_folder
from simmpp.report.page.standing import warnings_of_each

SHOWN = 25
"""Lines of the table of what moved."""


@click.command(
    "compare",
    epilog=options.examples(
        "simmpp compare results/before results/after --out difference.html",
        "simmpp compare t3e=results/t3e fast=results/fast slow=results/slow",
    ),
)
@click.argument("before", metavar="BEFORE", type=FolderArgument())
@click.argument("after", metavar="AFTER", type=FolderArgument())
@click.argument("others", metavar="[AFTER]...", type=FolderArgument(), nargs=-1)
@options.path("--out", "Write a page with the curves.", metavar="FILE.html")
def compare_command(
    before: GivenFolder, after: GivenFolder, others: tuple[GivenFolder, ...], out: Path | None
) -> None:
    """Compare the rows of two folders, point by point.

    More folders are compared with the first, one by one; NAME=DIR is what tables and page call a
    folder. Seeds that both have are compared one by one; a difference is sure if it lies beyond the
    95 % interval of their ratios. Always exits with 0 (2 for what can't be read): for a verdict in
    continuous integration there is check.
    """
    options.writable(out, "--out", ".html")
    paths = _named([before, after, *others])
    arguments = ["BEFORE", *["AFTER"] * (len(paths) - 1)]
    with at_work("reading rows"):
        folders = {
            name: read_folder(path, argument)
            for (name, path), argument in zip(paths.items(), arguments, strict=True)
        }
        pairs = compared(folders)
    for warned in warnings_of_each(folders):
        notice(str(warned))
    for pair in pairs:
        _print(pair, heading=f"{pair.name}:" if len(pairs) > 1 else "")
    if out is not None:
        with at_work("writing the page"):
            write_comparison(folders, out)
        say(f"{out}: {out.stat().st_size / 1e6:.1f} MB")
    for pair in pairs:
        of = f"{pair.name}: " if len(pairs) > 1 else ""
        say(f"compare: {of}{outcome(pair.sweeps)}")


def _named(given: list[GivenFolder]) -> dict[str, Path]:
    """Two without names are what they are to each other."""
    if len(given) == len(NAMES) and not any(one.name for one in given):
        return {name: one.path for name, one in zip(NAMES, given, strict=True)}
    return by_name(given)


def _print(pair: Comparison, heading: str) -> None:
    if heading:
        say(heading)
    if pair.sweeps.common:
        _print_changes(pair.sweeps)
    for name, points in pair.sweeps.only:
        for point in points[:SHOWN]:
            say(f"only {name}: {point}")
        if len(points) > SHOWN:
            say(f"... and {len(points) - SHOWN} more only {name}")
    say()
    for reason in causes(pair.before, pair.after, pair.sweeps.names):
        say(reason)


def _print_changes(sweeps: SideBySide) -> None:
    say(table(changes_by_measure(sweeps), n_keys=1))
    say()
    changes = ranked(sweeps.changes)
    if changes:
        say(table([line(change, sweeps.names) for change in changes[:SHOWN]], n_keys=2))
    if len(changes) > SHOWN:
        say(f"... and {len(changes) - SHOWN} smaller ones; a page (--out) has more")
