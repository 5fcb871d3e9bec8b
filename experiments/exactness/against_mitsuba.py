"""Hits and distances against Mitsuba 3, many rays: writes against_mitsuba.csv beside this file.

    python experiments/exactness/against_mitsuba.py [RAYS of each depth, default 20000]

The comparison is that of tests/verify/test_mitsuba.py (install '.[test]'), on pictures of 256 x
256.
"""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

from simmpp.common.files import write_csv

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.mitsuba_hits import MESHES, SPD, compare, reflective

RESOLUTION = 256


def main() -> None:
    """Print and write a row per scene."""
    n_rays = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    rows = []
    for spec in (*SPD, *MESHES):
        row = {"scene": spec, **asdict(compare(reflective(spec), RESOLUTION, n_rays))}
        rows.append(row | {"largest_difference": f"{row['largest_difference']:.1e}"})
        print(rows[-1], flush=True)
    write_csv(rows, list(rows[0]), Path(__file__).with_suffix(".csv"))


if __name__ == "__main__":
    main()
