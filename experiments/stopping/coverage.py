"""Does `tolerance: 2%` hold its word, and what does it save? On grids it was not developed on.

    python experiments/stopping/coverage.py noisy|quiet|full    # writes coverage-GRID.csv

Each point is simulated with a pool of seeds. The first 200 give the true profits. The rest is a
stream of draws: a repetition takes from it what the rule asks for (the functions that sweeps call),
the next repetition begins where it ended, so all are independent of each other and of the truth
(which all repetitions of a point share). Each repetition reports an interval for either profit of
either policy; it should hold the true one 95 times of 100.

*noisy*: small scenes, where profits vary so much that most points end at max_seeds. *quiet*: larger
scenes and small pictures, chosen (by the deviation over 20 seeds) so that the rule stops between 8
and 64 seeds. *full*: pictures of figure 4.

The rule was developed on artificial distributions and on mountain:3, tetra:3, rings:2 and balls:2
with 8 and 32 PEs. None of these sizes and numbers of PEs is here; mountain and tetra are, larger.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.files import write_csv
from simmpp.run.profit import ratio
from simmpp.sweeps.profits import MEASURES
from simmpp.sweeps.stopping import FEWEST, corrected_interval, seeds_wanted
from simmpp.sweeps.sweep import run_sweep

HERE = Path(__file__).parent
TOLERANCE, TRUE = Fraction(1, 50), 200
POLICIES = ("ray", "concurrent")
GRIDS: dict[str, dict[str, Any]] = {
    "noisy": {
        "points": list(
            product(
                ("mountain:4", "tetra:4", "lattice:3", "jacks:3", "tree:6"),
                (16, 64),
                (0.15, 0.35, 0.6, 0.85),
            )
        ),
        "resolution": 24,
        "pool": 1800,
    },
    "quiet": {
        "points": [
            *product(("mountain:5", "tetra:6", "lattice:6", "jacks:4"), (24,), (0.06, 0.12, 0.25)),
            ("tree:8", 24, 0.06),
        ],
        "resolution": {"mountain:5": 64, "tetra:6": 64, "jacks:4": 32},
        "pool": 700,
    },
    "full": {
        "points": [("tetra:5", 64, 0.1), ("tetra:5", 64, 0.3)],
        "resolution": 512,
        "pool": 440,
    },
}
"""`pool` is the number of seeds of each point."""
MOST, REPETITIONS, PIXELS = 64, 40, 48
"""Seeds of a repetition and repetitions of a point at most; resolution where none is said."""

Floats = NDArray[np.float64]
Row = dict[str, str | int | float]


def profits_of(point: tuple[str, int, float], grid: dict[str, Any]) -> Floats:
    """Profits of a point: (policy, measure, seed) float64."""
    scene, nb, x = point
    resolution = grid["resolution"]
    if isinstance(resolution, dict):
        resolution = resolution.get(scene, PIXELS)
    config = {
        "scene": scene,
        "reading": "plain",
        "picture": {"resolution": resolution},
        "processors": nb,
        "memory": {"fraction": x},
        "policy": list(POLICIES),
        "seeds": list(range(grid["pool"])),
    }
    rows = run_sweep(config).rows
    wide = rows.pivot(index="seed", columns="policy", values=list(MEASURES.values()))
    return np.array(
        [
            [
                [ratio(int(a), int(b)) for a, b in zip(of["object"], of[policy], strict=True)]
                for of in (wide[column] for column in MEASURES.values())
            ]
            for policy in POLICIES
        ]
    )


def repetitions(profits: Floats) -> Iterator[Floats]:
    """What each repetition draws, by the rule of a sweep: (policy, measure, n)."""
    begin = TRUE
    for _ in range(REPETITIONS):
        n, taken = 0, FEWEST
        while taken > n and begin + taken <= profits.shape[2]:
            n = taken
            values = profits[:, :, begin : begin + n].reshape(-1, n).tolist()
            taken = seeds_wanted(values, n, TOLERANCE, MOST)
        if taken != n:
            return  # the stream ends
        yield profits[:, :, begin : begin + n]
        begin += n


def rows_of(point: tuple[str, int, float], profits: Floats) -> list[Row]:
    """A row for each policy and profit: how often its interval held the true one."""
    drawn = list(repetitions(profits))
    sizes = [each.shape[2] for each in drawn]
    rows: list[Row] = []
    for (p, policy), (m, measure) in product(enumerate(POLICIES), enumerate(MEASURES)):
        pool = profits[p, m]
        true, wide, held, held_by_all, begin = fmean(pool[:TRUE]), [], 0, 0, TRUE
        for each in drawn:
            values = each[p, m].tolist()
            low, high = corrected_interval(values, TOLERANCE, is_drawn=True) or (np.nan, np.nan)
            others = np.delete(pool, slice(begin, begin + len(values))).mean()
            begin += len(values)
            held += bool(low <= true <= high)
            held_by_all += bool(low <= others <= high)
            wide.append((high - low) / (high + low))
        deviation = float(pool.std(ddof=1))
        centred = (pool - pool.mean()) / (deviation or 1)
        rows.append(
            {
                "scene": point[0],
                "processors": point[1],
                "fraction": point[2],
                "policy": policy,
                "profit": measure,
                "true": true,
                "relative_deviation": deviation / float(pool.mean()),
                "skewness": float((centred**3).mean()),
                "mean_seeds": fmean(sizes),
                "mean_half_width": fmean(wide),
                "repetitions": len(drawn),
                "held": held,
                "held_by_all_others": held_by_all,
            }
        )
    return rows


def share(rows: Sequence[Row], column: str = "held") -> float:
    """Share of intervals that held."""
    return sum(int(row[column]) for row in rows) / sum(int(row["repetitions"]) for row in rows)


def summary(rows: Sequence[Row]) -> Iterator[str]:
    """What came out, in words."""
    points: dict[tuple[object, ...], Row] = {
        (row["scene"], row["processors"], row["fraction"]): row for row in rows
    }
    pairs = sum(int(row["repetitions"]) for row in points.values())
    yield f"{len(points)} points, {pairs} (point, repetition) pairs, {4 * pairs} intervals"
    yield f"held: {share(rows):.1%}; against the mean of all other seeds {_all(rows):.1%}"
    classes = {
        "ray": [row for row in rows if row["policy"] == "ray"],
        "concurrent": [row for row in rows if row["policy"] == "concurrent"],
        "time profit": [row for row in rows if row["profit"] == "time_profit"],
        "message profit": [row for row in rows if row["profit"] == "message_profit"],
        "the widest of its point": list(_widest(rows)),
    }
    classes |= {
        f"{low} to {high} seeds": [row for row in rows if low <= float(row["mean_seeds"]) < high]
        for low, high in ((8, 16), (16, 32), (32, 64), (64, 65))
    }
    for name, chosen in classes.items():
        if chosen:
            both = f"{share(chosen):.1%}, all others {_all(chosen):.1%}"
            yield f"  {name}: {both} of {_count(chosen)}"
    seeds = [float(row["mean_seeds"]) for row in points.values()]
    yield (
        f"seeds of a point: {min(seeds):.0f} to {max(seeds):.0f}, mean {fmean(seeds):.1f}: "
        f"{fmean(seeds) / max(seeds):.2f} of the runs of a fixed number with that precision"
    )
    needed = [float(row["relative_deviation"]) ** 2 for row in _widest(rows)]
    yield f"without max_seeds: {fmean(needed) / max(needed):.2f} of them, from the deviations"
    worst = sorted(rows, key=lambda row: int(row["held"]) / int(row["repetitions"]))[:8]
    for row in worst:
        yield "  worst: " + ", ".join(
            f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row.values()
        )


def _all(rows: Sequence[Row]) -> float:
    return share(rows, "held_by_all_others")


def _count(rows: Sequence[Row]) -> int:
    return sum(int(row["repetitions"]) for row in rows)


def _widest(rows: Sequence[Row]) -> Iterator[Row]:
    """Of each point the profit that decides on the number of seeds."""
    for i in range(0, len(rows), 4):
        yield max(rows[i : i + 4], key=lambda row: float(row["relative_deviation"]))


def main(name: str) -> None:
    """Simulate, count, write."""
    grid, rows = GRIDS[name], list[Row]()
    for point in grid["points"]:
        rows += rows_of(point, profits_of(point, grid))
        print(point, share(rows[-4:]), rows[-1]["mean_seeds"], flush=True)
    write_csv(rows, list(rows[0]), HERE / f"coverage-{name}.csv")
    for line in summary(rows):
        print(line)


if __name__ == "__main__":
    main(sys.argv[1])
