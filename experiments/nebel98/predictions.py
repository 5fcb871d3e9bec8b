"""What was predicted of points that no one had simulated before, beside what came out.

    python experiments/nebel98/predictions.py [FOLDER]

Simulates the cases of ``predictions`` in expected.yaml (8 seeds; finished simulations are kept in
FOLDER, out/predictions) and writes predictions.csv: expected, range, found, hit or miss.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from statistics import fmean
from typing import Any

from simmpp.common.files import Row, write_csv
from simmpp.common.yamlfile import read_yaml
from simmpp.sweeps.sweep import SweepResult, run_sweep

HERE = Path(__file__).parent
BASE_PROCESSORS = 32
"""What an acceleration is measured from."""
EQUAL_MEMORY = "mixed-equal-memory"
"""The reading mixed with half of each fraction resident and as many kept."""
READINGS = {
    "mixed": "mixed",
    EQUAL_MEMORY: "mixed",
    "S1": str(HERE / "readings" / "S1.yaml"),
    "mixed-without-packing": str(HERE / "readings" / "mixed-without-packing.yaml"),
}
"""The reading that the cases of each name are simulated with."""
COLUMNS = (
    *("quantity", "reading", "scene", "processors", "fraction"),
    *("expected", "low", "high", "found", "hit"),
)


def cases() -> list[dict[str, Any]]:
    """All cases, in the file's order."""
    expected: Any = read_yaml(HERE / "expected.yaml").data
    return [case for group in expected["predictions"] for case in group["cases"]]


def resident(case: dict[str, Any]) -> Fraction:
    """The share of objects that is resident."""
    fraction = Fraction(str(case["fraction"]))
    return fraction / 2 if case["reading"] == EQUAL_MEMORY else fraction


def simulated(reading: str, of_reading: Iterable[dict[str, Any]], folder: Path) -> SweepResult:
    """One point for each case, and those that accelerations are measured from."""
    points: dict[str, dict[str, object]] = {}
    for case in of_reading:
        accelerates = case["quantity"] == "acceleration_from_32"
        for processors in (case["processors"], *([BASE_PROCESSORS] if accelerates else ())):
            name = point_name(case, processors)
            points[name] = {
                "name": name,
                "scene": case["scene"],
                "processors": processors,
                "memory.fraction": str(resident(case)),
            }
    settings = {
        "scene": "mountain:5",
        "reading": READINGS[reading],
        "picture": {"resolution": 512},
        "policy": ["object", "concurrent"],
        "seeds": list(range(8)),
        "sweep": {"points": list(points.values())},
    }
    return run_sweep(settings, workers=2, out=folder)


def point_name(case: dict[str, Any], processors: int) -> str:
    """What a point is called in rows."""
    return f"{case['scene']} on {processors} PEs, x = {resident(case)}"


def found(case: dict[str, Any], result: SweepResult) -> float:
    """The mean over seeds of what a case is about."""
    here = point_name(case, case["processors"])
    if case["quantity"] != "acceleration_from_32":
        profits = result.profits
        row = profits[(profits["point"] == here) & (profits["policy"] == "concurrent")]
        return float(row[case["quantity"]].iloc[0])
    rows = result.rows[result.rows["policy"] == "concurrent"].set_index(["point", "seed"])
    before, after = (
        rows.loc[name]["makespan_ps"] for name in (point_name(case, BASE_PROCESSORS), here)
    )
    return fmean(before[seed] / after[seed] for seed in sorted(after.index))


def main(folder: Path) -> None:
    """Simulate, compare, write."""
    rows: list[Row] = []
    for reading in READINGS:
        of_reading = [case for case in cases() if case["reading"] == reading]
        result = simulated(reading, of_reading, folder / reading)
        for case in of_reading:
            value = found(case, result)
            hit = "hit" if case["low"] <= value <= case["high"] else "miss"
            rows.append({**case, "found": round(value, 3), "hit": hit})
    write_csv(rows, COLUMNS, HERE / "predictions.csv")
    hits = sum(row["hit"] == "hit" for row in rows)
    print(f"{hits} of {len(rows)} within the range")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/predictions"))
