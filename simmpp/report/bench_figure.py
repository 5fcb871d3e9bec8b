"""Run time against error: a panel for each profit, a curve for each scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from simmpp.report.curves import Curve, Panel, Scale, Spread, Stated
from simmpp.report.rungs import Rung
from simmpp.sweeps.methods import SIMULATE
from simmpp.sweeps.profits import MEASURES

SECONDS = Scale("processor seconds per point, tracing apart", is_log=True)
ERROR = Scale("relative error", is_log=True)
ROOM = 2
"""Factor of space around what is drawn."""
SHORT = {"analytical": "model", "analytical-measured": "model,\nmeasured r"}
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
    note = "root mean square over points and policies; numbers: seeds simulated"
    title = f"Error of the {measure.replace('_', ' ')}"
    return Panel(title, SECONDS, ERROR, curves, _band(drawn, measure, reference), note=note)


def _curve(rungs: Sequence[Rung], label: str, method: str, measure: str) -> Curve:
    of_method = [rung for rung in rungs if rung.method == method]
    points = {rung.seconds: Spread(*[rung.error[measure]] * 3) for rung in of_method}
    said = {
        rung.seconds: f"{rung.seeds}" if method == SIMULATE else SHORT.get(method, method)
        for rung in of_method
    }
    return Curve(label, points, said=said)


def _band(rungs: Sequence[Rung], measure: str, reference: int) -> list[Stated]:
    """Where the reference itself is not known: of the scene that is known least."""
    if not rungs:
        return []
    high = max(rung.resolution[measure] for rung in rungs)
    low = min(high, *(rung.error[measure] for rung in rungs)) / ROOM
    left, right = min(r.seconds for r in rungs) / ROOM, max(r.seconds for r in rungs) * ROOM
    label = f"95 % interval of the mean\nof {reference} seeds (reference)"
    return [Stated(left, right, low, high, label)]
