"""``simmpp report``: the rows of a folder as one page; its figures as files, if asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.terminal import notice, progress_bars
from simmpp.common.units import counted
from simmpp.report.page.beside import FIGURES_FOLDER
from simmpp.report.page.figures.stills import Still, stills_of, write_stills
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import PAGE, follow, report_of, write_page
from simmpp.report.page.standing import standing_of, warnings_of


@click.command(
    "report",
    epilog=options.examples(
        "simmpp report results/sweep",
        "simmpp report results/sweep --figures time-profit --figures speedup",
        "simmpp report --live results/sweep",
    ),
)
@click.argument("folder_path", metavar="DIR", type=options.NamedPath())
@click.option(
    "--figures",
    "names",
    multiple=True,
    metavar="[all|NAME]",
    help="Draw this figure in DIR/figures too, as PNG and SVG; the page has the names. Repeatable.",
)
@click.option(
    "--live",
    is_flag=True,
    help="Keep the page up to date while a sweep works in DIR; ends with it, or with Ctrl-C.",
)
def report_command(folder_path: Path, names: tuple[str, ...], live: bool) -> None:
    """Make a page of what sweep, run, bench or reproduce wrote.

    DIR is their folder. Writes DIR/report.html, which opens in any browser and loads nothing from
    anywhere: who wins where and how surely, the curves, and every number of the point that is
    clicked on.
    """
    if live:
        _follow(folder_path, folder_path / PAGE)
    report = report_of(read_folder(folder_path))
    stills = stills_of(report.figures, names)
    to = folder_path / FIGURES_FOLDER
    if stills:
        options.claim(to, "DIR")  # a sweep may be at work in DIR itself
    options.folder(folder_path, "DIR")
    page = write_page(report, stills=[still.stem for still in stills])
    click.echo(f"{page}: {len(report.folder.rows)} rows, {page.stat().st_size / 1e6:.1f} MB")
    for warned in warnings_of(report.folder):
        notice(str(warned))
    if stills:
        _draw(stills, to)


def _follow(folder_path: Path, page: Path) -> None:
    """Say how many rows are done whenever the page is written."""
    notice(f"{page}: reloads itself while the sweep runs")
    try:
        for present in follow(folder_path):
            notice(standing_of(present).progress)
    except KeyboardInterrupt:
        write_page(report_of(read_folder(folder_path)))  # reloads itself no more
        raise


def _draw(stills: Sequence[Still], to: Path) -> None:
    """The figures as files, with a bar."""
    with progress_bars() as bars:
        task = bars.add_task("drawing", total=len(stills))
        for _ in write_stills(stills, to, min(len(stills), options.available_cores())):
            bars.advance(task)
    click.echo(f"{to}: {counted(len(stills), 'figure')}, as PNG and SVG")
