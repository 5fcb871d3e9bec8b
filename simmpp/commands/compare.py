"""``simmpp compare``: two sweeps side by side, and what differs more than seeds do."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from simmpp.commands.options import NamedPath

if TYPE_CHECKING:
    from simmpp.report.page.difference import Difference

SHOWN = 25
"""Lines of the table of what moved."""


@click.command("compare")
@click.argument("before_path", metavar="BEFORE", type=NamedPath())
@click.argument("after_path", metavar="AFTER", type=NamedPath())
@click.option("--out", type=NamedPath(), metavar="FILE.html", help="Write a page with the curves.")
def compare_command(before_path: Path, after_path: Path, out: Path | None) -> None:
    """Compare the rows of two folders, point by point.

    Seeds that both have are compared one by one; a difference is sure if it lies beyond the 95 %
    interval of their ratios. Always exits with 0 (2 for what can't be read): for a verdict in
    continuous integration there is check.
    """
    from simmpp.commands.options import writable
    from simmpp.report.page.comparison import reasons, verdict, write_comparison
    from simmpp.report.page.difference import difference_of
    from simmpp.report.page.folder import read_folder

    writable(out, "--out", ".html")
    before, after = read_folder(before_path, "BEFORE"), read_folder(after_path, "AFTER")
    found = difference_of(before, after)
    _print(found)
    for reason in reasons(before, after):
        click.echo(reason)
    if out is not None:
        write_comparison(before, after, found, out)
        click.echo(f"{out}: {out.stat().st_size / 1e6:.1f} MB")
    click.echo(f"compare: {verdict(found)}")


def _print(found: Difference) -> None:
    from simmpp.commands.terminal import output, table
    from simmpp.report.page.difference import changes_by_measure, line, ranked

    console = output()
    console.print(table(changes_by_measure(found)))
    console.print()
    changes = ranked(found.changes)
    if changes:
        console.print(table([line(change) for change in changes[:SHOWN]]))
    if len(changes) > SHOWN:
        console.print(f"... and {len(changes) - SHOWN} smaller ones; a page (--out) has more")
    for name, points in (("before", found.only_before), ("after", found.only_after)):
        for point in points[:SHOWN]:
            console.print(f"only {name}: {point}", soft_wrap=True)
        if len(points) > SHOWN:
            console.print(f"... and {len(points) - SHOWN} more only {name}")
    console.print()
