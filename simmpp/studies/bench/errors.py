"""How far off a quicker estimate is, and how long it takes: errors of rungs from their runs.

A rung is a method with a number of seeds: what it says is the mean over these. Its error is taken
against the mean of all other seeds simulated at full fidelity, which it has no part in, and over as
many disjoint groups of seeds as there are (root mean square). Below the standard error of that
mean, the resolution, an error can't be told from that of the reference.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from statistics import fmean, stdev
from typing import NamedTuple

from simmpp.common.files import Row
from simmpp.methods.columns import METHOD
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.policy.parameters import REFERENCE
from simmpp.run.rows import Seeds, by_place
from simmpp.sweeps.profits import MEASURES, profits_of

QUANTITIES = {"makespan": "makespan_ps", "messages": "messages", **MEASURES}
"""What is compared, and the column that it is made of."""
CPU = "cpu_s"
"""What rows of a bench tell besides their columns: seconds of the processor."""
ERROR_COLUMNS = tuple(name + end for name in QUANTITIES for end in ("_error", "_resolution"))


Runs = Mapping[str, Mapping[str, Seeds]]
"""The runs of one point, by method and policy."""


def bench_columns(keys: Sequence[str]) -> tuple[str, ...]:
    """The columns of ``bench.csv``."""
    about = ("policy", "method", "seeds", "groups", "reference_seeds", "trace_s", CPU)
    return (*keys, *about, *ERROR_COLUMNS)


def bench_rows(rows: Iterable[Row], keys: Sequence[str], trace_s: Mapping[str, float]) -> list[Row]:
    """A row for each rung, policy and point; ``rows`` are those of all methods, without errors.

    ``keys`` name a point, ``trace_s`` are the seconds that tracing took, by scene.
    """
    methods: dict[tuple[object, ...], dict[str, dict[str, Seeds]]] = {}
    for (*place, method), policies in by_place(rows, (*keys, METHOD)).items():
        methods.setdefault(tuple(place), {})[str(method)] = policies
    lines: list[Row] = []
    for names, runs in methods.items():
        key = dict(zip(keys, names, strict=True))
        key["trace_s"] = trace_s.get(str(key["scene"]), "")
        for policy in runs.get(SIMULATE, {}):  # nothing else can be judged
            lines += [key | rung for rung in _rungs(runs, policy)]
    return lines


def seed_counts(method: str, simulated: int) -> list[int]:
    """1, 2, 4, ... seeds: at most a quarter of those simulated, lest the rest is no reference."""
    most = METHODS[method].most_seeds or simulated
    return [2**n for n in range(most.bit_length()) if 2**n <= min(most, max(simulated // 4, 1))]


def _rungs(runs: Runs, policy: str) -> Iterator[Row]:
    n_full = len(runs[SIMULATE][policy])
    for method, policies in runs.items():
        seeds = sorted(policies.get(policy, {}))
        for count in seed_counts(method, n_full):
            groups = [seeds[i : i + count] for i in range(0, len(seeds) - count + 1, count)]
            if groups and n_full > count + 1:
                yield _rung(runs, policy, method, groups)


def _rung(runs: Runs, policy: str, method: str, groups: Sequence[Sequence[int]]) -> Row:
    of_seed, count = runs[method][policy], len(groups[0])
    row: Row = {"policy": policy, "method": method, "seeds": count, "groups": len(groups)}
    row["reference_seeds"] = len(runs[SIMULATE][policy]) - count
    row[CPU] = fmean(sum(of_seed[seed][CPU] for seed in group) for group in groups)
    for name in QUANTITIES:
        estimates, true = (_values(runs[of], policy, name) for of in (method, SIMULATE))
        row[f"{name}_error"] = _error(estimates, true, groups)
        row[f"{name}_resolution"] = _resolution(list(true.values()))
    return row


def _values(policies: Mapping[str, Seeds], policy: str, quantity: str) -> dict[int, float]:
    """A quantity of each seed; object dataflow gains nothing over itself, which says nothing."""
    of_seed, column = policies[policy], QUANTITIES[quantity]
    if quantity not in MEASURES:
        return {seed: row[column] for seed, row in of_seed.items() if row[column] != ""}
    if policy == REFERENCE:
        return {}
    base = policies.get(REFERENCE, {})
    both = {seed: [(base[seed], row)] for seed, row in of_seed.items() if seed in base}
    profits = {seed: profits_of(pair, column) for seed, pair in both.items()}
    return {seed: values[0] for seed, values in profits.items() if values}


def _error(
    estimates: Mapping[int, float], true: Mapping[int, float], groups: Sequence[Sequence[int]]
) -> float | str:
    """Root mean square over groups of the relative error; empty where there is none."""
    if not estimates or not true:
        return ""
    errors = []
    for group in groups:
        estimate = fmean(estimates[seed] for seed in group)
        reference = fmean(value for seed, value in true.items() if seed not in group)
        errors.append(_relative(estimate, reference))
    return "" if any(map(math.isnan, errors)) else root_mean_square(errors)


def _relative(estimate: float, reference: float) -> float:
    """Nothing for nothing is right, and so is infinity for infinity; something for nothing is nan,
    for no factor tells how wrong that is."""
    if estimate == reference:
        return 0.0
    return estimate / reference - 1 if reference else math.nan


def _resolution(values: Sequence[float]) -> float | str:
    """The relative standard error of the mean."""
    if len(values) < 2 or not all(map(math.isfinite, values)):
        return ""
    mean = fmean(values)
    return stdev(values) / math.sqrt(len(values)) / mean if mean else 0.0


class Rung(NamedTuple):
    """A method with a number of seeds over all points of a scene."""

    scene: str
    method: str
    seeds: int
    seconds: float
    """Of the processor, for a point and all its policies, object dataflow included."""
    error: dict[str, float]
    """Root mean square over points and policies, by quantity; nan where there is none."""
    worst: dict[str, float]
    resolution: dict[str, float]
    """Root mean square of the reference's."""


def rungs(rows: Iterable[Row], keys: Sequence[str]) -> list[Rung]:
    """Rows of ``bench.csv`` by scene, method and seeds; ``keys`` name a point."""
    lines: dict[tuple[str, str, int], list[Row]] = {}
    for row in rows:
        lines.setdefault((row["scene"], row["method"], row["seeds"]), []).append(row)
    return [_over_points(*name, of_rung, keys) for name, of_rung in lines.items()]


def _over_points(
    scene: str, method: str, seeds: int, rows: Sequence[Row], keys: Sequence[str]
) -> Rung:
    points = {tuple(row[key] for key in keys) for row in rows}
    error = {name: _known(rows, f"{name}_error") for name in QUANTITIES}
    return Rung(
        scene,
        method,
        seeds,
        sum(row[CPU] for row in rows) / len(points),
        {name: root_mean_square(values) for name, values in error.items()},
        {name: max(values, default=math.nan) for name, values in error.items()},
        {name: root_mean_square(_known(rows, f"{name}_resolution")) for name in QUANTITIES},
    )


def _known(rows: Sequence[Row], column: str) -> list[float]:
    return [row[column] for row in rows if row[column] != ""]


def root_mean_square(values: Sequence[float]) -> float:
    """nan for none."""
    return math.sqrt(fmean(value**2 for value in values)) if values else math.nan
