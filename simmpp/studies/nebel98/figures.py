"""The figures of Nebel 1998 in the paper's form, from rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from simmpp.plot.curves import ON_EACH_PE, PERCENT, Curve, Panel, Scale, Spread, Stated
from simmpp.studies.nebel98.claims_concurrent import (
    ACCELERATION,
    FEW,
    HALF,
    MANY,
    MESSAGES_BELOW,
    MOUNTAIN5,
    TIME_ABOVE,
    TIME_BELOW,
)
from simmpp.sweeps.ratios import (
    CONCURRENT,
    MAKESPAN,
    MESSAGES,
    RAY,
    REPLICATED,
    CurvePoint,
    Ratios,
    RowIndex,
    mean,
)

NAMES = {
    "mountain:5": "Mountain5",
    "rings:1": "Ring1",
    "rings:7": "Rings7",
    "tetra:5": "Tetrahedron5",
    "tetra:6": "Tetrahedron6",
}
"""The paper's names of scenes."""
ACCELERATIONS = (1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32)
"""Divisions of figure 6's axis."""
FRACTIONS_OF_6 = (1 / 64, 0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
"""Curves of figure 6, of all that are simulated and judged."""


def figure3(measured: RowIndex) -> list[Panel]:
    """The reciprocal of ray dataflow's time profit on Tetrahedron5."""
    (scene,) = measured.scenes

    def ratios_of(point: CurvePoint) -> Ratios:
        return measured.ray_over_object(point.scene, point.processors, point.fraction)

    curves = [
        curve(f"{nb} PEs", measured, _over_x(measured, scene, nb, RAY), ratios_of)
        for nb in measured.processors
    ]
    title = f"Figure 3: ray over object dataflow, {_name(scene)}"
    ratio = Scale("T(ray dataflow) / T(object dataflow)")
    return [Panel(title, ON_EACH_PE, ratio, curves, level=1, note=_note(measured))]


def figure4(measured: RowIndex) -> list[Panel]:
    """The time profit of concurrent dataflow."""
    stated = [
        Stated(0, HALF * PERCENT, *TIME_BELOW, "the paper's range"),
        Stated(HALF * PERCENT, PERCENT, *TIME_ABOVE, ""),
    ]
    return [_profits("Figure 4: time profit", measured, MAKESPAN, stated)]


def figure5(measured: RowIndex) -> list[Panel]:
    """The message profit of concurrent dataflow, from the rows of figure 4."""
    stated = [Stated(0, HALF * PERCENT, *MESSAGES_BELOW, "the paper's range")]
    return [_profits("Figure 5: message profit", measured, MESSAGES, stated)]


def figure6(measured: RowIndex) -> list[Panel]:
    """The acceleration of concurrent dataflow over the fewest PEs, which are 32."""
    numbers = measured.processors
    few = numbers[0]

    def ratios_of(point: CurvePoint) -> Ratios:
        return measured.acceleration(point.scene, point.fraction, few, point.processors)

    curves = []
    for x in measured.fractions:
        if x in FRACTIONS_OF_6:
            points: dict[float, CurvePoint] = {
                nb: CurvePoint(MOUNTAIN5, nb, x, CONCURRENT) for nb in numbers
            }
            curves.append(curve(f"{x * PERCENT:.3g} %", measured, points, ratios_of))
    curves.append(Curve("linear", {nb: Spread(*[nb / few] * 3) for nb in numbers}, is_guide=True))
    continued = f" continued to {numbers[-1]} PEs" if numbers[-1] > MANY else ""
    title = f"Figure 6{continued}: {_name(MOUNTAIN5)}, concurrent dataflow"
    stated = Stated(MANY / 1.1, MANY * 1.1, ACCELERATION, MANY / FEW, "the paper's: over 2.2")
    nb = Scale("processing elements (PEs)", is_log=True, ticks=tuple(numbers))
    gained = Scale(f"acceleration T({few} PEs) / T(PEs)", is_log=True, ticks=ACCELERATIONS)
    note, legend = _note(measured), "of the scene on each PE"
    return [Panel(title, nb, gained, curves, [stated], note=note, legend=legend)]


def rings7(measured: RowIndex) -> list[Panel]:
    """The time profit of every policy on the large scene, and concurrent dataflow's messages."""
    (scene,), (nb,) = measured.scenes, measured.processors
    labels = {RAY: "ray dataflow", CONCURRENT: "concurrent dataflow", REPLICATED: "replicated"}
    styles = {policy: style for style, policy in enumerate(labels, 1)}

    def panel(y: Scale, column: str, policies: Iterable[str]) -> Panel:
        curves = [
            replace(_profit(labels[p], measured, column, scene, nb, p), style=styles[p])
            for p in policies
        ]
        title = f"{_name(scene)}, {nb} PEs: {y.label}"
        return Panel(title, ON_EACH_PE, y, curves, level=1, note=_note(measured))

    return [
        panel(Scale("time profit", is_log=True), MAKESPAN, labels),
        panel(Scale("message profit"), MESSAGES, [CONCURRENT]),
    ]


FIGURES: dict[str, tuple[str, Callable[[RowIndex], list[Panel]]]] = {
    "figure3": ("figure3", figure3),
    "figure4": ("figure4", figure4),
    "figure5": ("figure4", figure5),
    "figure6": ("figure6", figure6),
    "figure6-1024": ("figure6-1024", figure6),
    "rings7": ("rings7", rings7),
}
"""Each figure: the configuration whose rows it shows, and what it is made of."""


def _profits(what: str, measured: RowIndex, column: str, stated: list[Stated]) -> Panel:
    """Profits of concurrent dataflow, one curve a scene."""
    (nb,) = measured.processors
    curves = [
        _profit(_name(scene), measured, column, scene, nb, CONCURRENT) for scene in measured.scenes
    ]
    title = f"{what} of concurrent over object dataflow, {nb} PEs"
    axis = Scale(what.partition(": ")[2])
    return Panel(title, ON_EACH_PE, axis, curves, stated, level=1, note=_note(measured))


def _note(measured: RowIndex) -> str:
    return f"means of {measured.seeds} seeds, and their range" if measured.seeds > 1 else "one seed"


def _over_x(measured: RowIndex, scene: str, nb: int, policy: str) -> dict[float, CurvePoint]:
    """The points of a curve over x, by x in per cent."""
    return {x * PERCENT: CurvePoint(scene, nb, x, policy) for x in measured.fractions}


def _profit(label: str, measured: RowIndex, column: str, scene: str, nb: int, policy: str) -> Curve:
    points = _over_x(measured, scene, nb, policy)
    return curve(label, measured, points, lambda point: measured.profit(column, *point))


def curve(
    label: str,
    measured: RowIndex,
    points: Mapping[float, CurvePoint],
    ratios_of: Callable[[CurvePoint], Ratios],
) -> Curve:
    """The curve of what was measured, by abscissa; points without a result are left out."""
    measured_at = {at: ratios for at, point in points.items() if (ratios := ratios_of(point))}
    return Curve(
        label,
        {at: Spread(mean(ratios), min(ratios), max(ratios)) for at, ratios in measured_at.items()},
        rows={at: n for at in measured_at if (n := measured.numbers.get(points[at])) is not None},
    )


def _name(scene: str) -> str:
    return NAMES.get(scene, scene)
