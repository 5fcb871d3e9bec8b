"""What a sweep came to: its profits as a table, how well they are known, what failed."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import click
from rich.table import Table

from simmpp.commands.parts.terminal import FAILED, notice, output
from simmpp.config.settings import Settings
from simmpp.policy.parameters import REFERENCE
from simmpp.sweeps.profits import missed
from simmpp.sweeps.sweep import SweepResult

PROFITS_SHOWN = 40


def print_result(result: SweepResult, settings: Settings, out: Path) -> int:
    """Print what came out; the exit code."""
    rows = result.rows
    failed = rows[rows["error"].notna()]
    output().print(_table(result))
    click.echo(f"\n{len(rows)} rows, {len(failed)} failed: {out / 'results.csv'}")
    if settings.tolerance is not None:
        for line in _reached(result, settings.tolerance, settings.max_seeds):
            click.echo(line)
    for error, count in failed["error"].value_counts().items():
        notice(f"{count} failed: {error}")
    return FAILED if len(failed) else 0


def _reached(result: SweepResult, tolerance: Fraction, most: int) -> Iterator[str]:
    """How many points have their profits within the tolerance, and which have not."""
    profits: list[dict[Any, Any]] = result.profits.to_dict("records")
    names = [name for name in _names(result) if name != "policy"]
    points: dict[tuple[object, ...], list[str]] = {
        tuple(_cell(row[name]) for name in names): [] for row in profits
    }
    for miss in missed(profits, tolerance):
        what = f"{miss.row['policy']} {miss.measure.replace('_', ' ')} +- {miss.half_width:.1%}"
        points[tuple(_cell(miss.row[name]) for name in names)].append(what)
    wide = {point: profits_of for point, profits_of in points.items() if profits_of}
    fewest, largest = result.profits["n"].min(), result.profits["n"].max()
    seeds = f"{fewest} seeds" if fewest == largest else f"{fewest} to {largest} seeds"
    yield (
        f"{len(points) - len(wide)} of {len(points)} points have both profits within "
        f"{float(tolerance):.3g}, with {seeds}"
    )
    for point, profits_of in list(wide.items())[:PROFITS_SHOWN]:
        where = ", ".join(f"{name} {cell}" for name, cell in zip(names, point, strict=True))
        yield f"not with max_seeds {most}: {where}: {', '.join(profits_of)}"
    if len(wide) > PROFITS_SHOWN:
        yield f"... and {len(wide) - PROFITS_SHOWN} more"


def _names(result: SweepResult) -> list[str]:
    """The columns that name a row of profits."""
    columns = list(result.profits.columns)
    return [name for name in columns[: columns.index("n")] if name != "effective_fraction"]


def _table(result: SweepResult) -> Table:
    """The first profits; the reference's own say nothing."""
    profits, names = result.profits[result.profits["policy"] != REFERENCE], _names(result)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in (*names, "seeds", "time profit", "message profit"):
        table.add_column(name, no_wrap=True, justify="left" if name in names else "right")
    for row in profits.head(PROFITS_SHOWN).to_dict("records"):
        cells = [_cell(row[name]) for name in (*names, "n")]
        table.add_row(*cells, _profit(row, "time_profit"), _profit(row, "message_profit"))
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
