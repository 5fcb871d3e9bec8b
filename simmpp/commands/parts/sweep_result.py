"""What a sweep came to: its profits as a table, how well they are known, what failed."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from pandas import DataFrame

from simmpp.commands.parts.tables import Fitting, table
from simmpp.commands.parts.terminal import FAILED, notice, say
from simmpp.config.settings import Settings
from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.folder import read_folder
from simmpp.run.rows import PROFITS, RESULTS
from simmpp.sweeps.profits import missed
from simmpp.sweeps.sweep import SweepResult
from simmpp.sweeps.winners.answer import answer
from simmpp.sweeps.winners.fit_table import fit_table
from simmpp.sweeps.winners.machines import Machines, machines_of
from simmpp.sweeps.winners.points import Points, points_of

PROFITS_SHOWN = 40


def print_result(result: SweepResult, settings: Settings, out: Path) -> int:
    """Print who wins, the profits, and what failed; the exit code."""
    points, machines = _points(out)
    for sentence in answer(points, machines):
        say(sentence.text)
    say()
    if any(points.unfit) and len(lines := fit_table(points)) > 1:
        say(table(lines[:PROFITS_SHOWN], n_keys=len(points.axes), is_sweep=True))
        say()
    rows = result.rows
    failed = rows[rows["error"].notna()]
    say(_table(result))
    if (more := len(_profits(result)) - PROFITS_SHOWN) > 0:
        say(f"... {more} more in {out / PROFITS}")
    unfit = int((rows["makespan_ps"].isna() & rows["error"].isna()).sum())
    of_unfit = f", {unfit} without a result for want of memory" if unfit else ""
    say(f"\n{len(rows)} rows, {len(failed)} failed{of_unfit}: {out / RESULTS}")
    if settings.tolerance is not None:
        for line in _reached(result, settings.tolerance, settings.max_seeds):
            say(line)
    for error, count in failed["error"].value_counts().items():
        notice(f"{count} failed: {error}")
    return FAILED if len(failed) else 0


def _points(out: Path) -> tuple[Points, Machines | None]:
    """What the page of the folder is made of."""
    folder = read_folder(out)
    points = points_of(
        folder.rows, folder.further, folder.profits, folder.labels, folder.confidence
    )
    return points, machines_of(points, folder.record)


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


def _table(result: SweepResult) -> Fitting:
    """The first profits."""
    names = _names(result)
    rows = [
        {
            **{name: _cell(row[name]) for name in names},
            "seeds": row["n"],
            "time profit": _profit(row, "time_profit"),
            "message profit": _profit(row, "message_profit"),
        }
        for row in _profits(result).head(PROFITS_SHOWN).to_dict("records")
    ]
    return table(rows, n_keys=len(names), is_sweep=True)


def _profits(result: SweepResult) -> DataFrame:
    """Those of all policies but the reference, whose own say nothing."""
    return result.profits[result.profits["policy"] != REFERENCE]


def _cell(value: object) -> str:
    if value is None or value != value:
        return ""
    return f"{value:g}" if isinstance(value, float) else str(value)


def _profit(row: Mapping[Hashable, float], measure: str) -> str:
    """Mean and half of the 95 % interval."""
    mean, low, high = (row[measure + end] for end in ("", "_low", "_high"))
    text = _cell(mean) if mean != mean or mean == float("inf") else f"{mean:.3f}"
    return text if low != low else f"{text} +- {(high - low) / 2:.3f}"
