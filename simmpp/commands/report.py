"""``simmpp report``: the rows of a folder as one page, and its figures as files."""

from __future__ import annotations

from pathlib import Path

import click

from simmpp.commands import options
from simmpp.commands.terminal import notice, progress_bars
from simmpp.report.page.beside import FIGURES_FOLDER
from simmpp.report.page.figures.stills import write_stills
from simmpp.report.page.folder import read_folder
from simmpp.report.page.report import PAGE, Report, follow, report_of, write_page


@click.command(
    "report",
    epilog=options.examples("simmpp report results/sweep", "simmpp report --live results/sweep"),
)
@click.argument("folder_path", metavar="DIR", type=options.NamedPath())
@click.option(
    "--live",
    is_flag=True,
    help="Keep the page up to date while a sweep works in DIR; ends with it, or with Ctrl-C.",
)
def report_command(folder_path: Path, live: bool) -> None:
    """Make a page of what sweep, run, bench or reproduce wrote.

    DIR is their folder. Writes DIR/report.html, which opens in any browser and loads nothing from
    anywhere: who wins where and how surely, the curves, and every number of the point that is
    clicked on; and each figure in DIR/figures as PNG and SVG.
    """
    if live:
        _follow(folder_path, folder_path / PAGE)
    report = report_of(read_folder(folder_path))
    options.claim(folder_path / FIGURES_FOLDER, "DIR")  # a sweep may be at work in DIR itself
    page = write_page(report)
    click.echo(f"{page}: {len(report.folder.rows)} rows, {page.stat().st_size / 1e6:.1f} MB")
    _draw(report)


def _follow(folder_path: Path, page: Path) -> None:
    """Say how many rows are done whenever the page is written."""
    notice(f"{page}: reloads itself while the sweep runs")
    try:
        for present in follow(folder_path):
            failed = f", {len(present.failed)} failed" if present.failed else ""
            notice(f"{len(present.rows)} of {present.planned} rows{failed}")
    except KeyboardInterrupt:
        write_page(report_of(read_folder(folder_path)))  # reloads itself no more
        raise


def _draw(report: Report) -> None:
    """The figures as files, with a bar."""
    to = report.folder.path / FIGURES_FOLDER
    plates = sum(len(figure.plates) for figure in report.figures)
    with progress_bars() as bars:
        task = bars.add_task("drawing", total=plates)
        for _ in write_stills(report.figures, to):
            bars.advance(task)
    click.echo(f"{to}: {plates} figures, as PNG and SVG")
