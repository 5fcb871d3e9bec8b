"""Rays of the SPD's default scenes beside the two published tables: writes spd_counts.csv.

    python experiments/exactness/spd_counts.py

Besides the tracer as it is, variants that show what a difference hangs on: hits nearer to where a
ray starts than a share of the scene's diagonal are left out (other tracers' epsilon), or rays are
traced to another depth.
"""

from __future__ import annotations

import sys
from pathlib import Path

from simmpp.common.files import write_csv
from simmpp.workload.trace import geometry

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.published_counts import HAINES, HAVRAN, QUANTITIES, traced_counts

HERE = Path(__file__).parent
AS_IT_IS, DEPTH = geometry.T_MIN, 5
VARIANTS = (
    ("as it is", AS_IT_IS, DEPTH),
    ("no hits within 3e-4", 3e-4, DEPTH),
    ("no hits within 1e-2", 1e-2, DEPTH),
    ("depth 6", AS_IT_IS, 6),
)


def percent(count: int, published: int | None) -> str:
    """How much a count exceeds the published one."""
    return "" if not published else f"{100 * (count / published - 1):+.2f}"


def rows(name: str, variant: str, counts: tuple[int, ...]) -> list[dict[str, object]]:
    """A row per quantity of one scene."""
    table: list[dict[str, object]] = []
    for column, quantity in enumerate(QUANTITIES):
        haines = HAINES[name][column] if name in HAINES else None
        havran = HAVRAN[name][column]
        table.append(
            {
                "scene": name,
                "variant": variant,
                "quantity": quantity,
                "haines": "" if haines is None else haines,
                "havran": havran,
                "ours": counts[column],
                "percent_of_haines": percent(counts[column], haines),
                "percent_of_havran": percent(counts[column], havran),
            }
        )
    return table


def main() -> None:
    """Print the counts and write the table."""
    table: list[dict[str, object]] = []
    for name in HAVRAN:
        for variant, least, depth in VARIANTS:
            geometry.T_MIN = least
            table += rows(name, variant, traced_counts(name, depth))
            print(name, variant, *(row["ours"] for row in table[-len(QUANTITIES) :]), flush=True)
    write_csv(table, list(table[0]), HERE / "spd_counts.csv")


if __name__ == "__main__":
    main()
