"""Run time against error, from the rows of a bench."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from simmpp.common.files import Row
from simmpp.report.page.figures.figure import Figure
from simmpp.studies.bench.errors import rungs
from simmpp.studies.bench.figure import bench_panels

STEM = "run-time-against-error"


def accuracy_figures(bench: Sequence[Row], names: Mapping[str, str]) -> list[Figure]:
    """One figure, or none without rows; ``names`` are what readers call the scenes."""
    if not bench:
        return []
    columns = list(bench[0])
    keys = columns[: columns.index("policy")]
    reference = max(row["reference_seeds"] + row["seeds"] for row in bench)
    panels = bench_panels(rungs(bench, keys), names, reference)
    return [Figure(STEM, "Run time against error", panels[0].note, {"": panels})]
