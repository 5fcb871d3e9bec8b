"""The methods that give a point its row: the simulation, and what is quicker and less exact.

A further method is one function in a file of its own and a line in METHODS: ``method:`` then takes
its name, sweeps have its rows, and ``simmpp bench`` measures its run time and its error.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from simmpp.methods.analytical import analytical, analytical_measured
from simmpp.methods.case import Case
from simmpp.methods.simulation import simulation
from simmpp.model.synchronous import DATAFLOWS


@dataclass(frozen=True)
class Method:
    """A way from a case to the cells of its row."""

    numbers: Callable[[Case], Mapping[str, int | str]]
    """Columns of ``results.csv``; those that it does not know are left out."""
    policies: tuple[str, ...] | None = None
    """Names of those that it knows; None for all."""
    is_placed: bool = True
    """It reads the placement, and so the seed may have a part in what it says."""
    uses_engine: bool = True
    """It runs an event loop."""
    knows_papers_machine_alone: bool = False
    """It has no meaning for machines whose PEs are joined, or requests served, otherwise, or which
    compute unevenly, nor for islands."""
    most_seeds: int | None = 1
    """Seeds at most that ``simmpp bench`` tries it with; None for as many as it simulates."""


METHODS: dict[str, Method] = {
    "simulate": Method(simulation, most_seeds=None),
    "analytical": Method(
        analytical, DATAFLOWS, is_placed=False, uses_engine=False, knows_papers_machine_alone=True
    ),
    "analytical-measured": Method(
        analytical_measured, DATAFLOWS, uses_engine=False, knows_papers_machine_alone=True
    ),
}
SIMULATE = "simulate"
"""Full fidelity: what the others' errors are measured against."""
