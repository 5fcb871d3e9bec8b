"""What `tolerance: 2%` saves on figure 4's grid: seeds of each point against one number for all.

    python experiments/stopping/savings.py    # savings.csv, from bench.csv

bench.csv has how well each profit is known after so many seeds, and so its deviation. From that
follows how many seeds make its interval (t of 97.5 %, as in a sweep) 2 % wide on either side. A
fixed number with the same worst-case precision is the largest of them, at every point.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from pathlib import Path

from scipy.special import stdtrit

from simmpp.sweeps.profits import MEASURES
from simmpp.sweeps.stopping import CORRECTED, FEWEST

HERE = Path(__file__).parent
TOLERANCE, DEFAULT_MOST = 0.02, 64
CASES = {"ray and concurrent": ("ray", "concurrent"), "concurrent": ("concurrent",)}

Row = dict[str, str]


def deviation(row: Row, measure: str) -> float:
    """Relative deviation of a profit over seeds."""
    seeds = int(row["reference_seeds"]) + int(row["seeds"])
    return float(row[f"{measure}_resolution"]) * math.sqrt(seeds)


def seeds_for(relative_deviation: float) -> int:
    """The least number of seeds, 8 at least, whose interval is within the tolerance."""
    n, percentile = FEWEST, (1 + CORRECTED) / 2
    while stdtrit(n - 1, percentile) * relative_deviation / math.sqrt(n) > TOLERANCE:
        n += 1
    return n


def needed(rows: Iterable[Row], policies: Iterable[str]) -> dict[tuple[str, float], int]:
    """Seeds of each (scene, x): those of its widest profit."""
    found: dict[tuple[str, float], int] = {}
    for row in rows:
        if row["policy"] in policies:
            at = (row["scene"], float(row["fraction"]))
            n = max(seeds_for(deviation(row, measure)) for measure in MEASURES)
            found[at] = max(found.get(at, FEWEST), n)
    return found


def main() -> None:
    """Write a row for each case and point; print the sums."""
    with open(HERE / "bench.csv", encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["method"] == "simulate"]
    single = [row for row in rows if row["seeds"] == "1"]
    with open(HERE / "savings.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["policies", "scene", "fraction", "seeds"])
        for case, policies in CASES.items():
            seeds = needed(single, policies)
            writer.writerows([case, *at, n] for at, n in seeds.items())
            for most in (DEFAULT_MOST, 10**9):
                told(case, [min(n, most) for n in seeds.values()], most)


def told(case: str, seeds: list[int], most: int) -> None:
    """Print what a case comes to."""
    limit = f"max_seeds {most}" if most < 10**9 else "no limit"
    share = sum(seeds) / (max(seeds) * len(seeds))
    print(
        f"{case}, {limit}: {min(seeds)} to {max(seeds)} seeds, {sum(seeds)} in all; a fixed number "
        f"would take {max(seeds) * len(seeds)}: {share:.2f}"
    )


if __name__ == "__main__":
    main()
