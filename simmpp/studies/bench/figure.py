"""Run time against error: a panel for each profit, a curve for each scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from simmpp.methods.table import SIMULATE
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.studies.bench.errors import Rung
from simmpp.sweeps.profits import MEASURES

SECONDS = Scale("processor seconds per point, tracing apart", is_log=True)
ERROR = Scale("relative error, root mean square", is_log=True)
METHOD_MARKS = {"analytical": "A", "analytical-measured": "A-m"}
"""Of names of methods, beside their points."""


def bench_panels(rungs: Sequence[Rung], names: Mapping[str, str], reference: int) -> list[Panel]:
    """A panel for each profit; ``names`` are what readers call the scenes, ``reference`` the number
    of seeds that is simulated at full fidelity."""
    return [_panel(rungs, names, measure, reference) for measure in MEASURES]


def _panel(rungs: Sequence[Rung], names: Mapping[str, str], measure: str, reference: int) -> Panel:
    drawn = [rung for rung in rungs if rung.error[measure] > 0 and rung.error[measure] < math.inf]
    curves = []
    for scene in dict.fromkeys(rung.scene for rung in drawn):
        of_scene = [rung for rung in drawn if rung.scene == scene]
        methods = dict.fromkeys(rung.method for rung in of_scene)
        label = names.get(scene, scene)
        curves += [_curve(of_scene, label, method, measure) for method in methods]
    note = (
        "numbers: seeds simulated; A: analytical, A-m: with measured r (object and ray dataflow)\n"
        f"bands: below the standard error of the reference, the mean of {reference} seeds"
    )
    return Panel(f"Error of the {measure.replace('_', ' ')}", SECONDS, ERROR, curves, note=note)


def _curve(rungs: Sequence[Rung], label: str, method: str, measure: str) -> Curve:
    of_method = [rung for rung in rungs if rung.method == method]
    points = {rung.seconds: Spread(*[rung.error[measure]] * 3) for rung in of_method}
    if method != SIMULATE:
        mark = METHOD_MARKS.get(method, method)
        return Curve(label, points, notes=dict.fromkeys(points, mark))
    notes = {rung.seconds: f"{rung.seeds}" for rung in of_method}
    return Curve(label, points, notes=notes, floor=of_method[0].resolution[measure])
