"""The analytical model over the grid of a configuration: times, rows, the maps of figure 2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.config.config import Config, point_at
from simmpp.model.analytical import Makespans, analytical, grouped, rays_of
from simmpp.model.border import FRACTIONS, OBJECT, PROCESSORS, RAY, TIE, winners
from simmpp.model.costs import Costs, costs_of
from simmpp.model.measured import measured
from simmpp.model.synchronous import DATAFLOWS
from simmpp.placement.place import place
from simmpp.workload.workload import Workload

ANALYTICAL, MEASURED = "analytical", "analytical-measured"
WINNERS = {RAY: "ray", OBJECT: "object", TIE: "tie"}
DEFAULT_RATIOS = (("packing", 100.0), ("object", 100.0), ("test", 10.0))
"""Maps beside the machine's own: a group of operations, and how many times as long it takes."""
FIGURE_IMBALANCE = 0.5
FINE_PROCESSORS, FINE_FRACTIONS, FINE_STEPS = 33, 81, 32
"""Resolution of the maps."""
DRAWS = 4
"""Draws of zeta that times with imbalance are means over."""


class Grid(NamedTuple):
    """The points of a model."""

    processors: tuple[int, ...]
    fractions: tuple[Fraction, ...]
    left_out: tuple[str, ...]
    """Keys that the sweep changes and that the model would see, but has no axis for."""


class WinnerMap(NamedTuple):
    """One map of figure 2."""

    title: str
    fine: Makespans
    """Drawn."""
    grid: Makespans
    """The points of the configuration, drawn as dots."""


def model_grid(config: Config) -> Grid:
    """The nb and x of the sweep; where it has none, those of the paper's claims.

    Raises ConfigError for memories in bytes: the model knows shares.
    """
    processors: set[int] = set()
    fractions: set[Fraction] = set()
    left_out: dict[str, None] = {}
    for name, axis in config.axes.items():
        for number, choice in enumerate(axis):
            point = point_at(config, {name: axis}, {name: number})
            if "processors" in choice.assignments:
                processors.add(point.processors)
            if "memory.bytes" in choice.assignments or point.memory.fills:
                raise ConfigError("sweep: memory: expected shares, memory.fraction, for the model")
            if "memory.fraction" in choice.assignments:
                fractions.add(point.memory.share)
            left_out |= dict.fromkeys(key for key in choice.assignments if _matters(key))
    return Grid(
        tuple(sorted(processors or PROCESSORS)),
        tuple(sorted(fractions or FRACTIONS)),
        tuple(left_out),
    )


def _matters(key: str) -> bool:
    """The model has no policies, and takes the method as it is."""
    return key not in ("processors", "memory.fraction") and key.split(".")[0] != "policy"


def model_times(
    config: Config, workload: Workload, grid: Grid, *, imbalance: float = 0.0
) -> Makespans:
    """TC and TO at every point, by the configuration's method, ``analytical`` if it simulates."""
    if config.settings.method == MEASURED:
        return _measured(config, workload, grid)
    machine = config.machine_for(config.processors)
    return analytical(
        costs_of(machine, workload),
        grid.processors,
        [float(x) for x in grid.fractions],
        rays_of(workload),
        imbalance=imbalance,
        seed=config.settings.seeds[0],
        draws=DRAWS,
    )


def _measured(config: Config, workload: Workload, grid: Grid) -> Makespans:
    times = np.empty((len(DATAFLOWS), len(grid.processors), len(grid.fractions)))
    for row, nb in enumerate(grid.processors):
        machine = config.machine_for(nb)
        for column, x in enumerate(grid.fractions):
            memory = replace(config.memory, fraction=x, bytes=None)
            seed = config.settings.seeds[0]
            placement = place(workload, nb, memory, config.settings.placement, seed)
            for which, dataflow in enumerate(DATAFLOWS):
                times[which, row, column] = measured(
                    workload, machine, placement, dataflow
                ).makespan_ps
    fractions = np.array([float(x) for x in grid.fractions])
    return Makespans(np.array(grid.processors), fractions, times[0], times[1])


def rows_of(times: Makespans, scene: str, method: str, imbalance: float) -> list[Row]:
    """One row per point; times to the nearest picosecond."""
    won = winners(times)
    return [
        {
            "scene": scene,
            "processors": int(nb),
            "fraction": float(x),
            "method": method,
            "imbalance": imbalance,
            "object_ps": round(times.object[i, j]),
            "ray_ps": round(times.ray[i, j]),
            "ray_over_object": float(times.ratio[i, j]),
            "winner": WINNERS[int(won[i, j])],
        }
        for i, nb in enumerate(times.processors)
        for j, x in enumerate(times.fractions)
    ]


def winner_maps(
    config: Config, workload: Workload, ratios: Sequence[tuple[str, float]]
) -> list[WinnerMap]:
    """Maps for the costs themselves and each ratio, without and with imbalance."""
    costs = costs_of(config.machine_for(config.processors), workload)
    variants = [("this machine", costs)]
    variants += [(f"{name} x {factor:g}", costs.scaled(name, factor)) for name, factor in ratios]
    rays, seed = grouped(rays_of(workload), FINE_STEPS), config.settings.seeds[0]
    grid = model_grid(config)
    own = [float(x) for x in grid.fractions]
    fine, shares = _fine(grid.processors), np.linspace(0.0, 1.0, FINE_FRACTIONS).tolist()

    def times(costs: Costs, nbs: Sequence[int], xs: Sequence[float], zeta: float) -> Makespans:
        return analytical(costs, nbs, xs, rays, imbalance=zeta, seed=seed, draws=DRAWS)

    return [
        WinnerMap(
            f"{title}, imbalance {imbalance:g}",
            times(scaled, fine, shares, imbalance),
            times(scaled, grid.processors, own, imbalance),
        )
        for imbalance in (0.0, FIGURE_IMBALANCE)
        for title, scaled in variants
    ]


def _fine(processors: Sequence[int]) -> list[int]:
    """Numbers of PEs that a map is drawn at, from the least to the most of the grid or around."""
    lowest, highest = max(min(processors), 2), max(processors)
    if highest <= lowest:
        lowest, highest = max(lowest // 2, 2), 2 * lowest
    fine = np.unique(np.geomspace(lowest, highest, FINE_PROCESSORS).round().astype(np.int64))
    return [int(nb) for nb in fine]
