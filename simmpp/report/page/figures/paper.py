"""The paper's own figures, where the rows are those of its experiments, its statements behind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from simmpp.common.files import Row
from simmpp.policy.parameters import REFERENCE
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.folder import Folder
from simmpp.studies.nebel98.figures import FIGURES, NAMES
from simmpp.studies.nebel98.reproduce import EXPERIMENTS, load_experiment
from simmpp.sweeps.ratios import CONCURRENT, RAY, CurvePoint, RowIndex
from simmpp.sweeps.winners.points import Points

NEEDED = {"figure3": {REFERENCE, RAY}}
"""Policies that a figure compares, where it is not object and concurrent dataflow."""
STEMS = tuple(FIGURES)
SCENE_NAMES = NAMES
LEAST_FRACTIONS = 3
"""Fractions x that make a curve."""


def paper_figures(folder: Folder, points: Points) -> list[Figure]:
    """Figures of all experiments in the folder, or of the one that its rows repeat."""
    numbers = {
        CurvePoint(row["scene"], row["processors"], row["fraction"], row["policy"]): number
        for number, row in enumerate(points.profits)
    }
    experiments = folder.experiments or _repeated(folder)
    return [
        _figure(figure, RowIndex(experiments[name], numbers))
        for figure, (name, _) in FIGURES.items()
        if name in experiments
    ]


def _figure(name: str, measured: RowIndex) -> Figure:
    panels = FIGURES[name][1](measured)
    title = panels[0].title if len(panels) == 1 else panels[0].title.partition(":")[0]
    note = "; ".join(filter(None, (panels[0].note, "shaded: what the paper states")))
    return Figure(name, title, note if panels[0].stated else panels[0].note, {"": panels})


def _repeated(folder: Folder) -> Mapping[str, Sequence[Row]]:
    """The rows under the name of the first experiment with the same scenes and numbers of PEs."""
    if folder.further or not folder.rows:
        return {}
    name = next((name for name in EXPERIMENTS if _repeats(name, folder.rows)), None)
    return {name: folder.rows} if name else {}


def _repeats(name: str, rows: Sequence[Row]) -> bool:
    scenes, processors = _of(name)
    policies = {row["policy"] for row in rows}
    return (
        {row["scene"] for row in rows} == scenes
        and {row["processors"] for row in rows} == processors
        and NEEDED.get(name, {REFERENCE, CONCURRENT}) <= policies
        and len({row["fraction"] for row in rows}) >= LEAST_FRACTIONS
    )


def _of(name: str) -> tuple[set[str], set[int]]:
    """Scenes and numbers of PEs of an experiment."""
    config = load_experiment(name)
    spec, sweep = config.scene_spec, config.settings.sweep
    scenes = sweep.get("scene", [f"{spec['spd']}:{spec['size']}"])
    processors = sweep.get("processors", [config.processors])
    return {str(scene) for scene in scenes}, {int(str(nb)) for nb in processors}
