"""``profits.csv``: what each policy gains over object dataflow, over all seeds of a point.

Source: Nebel 1998, section 4 (figures 3 to 5); intervals are Student's (1908).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import fmean

from simmpp.sweeps.point import REFERENCE
from simmpp.sweeps.rows import KEYS
from simmpp.sweeps.tables import Row, sort_key

CONFIDENCE = 0.95
"""Of the intervals from low to high."""
MEASURES = ("time_profit", "message_profit")
STATISTICS = ("", "_low", "_high", "_min", "_max")


def profit_columns(further: Sequence[str] = ()) -> tuple[str, ...]:
    """The columns of ``profits.csv``."""
    measured = tuple(measure + statistic for measure in MEASURES for statistic in STATISTICS)
    return (*_keys(further), "n", *measured, "speedup", "efficiency")


def _keys(further: Sequence[str]) -> tuple[str, ...]:
    return (*(key for key in KEYS if key != "seed"), *further)


def profit_rows(rows: Iterable[Row], further: Sequence[str] = ()) -> list[Row]:
    """One row for each point, over its seeds; ``further`` columns are keys as well.

    A seed counts if its run and its reference's have no error; n is their number. An interval
    needs two seeds and finite profits, and is empty otherwise.
    """
    names = [name for name in _keys(further) if name != "effective_fraction"]
    points: dict[tuple[object, ...], dict[int, Row]] = {}
    for row in rows:
        points.setdefault(tuple(row[name] for name in names), {})[row["seed"]] = row
    at = names.index("policy")
    found = [
        _over_seeds(by_seed, points.get((*key[:at], REFERENCE, *key[at + 1 :]), {}), further)
        for key, by_seed in points.items()
    ]
    return sorted(found, key=lambda row: sort_key(row, _keys(further)))


def _over_seeds(by_seed: dict[int, Row], references: dict[int, Row], further: Sequence[str]) -> Row:
    """The row of one policy at one point."""
    good = [by_seed[seed] for seed in sorted(by_seed) if not by_seed[seed]["error"]]
    pairs = [
        (row, references[row["seed"]])
        for row in good
        if row["seed"] in references and not references[row["seed"]]["error"]
    ]
    first = next(iter(by_seed.values()))
    result: Row = {name: first[name] for name in _keys(further)}
    result["effective_fraction"] = _mean([row["effective_fraction"] for row in good])
    result["n"] = len(pairs)
    for measure, column in zip(MEASURES, ("makespan_ps", "messages"), strict=True):
        values = [ratio(base[column], row[column]) for row, base in pairs]
        result |= {measure + name: value for name, value in _statistics(values).items()}
    # one PE with everything in memory does nothing but compute
    speedups = [ratio(row["compute_ps"], row["makespan_ps"]) for row, _ in pairs]
    result["speedup"] = _mean(speedups)
    result["efficiency"] = _mean([speedup / first["processors"] for speedup in speedups])
    return result


def best_policy(rows: Iterable[Row], further: Sequence[str] = ()) -> tuple[str, float] | None:
    """The policy with the highest time profit, and its geometric mean.

    Policies are compared over the points and seeds that all of them have finished; None as long as
    there are none.
    """
    names = [name for name in (*_keys(further), "seed") if name != "effective_fraction"]
    names.remove("policy")
    points: dict[tuple[object, ...], dict[str, Row]] = {}
    for row in rows:
        if not row["error"]:
            points.setdefault(tuple(row[name] for name in names), {})[row["policy"]] = row
    titles = dict.fromkeys(policy for policies in points.values() for policy in policies)
    common = [
        policies
        for policies in points.values()
        if len(policies) == len(titles) and all(row["makespan_ps"] for row in policies.values())
    ]
    if REFERENCE not in titles or len(titles) == 1 or not common:
        return None
    means = {
        title: fmean(
            math.log(of[REFERENCE]["makespan_ps"] / of[title]["makespan_ps"]) for of in common
        )
        for title in titles
        if title != REFERENCE
    }
    best = max(means, key=lambda title: means[title])
    return best, math.exp(means[best])


def _mean(values: Sequence[float]) -> float | str:
    return fmean(values) if values else ""


def ratio(reference: int, value: int) -> float:
    """reference / value; nothing over nothing is 1, something over nothing is infinite."""
    if value:
        return reference / value
    return math.inf if reference else 1.0


def _statistics(values: Sequence[float]) -> dict[str, object]:
    """Mean, Student's interval, extremes; what can't be said is empty."""
    if not values:
        return dict.fromkeys(STATISTICS, "")
    low, high = interval(values) or ("", "")
    numbers = (fmean(values), low, high, min(values), max(values))
    return dict(zip(STATISTICS, numbers, strict=True))


def interval(values: Sequence[float]) -> tuple[float, float] | None:
    """The 95 % confidence interval of the mean of independent draws; None if they can't tell."""
    from scipy.special import stdtrit  # takes half a second

    n, mean = len(values), fmean(values)
    if n < 2 or not math.isfinite(mean):
        return None
    deviation = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / (n - 1))
    half = float(stdtrit(n - 1, (1 + CONFIDENCE) / 2)) * deviation / math.sqrt(n)
    return mean - half, mean + half
