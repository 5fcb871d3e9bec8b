"""``simmpp report``: the rows of a folder as one page; its figures as files, if asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.folders import NAMED, FolderArgument, GivenFolder, by_name
from simmpp.commands.parts.terminal import at_work, notice, progress_bars
from simmpp.common.errors import ConfigError
from simmpp.common.units import counted
from simmpp.report.page.beside import FIGURES_FOLDER
from simmpp.report.page.figures.stills import Still, stills_of, write_stills
from simmpp.report.page.folder import Folder, read_folder
from simmpp.report.page.report import PAGE, follow, report_of, write_page
from simmpp.report.page.standing import standing_of
from simmpp.report.page.together import together


@click.command(
    "report",
    epilog=options.examples(
        "simmpp report results/sweep",
        "simmpp report results/sweep --figures time-profit --figures speedup",
        "simmpp report --live results/sweep",
        "simmpp report t3e=results/t3e fast=results/fast slow=results/slow --out machines.html",
    ),
)
@click.argument("folders", metavar=f"{NAMED}...", type=FolderArgument(), nargs=-1, required=True)
@click.option(
    "--figures",
    "names",
    multiple=True,
    metavar="[all|NAME]",
    help="Draw this figure in figures beside the page too, as PNG and SVG; the page has the names. "
    "Repeatable.",
)
@click.option(
    "--live",
    is_flag=True,
    help="Keep the page up to date while a sweep works in DIR; ends with it, or with Ctrl-C.",
)
@options.path(
    "--out",
    f"The page.  [default: DIR/{PAGE}; of several folders {PAGE}, here]",
    metavar="FILE.html",
)
def report_command(
    folders: tuple[GivenFolder, ...], names: tuple[str, ...], live: bool, out: Path | None
) -> None:
    """Make a page of what sweep, run, bench or reproduce wrote.

    DIR is their folder. Writes DIR/report.html, which opens in any browser and loads nothing from
    anywhere: who wins where and how surely, the curves, and every number of the point that is
    clicked on. Several folders, which may be given as NAME=DIR, have one page that shows them side
    by side and over each other.
    """
    options.writable(out, "--out", ".html")
    paths = by_name(folders)
    if live:
        _follow(paths, out)
    with at_work("reading rows"):
        folder = _read(paths, folders[0].name, (out or Path(PAGE)).parent)
        report = report_of(folder)
    stills = stills_of(report.figures, names)
    page = out or folder.path / PAGE
    to = page.parent / FIGURES_FOLDER
    if stills:
        options.claim(to, "DIR")  # a sweep may be at work in DIR itself
    options.folder(page.parent, "DIR")
    with at_work("writing the page"):
        write_page(report, stills=[still.stem for still in stills], path=page)
    click.echo(f"{page}: {len(folder.rows)} rows, {page.stat().st_size / 1e6:.1f} MB")
    for warned in report.warnings():
        notice(str(warned))
    if stills:
        _draw(stills, to)


def _read(paths: Mapping[str, Path], called: str, at: Path) -> Folder:
    """The folder, or all of them together as one that lies where their page does."""
    if len(paths) == 1:
        (path,) = paths.values()
        return replace(read_folder(path), called=called)
    return together({name: read_folder(path) for name, path in paths.items()}, at)


def _follow(paths: Mapping[str, Path], out: Path | None) -> None:
    """Say how many rows are done whenever the page is written."""
    if len(paths) > 1 or out is not None:
        raise ConfigError("--live: expected one folder, and no --out: its page is in it")
    (folder_path,) = paths.values()
    notice(f"{folder_path / PAGE}: reloads itself while the sweep runs")
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
