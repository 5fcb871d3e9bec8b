"""``simmpp check``: does a configuration still give what it gave? For continuous integration."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import click

from simmpp.commands.options import NamedPath, available_cores, set_option, workers_option

if TYPE_CHECKING:
    from simmpp.config.config import Config
    from simmpp.studies.check.baseline import Sweep
    from simmpp.studies.check.moves import Move

MOVED = 1
MOVES_SHOWN = 25
"""Lines of each table."""
MOVED_CSV, OVERLAY = "moved.csv", "profits"


@click.command("check")
@click.argument("config_path", metavar="CONFIG", type=NamedPath())
@click.option(
    "--baseline",
    "baseline_path",
    required=True,
    metavar="FILE",
    type=NamedPath(),
    help="A profits.csv with results.csv and run.json beside it.",
)
@click.option("--update", is_flag=True, help="Make what comes out now the baseline.")
@click.option(
    "--out",
    type=NamedPath(),
    help="Folder for what came out: the tables, moved.csv, and the curves over the baseline's.",
)
@workers_option("Processes, as for sweep.")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, as for sweep.")
@click.option("--engine", help="The event loop; it changes no integer.")
@set_option("Set a dotted key: what would move? The baseline stays that of CONFIG as it is.")
def check_command(
    config_path: Path,
    baseline_path: Path,
    update: bool,
    out: Path | None,
    workers: int | None,
    cluster: str | None,
    engine: str | None,
    overrides: tuple[str, ...],
) -> None:
    """Compare a sweep with its baseline; exit with 1 if something moved, and say what.

    Runs are deterministic, so every integer of results.csv must be the baseline's. With
    tolerances in CONFIG, such as `check: {time_profit: 2%}`, only the profits named there are
    compared, each by its relative change. --update makes the baseline, or makes it anew.
    """
    from simmpp.commands.options import folder
    from simmpp.common.errors import ConfigError
    from simmpp.config.config import load_config
    from simmpp.studies.check.baseline import baseline_folder, read_baseline

    if update and overrides:
        raise ConfigError("expected --update or --set: a baseline is of CONFIG as it is")
    if workers is not None and cluster is not None:
        raise ConfigError("expected --workers or --cluster, got both")
    config = load_config(config_path)
    engines = () if engine is None else (f"engine={engine}",)
    trial = load_config(config_path, (*overrides, *engines))
    baseline = None if update else read_baseline(baseline_path, config)
    target = baseline_folder(baseline_path)
    folder(out, "--out")
    with TemporaryDirectory(prefix="simmpp-check-") as temporary:
        now = _swept(trial, workers, cluster, Path(temporary))
        if baseline is None:
            sys.exit(_update(config, now, Path(temporary), baseline_path, target))
        sys.exit(_compare(config, baseline, now, Path(temporary), out))


def _swept(config: Config, workers: int | None, cluster: str | None, into: Path) -> Sweep:
    """The sweep, always run anew."""
    from simmpp.commands.sweeping import progress_of_sweep
    from simmpp.studies.check.baseline import read_sweep
    from simmpp.sweeps.sweep import run_sweep

    with progress_of_sweep() as watcher:
        run_sweep(
            config,
            workers=workers or available_cores(),
            cluster=cluster,
            out=into,
            watcher=watcher,
        )
    return read_sweep(into)


def _compare(config: Config, baseline: Sweep, now: Sweep, obtained: Path, out: Path | None) -> int:
    """Print what moved and write the artefacts; the exit code."""
    from simmpp.studies.check.baseline import reasons
    from simmpp.studies.check.moves import moves

    found = moves(baseline.tables, now.tables, config.settings.check.tolerances)
    rows = f"{len(now.tables.results)} rows, {len(now.tables.profits)} points"
    if found:
        _print(found, reasons(baseline, now))
    if out:
        _write(found, baseline, now, obtained, out)
    click.echo(f"check: {rows}: {f'{len(found)} values moved' if found else 'nothing moved'}")
    return MOVED if found else 0


def _update(config: Config, now: Sweep, obtained: Path, named: Path, target: Path) -> int:
    """Write the baseline and say what is new in it; the exit code."""
    from simmpp.commands.terminal import notice
    from simmpp.common.errors import ConfigError
    from simmpp.studies.check.baseline import UPDATE, read_baseline, reasons, write_baseline
    from simmpp.studies.check.moves import moves

    failed = [row for row in now.tables.results if row["error"]]
    if failed:
        notice(f"{len(failed)} rows failed, so the baseline stays as it was: {failed[0]['error']}")
        return MOVED
    try:
        old = read_baseline(named, config)
    except ConfigError as error:
        if named.exists():
            notice(f"not compared: {error.problem.removesuffix(f': {UPDATE}')}")
    else:
        found = moves(old.tables, now.tables, {})
        if found:
            _print(found, reasons(old, now))
        click.echo(f"check: {len(found) or 'no'} values of the baseline moved")
    write_baseline(obtained, target)
    click.echo(f"check: baseline of {len(now.tables.results)} rows in {target}")
    return 0


def _print(found: Sequence[Move], why: Sequence[str]) -> None:
    from simmpp.commands.terminal import output, table
    from simmpp.studies.check.moves import lines, moves_by_measure

    console = output()
    console.print(table(moves_by_measure(found)))
    curves = [move for move in found if move.of_curve]
    for part in filter(None, (curves, [move for move in found if not move.of_curve])):
        console.print()
        console.print(table([_rounded(line) for line in lines(part, MOVES_SHOWN)]))
        if len(part) > MOVES_SHOWN:
            rest = len(part) - MOVES_SHOWN
            console.print(f"... and {rest} smaller moves; {MOVED_CSV} in --out has all")
    console.print()
    for reason in why:
        console.print(reason, soft_wrap=True)


def _rounded(line: Mapping[str, str]) -> dict[str, str]:
    """Profits with as many digits as people read."""
    cells = dict(line)
    for side in ("baseline", "now"):
        if "." in cells[side]:
            cells[side] = f"{float(cells[side]):.5g}"
    return cells


def _write(found: Sequence[Move], baseline: Sweep, now: Sweep, obtained: Path, out: Path) -> None:
    """What a failed check leaves for people: tables and a picture."""
    from simmpp.common.files import write_csv
    from simmpp.report.page.overlay import overlay
    from simmpp.run.rows import PROFITS, RECORD, RESULTS
    from simmpp.studies.check.moves import lines

    for name in (PROFITS, RESULTS, RECORD):
        shutil.copyfile(obtained / name, out / name)
    moved = lines(found)
    columns = list(moved[0]) if moved else ["measure", "baseline", "now", "change", "allowed"]
    write_csv(moved, columns, out / MOVED_CSV)
    overlay(baseline.tables.profits, now.tables.profits, out / OVERLAY)
