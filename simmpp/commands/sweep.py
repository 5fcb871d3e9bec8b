"""``simmpp sweep``: all points of a configuration, as tables; interrupted, it can be continued."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from simmpp.commands.options import (
    FiniteRange,
    NamedPath,
    available_cores,
    set_option,
    workers_option,
)

if TYPE_CHECKING:
    from rich.table import Table

    from simmpp.config.settings import Settings
    from simmpp.sweeps.sweep import SweepResult

POINTS_FAILED = 1
PROFITS_SHOWN = 40


@click.command("sweep")
@click.argument("config_path", metavar="CONFIG", type=NamedPath())
@workers_option("Processes on this machine; 1 works in this one.  [default: one for each core]")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, such as tcp://host:8786.")
@click.option("--engine", help="The event loop.  [default: the key engine, or else compiled]")
@set_option(
    "Set a dotted key, such as memory.fraction=0.2 or sweep.processors='[8, 64]'; repeatable."
)
@click.option(
    "--timeout",
    "timeout_s",
    type=FiniteRange(0, min_open=True),
    metavar="SECONDS",
    help="A point that takes longer has failed.",
)
@click.option(
    "--out",
    type=NamedPath(),
    help="Folder of the tables.  [default: results/NAME-OF-CONFIG]",
)
def sweep_command(
    config_path: Path,
    workers: int | None,
    cluster: str | None,
    engine: str | None,
    overrides: tuple[str, ...],
    timeout_s: float | None,
    out: Path | None,
) -> None:
    """Simulate every combination of the values under the key sweep.

    Writes results.csv, results.parquet, profits.csv, timings.csv and run.json. Object dataflow is
    run as the reference of the profits, if it is not named, and has its rows. With a tolerance,
    seeds are added until the profits of each point are known that well. The same command
    continues what was interrupted, and tries failed points again. Exits with 1 if a point failed.
    """
    from simmpp.common.errors import ConfigError
    from simmpp.sweeps.executors import start_server

    if workers is not None and cluster is not None:
        raise ConfigError("expected --workers or --cluster, got both")
    workers = workers or available_cores()
    if workers > 1 and cluster is None:
        start_server()  # before the imports below take their time

    from simmpp.commands.options import folder
    from simmpp.commands.sweeping import progress_of_sweep
    from simmpp.commands.terminal import announce_compilation
    from simmpp.config.config import load_config
    from simmpp.sweeps.sweep import run_sweep

    if engine is not None:
        overrides = (*overrides, f"engine={engine}")
    config = load_config(config_path, overrides)
    out = Path("results", config_path.stem) if out is None else out
    folder(out, "--out")
    announce_compilation()
    with progress_of_sweep() as watcher:
        result = run_sweep(
            config,
            workers=workers,
            cluster=cluster,
            timeout_s=timeout_s,
            out=out,
            watcher=watcher,
        )
    sys.exit(_conclude(result, config.settings, out))


def _conclude(result: SweepResult, settings: Settings, out: Path) -> int:
    """Print what came out; the exit code."""
    from simmpp.commands.terminal import notice, output

    rows = result.rows
    failed = rows[rows["error"].notna()]
    output().print(_table(result))
    click.echo(f"\n{len(rows)} rows, {len(failed)} failed: {out / 'results.csv'}")
    if settings.tolerance is not None:
        for line in _reached(result, settings.tolerance, settings.max_seeds):
            click.echo(line)
    for error, count in failed["error"].value_counts().items():
        notice(f"{count} failed: {error}")
    return POINTS_FAILED if len(failed) else 0


def _reached(result: SweepResult, tolerance: Fraction, most: int) -> Iterator[str]:
    """How many points have their profits within the tolerance, and which have not."""
    from simmpp.sweeps.profits import missed

    profits: list[dict[Any, Any]] = result.profits.to_dict("records")
    names = [name for name in _names(result) if name != "policy"]
    points: dict[tuple[object, ...], list[str]] = {
        tuple(_cell(row[name]) for name in names): [] for row in profits
    }
    for each in missed(profits, tolerance):
        what = f"{each.row['policy']} {each.measure.replace('_', ' ')} +- {each.half_width:.1%}"
        points[tuple(_cell(each.row[name]) for name in names)].append(what)
    wide = {point: told for point, told in points.items() if told}
    fewest, largest = result.profits["n"].min(), result.profits["n"].max()
    seeds = f"{fewest} seeds" if fewest == largest else f"{fewest} to {largest} seeds"
    yield (
        f"{len(points) - len(wide)} of {len(points)} points have both profits within "
        f"{float(tolerance):.3g}, with {seeds}"
    )
    for point, told in list(wide.items())[:PROFITS_SHOWN]:
        where = ", ".join(f"{name} {cell}" for name, cell in zip(names, point, strict=True))
        yield f"not with max_seeds {most}: {where}: {', '.join(told)}"
    if len(wide) > PROFITS_SHOWN:
        yield f"... and {len(wide) - PROFITS_SHOWN} more"


def _names(result: SweepResult) -> list[str]:
    """The columns that name a row of profits."""
    columns = list(result.profits.columns)
    return [name for name in columns[: columns.index("n")] if name != "effective_fraction"]


def _table(result: SweepResult) -> Table:
    """The first profits; the reference's own say nothing."""
    from rich.table import Table

    from simmpp.policy.registry import REFERENCE

    profits, names = result.profits[result.profits["policy"] != REFERENCE], _names(result)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in (*names, "seeds", "time profit", "message profit"):
        table.add_column(name, no_wrap=True, justify="left" if name in names else "right")
    for row in profits.head(PROFITS_SHOWN).to_dict("records"):
        shown = [_cell(row[name]) for name in (*names, "n")]
        table.add_row(*shown, _profit(row, "time_profit"), _profit(row, "message_profit"))
    if len(profits) > PROFITS_SHOWN:
        table.add_row(f"... {len(profits) - PROFITS_SHOWN} more")
    return table


def _cell(value: object) -> str:
    if value is None or value != value:
        return ""
    return f"{value:g}" if isinstance(value, float) else str(value)


def _profit(row: Mapping[Hashable, float], measure: str) -> str:
    """Mean and half of the 95 % interval."""
    mean, low, high = (row[measure + end] for end in ("", "_low", "_high"))
    text = _cell(mean) if mean != mean or mean == float("inf") else f"{mean:.3f}"
    return text if low != low else f"{text} +- {(high - low) / 2:.3f}"
