"""The figures of Nebel 1998 in the paper's form, from rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from simmpp.plot.curves import ON_EACH_PE, PERCENT, Curve, Panel, Scale, Spread, Stated, curve
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
    curves = [
        _over_x(
            f"{nb} PEs", measured, partial(measured.ray_over_object, scene, nb), (scene, nb, RAY)
        )
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
    curves = [
        curve(
            f"{x * PERCENT:.3g} %",
            numbers,
            partial(_acceleration, measured, x, few),
            partial(_number_of_6, measured, x),
        )
        for x in measured.fractions
        if x in FRACTIONS_OF_6
    ]
    linear = Curve("linear", {nb: Spread(*[nb / few] * 3) for nb in numbers}, is_guide=True)
    continued = f" continued to {numbers[-1]} PEs" if numbers[-1] > MANY else ""
    title = f"Figure 6{continued}: {_name(MOUNTAIN5)}, concurrent dataflow"
    stated = Stated(MANY / 1.1, MANY * 1.1, ACCELERATION, MANY / FEW, "the paper's: over 2.2")
    nb = Scale("processing elements (PEs)", is_log=True, ticks=tuple(numbers))
    gained = Scale(f"acceleration T({few} PEs) / T(PEs)", is_log=True, ticks=ACCELERATIONS)
    return [
        Panel(
            title,
            nb,
            gained,
            [*curves, linear],
            [stated],
            note=_note(measured),
            legend="of the scene on each PE",
        )
    ]


def rings7(measured: RowIndex) -> list[Panel]:
    """The time profit of every policy on the large scene, and concurrent dataflow's messages."""
    (scene,), (nb,) = measured.scenes, measured.processors
    labels = {RAY: "ray dataflow", CONCURRENT: "concurrent dataflow", REPLICATED: "replicated"}
    times = [
        replace(_profit_over_x(label, measured, MAKESPAN, (scene, nb, policy)), style=number)
        for number, (policy, label) in enumerate(labels.items(), 1)
    ]
    messages = _profit_over_x(labels[CONCURRENT], measured, MESSAGES, (scene, nb, CONCURRENT))
    messages = replace(messages, style=times[1].style)
    title = f"{_name(scene)}, {nb} PEs: "
    return [
        Panel(
            title + "time profit",
            ON_EACH_PE,
            Scale("time profit", is_log=True),
            times,
            level=1,
            note=_note(measured),
        ),
        Panel(
            title + "message profit",
            ON_EACH_PE,
            Scale("message profit"),
            [messages],
            level=1,
            note=_note(measured),
        ),
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
        _profit_over_x(_name(scene), measured, column, (scene, nb, CONCURRENT))
        for scene in measured.scenes
    ]
    title = f"{what} of concurrent over object dataflow, {nb} PEs"
    axis = Scale(what.partition(": ")[2])
    return Panel(title, ON_EACH_PE, axis, curves, stated, level=1, note=_note(measured))


def _note(measured: RowIndex) -> str:
    return f"means of {measured.seeds} seeds, and their range" if measured.seeds > 1 else "one seed"


Of = tuple[str, int, str]
"""Scene, number of PEs and policy of a curve over x."""


def _over_x(label: str, measured: RowIndex, ratios_at: Callable[[float], Ratios], of: Of) -> Curve:
    scene, nb, policy = of

    def number_at(x: float) -> int | None:
        return measured.numbers.get(CurvePoint(scene, nb, x, policy))

    return curve(label, measured.fractions, ratios_at, number_at, unit=PERCENT)


def _profit_over_x(label: str, measured: RowIndex, column: str, of: Of) -> Curve:
    scene, nb, policy = of
    return _over_x(label, measured, lambda x: measured.profit(column, scene, nb, x, policy), of)


def _number_of_6(measured: RowIndex, x: float, nb: float) -> int | None:
    return measured.numbers.get(CurvePoint(MOUNTAIN5, int(nb), x, CONCURRENT))


def _acceleration(measured: RowIndex, x: float, few: int, nb: float) -> Ratios:
    return measured.acceleration(MOUNTAIN5, x, few, int(nb))


def _name(scene: str) -> str:
    return NAMES.get(scene, scene)
