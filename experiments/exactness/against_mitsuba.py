"""Hits and distances against Mitsuba 3, many rays: writes against_mitsuba.csv beside this file.

    python experiments/exactness/against_mitsuba.py [RAYS of each depth, default 20000]

The comparison is that of tests/verify/test_mitsuba.py (install
'.[test]'), on pictures of 256 x 256.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import asdict
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1] / "tests"), str(HERE.parents[1] / "tests" / "verify")]

from oracles.mitsuba_hits import compare  # noqa: E402
from test_mitsuba import MESHES, SPD, reflective  # noqa: E402

RESOLUTION = 256


def main() -> None:
    """Print and write a row per scene."""
    n_rays = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    rows = []
    for spec in (*SPD, *MESHES):
        got = asdict(compare(reflective(spec), RESOLUTION, n_rays))
        got["largest_difference"] = f"{got['largest_difference']:.1e}"
        rows.append({"scene": spec, **got})
        print(rows[-1], flush=True)
    with (HERE / "against_mitsuba.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main()
