"""Run time against error, from the rows of a bench."""

from __future__ import annotations

from collections.abc import Sequence

from simmpp.common.files import Row
from simmpp.report.page.figure import Figure
from simmpp.studies.bench.errors import rungs
from simmpp.studies.bench.figure import bench_panels
from simmpp.studies.nebel98.figures import NAMES

STEM = "run-time-against-error"


def accuracy_figures(bench: Sequence[Row]) -> list[Figure]:
    """One figure, or none without rows."""
    if not bench:
        return []
    columns = list(bench[0])
    keys = columns[: columns.index("policy")]
    reference = max(row["reference_seeds"] + row["seeds"] for row in bench)
    panels = bench_panels(rungs(bench, keys), NAMES, reference)
    return [Figure(STEM, "Run time against error", panels[0].note, {"": panels})]
