"""``simmpp check``: does a configuration still give what it gave? For continuous integration."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from simmpp.commands.parts import options
from simmpp.commands.parts.own_policies import tell_files
from simmpp.commands.parts.progress import progress_of_sweep
from simmpp.commands.parts.tables import table
from simmpp.commands.parts.terminal import FAILED, go_on, notice, progress_bars, say
from simmpp.common.errors import ConfigError
from simmpp.common.files import copy, write_csv
from simmpp.common.folders import BASELINE, CHECK
from simmpp.common.units import counted
from simmpp.config.config import Config, load_config
from simmpp.run.rows import PROFITS, RECORD, RESULTS
from simmpp.studies.check.baseline import (
    UPDATE,
    baseline_folder,
    read_baseline,
    read_sweep,
    reasons,
    write_baseline,
)
from simmpp.studies.check.moves import Move, Sweep, lines, moves, moves_by_measure
from simmpp.sweeps.sweep import run_sweep

MOVES_SHOWN = 25
"""Lines of each table."""
MOVED_CSV, OVERLAY = "moved.csv", "profits"


@click.command(
    "check",
    epilog=options.examples(
        "simmpp check configs/ci.yaml --baseline experiments/baselines/ci/profits.csv --out moved",
        "simmpp check configs/ci.yaml --baseline baselines/profits.csv --update",
    ),
)
@options.config_argument
@options.path(
    "--baseline",
    "A profits.csv with results.csv and run.json beside it.",
    metavar="FILE",
    required=True,
)
@click.option("--update", is_flag=True, help="Make what comes out now the baseline.")
@options.no_code
@options.path(
    "--out",
    "Folder for what came out: the tables, moved.csv, and curves that moved over the baseline's.",
)
@options.workers("Processes, as for sweep.")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, as for sweep.")
@options.engine("The event loop; it changes no integer.")
@options.setting("Set a dotted key: what would move? The baseline stays that of CONFIG as it is.")
def check_command(
    config_path: Path,
    baseline: Path,
    update: bool,
    out: Path | None,
    workers: int | None,
    cluster: str | None,
    engine: tuple[str, ...],
    overrides: tuple[str, ...],
    may_run: bool,
) -> None:
    """Compare a sweep with its baseline; exit with 1 if it moved.

    Says what moved, and why. Runs are deterministic, so every integer of results.csv must be the
    baseline's. With tolerances in CONFIG, such as `check: {time_profit: 2%}`, only the profits
    named there are compared, each by its relative change. --update makes the baseline, or makes it
    anew.
    """
    if update and overrides:
        raise ConfigError("expected --update or --set: a baseline is of CONFIG as it is")
    if workers is not None and cluster is not None:
        raise ConfigError("expected --workers or --cluster, got both")
    config = load_config(config_path, may_run=may_run)
    trial = load_config(config_path, (*overrides, *engine), may_run=may_run)
    tell_files(trial)
    before = None if update else read_baseline(baseline, config)
    target = baseline_folder(baseline)
    options.claim(out, "--out", CHECK)
    options.claim(target if update else None, "--baseline", BASELINE)
    with TemporaryDirectory(prefix="simmpp-check-") as temporary:
        now = _swept(trial, workers, cluster, Path(temporary))
        if before is None:
            code = _update(config, now, Path(temporary), baseline, target)
            if not code:
                go_on("check", config_path, "--baseline", baseline)
            sys.exit(code)
        sys.exit(_compare(config, before, now, Path(temporary), out))


def _swept(config: Config, workers: int | None, cluster: str | None, into: Path) -> Sweep:
    """The sweep, always run anew."""
    with progress_of_sweep() as watcher:
        run_sweep(
            config,
            workers=workers or options.available_cores(),
            cluster=cluster,
            out=into,
            watcher=watcher,
        )
    return read_sweep(into)


def _compare(config: Config, baseline: Sweep, now: Sweep, obtained: Path, out: Path | None) -> int:
    """Print what moved and write the artefacts; the exit code."""
    moved = moves(baseline, now, config.settings.check.tolerances)
    rows = f"{len(now.results)} rows, {len(now.profits)} points"
    if moved:
        _print(moved, reasons(config, baseline, now))
    for error, count in Counter(row["error"] for row in now.results if row["error"]).items():
        notice(f"{counted(count, 'row')} failed: {error}")
    if out:
        _write(moved, baseline, now, obtained, out)
    say(f"check: {rows}: {f'{len(moved)} values moved' if moved else 'nothing moved'}")
    return FAILED if moved else 0


def _update(config: Config, now: Sweep, obtained: Path, named: Path, target: Path) -> int:
    """Write the baseline and say what is new in it; the exit code."""
    failed = [row for row in now.results if row["error"]]
    if failed:
        notice(f"{len(failed)} rows failed, so the baseline stays as it was: {failed[0]['error']}")
        return FAILED
    try:
        old = read_baseline(named, config)
    except ConfigError as error:
        if named.exists():
            notice(f"not compared: {error.problem.removesuffix(f': {UPDATE}')}")
    else:
        moved = moves(old, now, {})
        if moved:
            _print(moved, reasons(config, old, now))
        say(f"check: {len(moved) or 'no'} values of the baseline moved")
    write_baseline(obtained, target)
    say(f"check: baseline of {len(now.results)} rows in {target}")
    return 0


def _print(moved: Sequence[Move], why: Sequence[str]) -> None:
    say(table(moves_by_measure(moved), n_keys=1))
    curves = [move for move in moved if move.of_curve]
    for part in filter(None, (curves, [move for move in moved if not move.of_curve])):
        say()
        shown = [_rounded(line) for line in lines(part, MOVES_SHOWN)]
        say(table(shown, n_keys=list(shown[0]).index("measure") + 1))
        if len(part) > MOVES_SHOWN:
            rest = len(part) - MOVES_SHOWN
            say(f"... and {rest} smaller moves; {MOVED_CSV} in --out has all")
    say()
    for reason in why:
        say(reason)


def _rounded(line: Mapping[str, str]) -> dict[str, str]:
    """Profits with as many digits as people read; errors, which may hold anything, as they are."""
    cells = dict(line)
    for side in ("baseline", "now"):
        with suppress(ValueError):
            if "." in cells[side]:
                cells[side] = f"{float(cells[side]):.5g}"
    return cells


def _write(moved: Sequence[Move], baseline: Sweep, now: Sweep, obtained: Path, out: Path) -> None:
    """What a check leaves for people: tables, and a picture of the curves that moved."""
    for name in (PROFITS, RESULTS, RECORD):
        copy(obtained / name, out / name)
    cells = lines(moved)
    columns = list(cells[0]) if cells else ["measure", "baseline", "now", "change", "allowed"]
    write_csv(cells, columns, out / MOVED_CSV)
    for suffix in (".png", ".svg"):
        (out / f"{OVERLAY}{suffix}").unlink(missing_ok=True)  # of an earlier check
    if moved:
        # Only this draws, and matplotlib takes half a second.
        from simmpp.report.page.overlay import overlay

        with progress_bars() as bars:
            bars.add_task("drawing", total=None)
            overlay(baseline.profits, now.profits, out / OVERLAY)
