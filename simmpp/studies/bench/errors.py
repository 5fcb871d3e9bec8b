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
MEASURED = tuple(name + end for name in QUANTITIES for end in ("_error", "_resolution"))


class Runs(NamedTuple):
    """The runs of one policy at one point, by method and seed."""

    key: Row
    """What names the point."""
    policy: str
    of_method: Mapping[str, Seeds]
    references: Mapping[str, Seeds]
    """Those of object dataflow."""


def bench_columns(keys: Sequence[str]) -> tuple[str, ...]:
    """The columns of ``bench.csv``."""
    about = ("policy", "method", "seeds", "groups", "reference_seeds", "trace_s", CPU)
    return (*keys, *about, *MEASURED)


def bench_rows(rows: Iterable[Row], keys: Sequence[str], trace_s: Mapping[str, float]) -> list[Row]:
    """A row for each rung, policy and point; ``rows`` are those of all methods, without errors.

    ``keys`` name a point, ``trace_s`` are the seconds that tracing took, by scene.
    """
    methods: dict[tuple[object, ...], dict[str, dict[str, Seeds]]] = {}
    for (*place, method), policies in by_place(rows, (*keys, METHOD)).items():
        methods.setdefault(tuple(place), {})[str(method)] = policies
    lines: list[Row] = []
    for names, of_method in methods.items():
        key = dict(zip(keys, names, strict=True))
        references = {method: of.get(REFERENCE, {}) for method, of in of_method.items()}
        for policy in of_method.get(SIMULATE, {}):  # nothing else can be judged
            of_policy = {method: of[policy] for method, of in of_method.items() if policy in of}
            runs = Runs(key, policy, of_policy, references)
            lines += [row | {"trace_s": trace_s.get(str(key["scene"]), "")} for row in _rungs(runs)]
    return lines


def seed_counts(method: str, simulated: int) -> list[int]:
    """1, 2, 4, ... seeds: at most a quarter of those simulated, lest the rest is no reference."""
    most = METHODS[method].most_seeds or simulated
    return [2**n for n in range(most.bit_length()) if 2**n <= min(most, max(simulated // 4, 1))]


def _rungs(runs: Runs) -> Iterator[Row]:
    full = runs.of_method.get(SIMULATE, {})
    for method, of_seed in runs.of_method.items():
        for count in seed_counts(method, len(full)):
            seeds = sorted(of_seed)
            groups = [seeds[i : i + count] for i in range(0, len(seeds) - count + 1, count)]
            if groups and len(full) > count + 1:
                yield _rung(runs, method, groups)


def _rung(runs: Runs, method: str, groups: Sequence[Sequence[int]]) -> Row:
    of_seed = runs.of_method[method]
    row: Row = {**runs.key, "policy": runs.policy, "method": method}
    row |= {"seeds": len(groups[0]), "groups": len(groups)}
    row["reference_seeds"] = len(runs.of_method[SIMULATE]) - len(groups[0])
    row[CPU] = fmean(sum(of_seed[seed][CPU] for seed in group) for group in groups)
    for name in QUANTITIES:
        estimates, true = _values(runs, method, name), _values(runs, SIMULATE, name)
        row[f"{name}_error"] = _error(estimates, true, groups)
        row[f"{name}_resolution"] = _resolution(list(true.values()))
    return row


def _values(runs: Runs, method: str, quantity: str) -> dict[int, float]:
    """A quantity of each seed; object dataflow gains nothing over itself, which says nothing."""
    of_seed, column = runs.of_method[method], QUANTITIES[quantity]
    if quantity not in MEASURES:
        return {seed: row[column] for seed, row in of_seed.items() if row[column] != ""}
    if runs.policy == REFERENCE:
        return {}
    base = runs.references[method]
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
