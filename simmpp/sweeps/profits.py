"""``profits.csv``: what each policy gains over object dataflow, over all seeds of a point.

Source: Nebel 1998, section 4 (figures 3 to 5).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from statistics import fmean
from typing import NamedTuple

from simmpp.common.files import Row, sort_key
from simmpp.methods.columns import KEYS, PLACE
from simmpp.policy.parameters import CEILING, REFERENCE
from simmpp.run.profit import efficiency, ratio, speedup
from simmpp.run.rows import Seeds, by_place, finished, has_ended, pairs
from simmpp.sweeps.intervals import interval
from simmpp.sweeps.stopping import corrected_interval

MEASURES = {"time_profit": "makespan_ps", "message_profit": "messages"}
"""Each profit and the column that it is a ratio of."""
SIMULATION = "simulation"
"""What rows may tell besides their columns: the simulation that they are of. A point whose seeds
share one has nothing that is drawn."""
NOISY = "noisy"
"""Likewise, that its seeds differ wherever objects are."""
ROUNDING = 1e-9
"""A half-width that is exactly the tolerance may be rounded to more."""
STATISTICS = ("", "_low", "_high", "_min", "_max")


def profit_columns(further: Sequence[str] = ()) -> tuple[str, ...]:
    """The columns of ``profits.csv``."""
    measured = tuple(measure + statistic for measure in MEASURES for statistic in STATISTICS)
    return (*_keys(further), "n", *measured, "speedup", "efficiency")


def _keys(further: Sequence[str]) -> tuple[str, ...]:
    return (*(key for key in KEYS if key != "seed"), *further)


def profit_rows(
    rows: Iterable[Row], further: Sequence[str] = (), tolerance: Fraction | None = None
) -> list[Row]:
    """One row for each point, over its seeds; ``further`` columns are keys as well.

    A seed counts if its run and its reference's have no error; n is their number. An interval
    needs two seeds and finite profits, and is empty otherwise; with a ``tolerance`` it makes up
    for a number of seeds that was chosen by their values. What rows do not know is empty, too.
    """
    profits: list[Row] = []
    for policies in by_place(rows, (*PLACE, *further)).values():
        references = policies.get(REFERENCE, {})
        profits += [_over_seeds(of, references, further, tolerance) for of in policies.values()]
    return profits_in_order(profits, further)


def profits_in_order(profits: Iterable[Row], further: Sequence[str] = ()) -> list[Row]:
    """Sorted by their keys."""
    return sorted(profits, key=lambda row: sort_key(row, _keys(further)))


def _over_seeds(
    seeds: Seeds, references: Seeds, further: Sequence[str], tolerance: Fraction | None
) -> Row:
    """The row of one policy at one place."""
    any_row, both = next(iter(seeds.values())), pairs(references, seeds)
    result: Row = {name: any_row[name] for name in _keys(further)}
    effective = [row["effective_fraction"] for row in finished(seeds).values()]
    result["effective_fraction"] = _mean(effective)
    result["n"] = len(both)
    for measure, column in MEASURES.items():
        values = profits_of(both, column)
        bounds = _bounds(values, both, tolerance)
        result |= {measure + name: value for name, value in _statistics(values, bounds).items()}
    known = [row for _, row in both if row["compute_ps"] != ""]
    result["speedup"] = _mean([speedup(row) for row in known])
    result["efficiency"] = _mean([efficiency(row) for row in known])
    return result


def profits_of(both: Sequence[tuple[Row, Row]], column: str) -> list[float]:
    """The ratio of a column of each seed's reference and run; none where one is not known."""
    known = [(base.get(column, ""), row.get(column, "")) for base, row in both]
    return [ratio(above, below) for above, below in known if above != "" and below != ""]


def _bounds(
    values: Sequence[float], both: Sequence[tuple[Row, Row]], tolerance: Fraction | None
) -> tuple[float, float] | None:
    if not values or tolerance is None:
        return interval(values) if values else None
    return corrected_interval(values, tolerance, is_drawn=_is_drawn(both))


def _is_drawn(both: Sequence[tuple[Row, Row]]) -> bool:
    """Whether the profit of another seed could be another one.

    Not so where all seeds are one simulation, where the run is its own reference, and where PEs
    hold either nothing but their own objects or all, unless there is noise.
    """
    simulations = {(base.get(SIMULATION), row.get(SIMULATION)) for base, row in both}
    replicated = any(1 / row["processors"] < row["effective_fraction"] < 1 for _, row in both)
    is_noisy = any(row.get(NOISY) for _, row in both)
    several = len(simulations) > 1 and any(a != b for a, b in simulations)
    return several and (replicated or is_noisy)


def best_policy(rows: Iterable[Row], further: Sequence[str] = ()) -> tuple[str, float] | None:
    """The dataflow with the highest time profit, and its geometric mean: the reference's is 1.

    Policies are compared over the points and seeds that all of them have finished; None as long as
    there are none.
    """
    done = (row for row in rows if has_ended(row))
    places = by_place(done, (*PLACE, *further)).values()
    titles = dict.fromkeys(title for policies in places for title in policies)
    logarithms: dict[str, list[float]] = {title: [] for title in titles if title != CEILING}
    for policies in places:
        if len(policies) < len(titles) or REFERENCE not in titles:
            continue
        for seed in set.intersection(*map(set, policies.values())):
            times_ps = {title: seeds[seed]["makespan_ps"] for title, seeds in policies.items()}
            if all(times_ps.values()):
                for title, values in logarithms.items():
                    values.append(math.log(times_ps[REFERENCE] / times_ps[title]))
    if not any(logarithms.values()) or len(titles) == 1:
        return None
    best = max(logarithms, key=lambda title: fmean(logarithms[title]))
    return best, math.exp(fmean(logarithms[best]))


def _mean(values: Sequence[float]) -> float | str:
    return fmean(values) if values else ""


def _statistics(values: Sequence[float], bounds: tuple[float, float] | None) -> dict[str, object]:
    """Mean, interval, extremes; what can't be said is empty."""
    if not values:
        return dict.fromkeys(STATISTICS, "")
    numbers = (fmean(values), *(bounds or ("", "")), min(values), max(values))
    return dict(zip(STATISTICS, numbers, strict=True))


class Missed(NamedTuple):
    """A profit whose interval is wider than the tolerance."""

    row: Row
    """Of ``profits.csv``."""
    measure: str
    half_width: float
    """Of the interval, relative to the mean."""


def missed(profits: Iterable[Row], tolerance: Fraction) -> list[Missed]:
    """Profits that all the seeds there may be have not made known within the tolerance."""
    known = [
        Missed(row, measure, (row[f"{measure}_high"] - row[f"{measure}_low"]) / 2 / row[measure])
        for row in profits
        for measure in MEASURES
        if all(_is_number(row[name]) for name in (measure, f"{measure}_low")) and row[measure]
    ]
    return [profit for profit in known if profit.half_width > float(tolerance) * (1 + ROUNDING)]


def _is_number(cell: object) -> bool:
    return isinstance(cell, float) and math.isfinite(cell)
