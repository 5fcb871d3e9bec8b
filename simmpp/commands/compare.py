"""``simmpp compare``: two sweeps side by side, and what differs more than seeds do."""

from __future__ import annotations

from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import say
from simmpp.report.page.comparison import causes, outcome, write_comparison
from simmpp.report.page.difference import (
    SideBySide,
    changes_by_measure,
    difference_of,
    line,
    ranked,
)
from simmpp.report.page.folder import read_folder

SHOWN = 25
"""Lines of the table of what moved."""


@click.command(
    "compare",
    epilog=options.examples("simmpp compare results/before results/after --out difference.html"),
)
@click.argument("before_path", metavar="BEFORE", type=options.NamedPath())
@click.argument("after_path", metavar="AFTER", type=options.NamedPath())
@options.path("--out", "Write a page with the curves.", metavar="FILE.html")
def compare_command(before_path: Path, after_path: Path, out: Path | None) -> None:
    """Compare the rows of two folders, point by point.

    Seeds that both have are compared one by one; a difference is sure if it lies beyond the 95 %
    interval of their ratios. Always exits with 0 (2 for what can't be read): for a verdict in
    continuous integration there is check.
    """
    options.writable(out, "--out", ".html")
    before, after = read_folder(before_path, "BEFORE"), read_folder(after_path, "AFTER")
    difference = difference_of(before, after)
    _print(difference)
    for reason in causes(before, after):
        say(reason)
    if out is not None:
        write_comparison(before, after, difference, out)
        say(f"{out}: {out.stat().st_size / 1e6:.1f} MB")
    say(f"compare: {outcome(difference)}")


def _print(difference: SideBySide) -> None:
    say(table(changes_by_measure(difference), n_keys=1))
    say()
    changes = ranked(difference.changes)
    if changes:
        say(table([line(change) for change in changes[:SHOWN]], n_keys=2))
    if len(changes) > SHOWN:
        say(f"... and {len(changes) - SHOWN} smaller ones; a page (--out) has more")
    for name, points in (("before", difference.only_before), ("after", difference.only_after)):
        for point in points[:SHOWN]:
            say(f"only {name}: {point}")
        if len(points) > SHOWN:
            say(f"... and {len(points) - SHOWN} more only {name}")
    say()
