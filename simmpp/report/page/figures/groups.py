"""The figures of a report, group by group: a further figure is a file and a line here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from simmpp.report.page.figures import (
    accuracy,
    bar_figures,
    capacity_figures,
    folder_figures,
    machine_figures,
    paper,
    profit_figures,
)
from simmpp.report.page.figures.figure import Figure
from simmpp.report.page.figures.profit_figures import ProfitData
from simmpp.report.page.folder import Folder
from simmpp.report.page.limits import PointLimits
from simmpp.sweeps.winners.machines import machines_of

OVER = "A line is a folder, a panel a dataflow. Click a point to see it in depth."
CLICKING = "Click a point to see it in depth; click a name to hide its curve."
MACHINES_ID = "machines"
MACHINES = (
    "The same work on each machine, by the dataflow that is the fastest there. Node-seconds are "
    "PEs x makespan: they cost alike only if nodes do. Energy and price are those of machines that "
    "state a PE's power and the price of its hour (simmpp machine NAME), for the time of the run "
    "alone. Click a point to see it in depth."
)
CAPACITY_ID = "capacity"
CAPACITY = (
    "A policy fits if a PE has room for its objects, one request of each other PE, the largest "
    "object that it may have to fetch, the rays of one pixel and, if it sends rays, one of each "
    "other PE. What a capacity lacks is told of one PE. Click a point or a bar to see it in depth."
)
LIMITS_ID = "accounts"
LIMITS = (
    "The makespan in parts that add up to it. Startups: what messages cost their two PEs whatever "
    "their size. Copying: packing and unpacking by the byte, and probes. One hot PE: how much "
    "longer the busiest PE works than the next. Imbalance: how much longer that one works than the "
    "mean. Latency and bandwidth: when even the busiest PE waits, divided as flights of messages "
    "are. Rows of sweeps know these four as waiting; simmpp run --out tells them apart. Parts are "
    "means over PEs: they say where the time is, not how much shorter it would be without one."
)


@dataclass(frozen=True)
class FigureGroup:
    """Figures under one heading of the page, and what makes them."""

    id: str
    name: str
    text: str
    stems: tuple[str, ...]
    """Beginnings of the stems of its figures' files: these are no pictures that others left."""
    figures: Callable[[Folder, PointLimits], Iterable[Figure]]
    of_points: bool = True
    """Not asked for figures where no point has rows."""


FIGURE_GROUPS = (
    FigureGroup(
        *("paper", "The paper's figures", CLICKING, paper.STEMS),
        lambda folder, limits: paper.paper_figures(folder, limits.points),
    ),
    FigureGroup(
        *(CAPACITY_ID, "What fits into memory", CAPACITY, capacity_figures.STEMS),
        lambda _, limits: capacity_figures.capacity_figures(limits.points),
    ),
    FigureGroup(
        *(MACHINES_ID, "Machines", MACHINES, machine_figures.STEMS),
        lambda folder, limits: machine_figures.machine_figures(
            machines_of(limits.points, folder.record)
        ),
    ),
    FigureGroup(
        *("folders", "Folders over each other", OVER, folder_figures.STEMS),
        lambda _, limits: folder_figures.folder_figures(limits.points),
    ),
    FigureGroup(
        *("curves", "Curves", CLICKING, profit_figures.STEMS),
        lambda _, limits: profit_figures.profit_figures(ProfitData(limits.points)),
    ),
    FigureGroup(
        *(LIMITS_ID, "What limits it", LIMITS, bar_figures.STEMS),
        lambda _, limits: bar_figures.bar_figures(limits),
    ),
    FigureGroup(
        *("accuracy", "Run time against error", "", (accuracy.STEM,)),
        lambda folder, _: accuracy.accuracy_figures(folder.bench, paper.SCENE_NAMES),
        of_points=False,
    ),
)
