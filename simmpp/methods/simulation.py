"""Method ``simulate``: the machine, message by message."""

from __future__ import annotations

import numpy as np

from simmpp.common.files import Row
from simmpp.engine.capacity import Needs, fits, lacking, needs_of
from simmpp.engine.memory_use import COLUMNS, REASON
from simmpp.engine.result import Result
from simmpp.engine.simulate import simulate
from simmpp.engine.tables.residuals import LEFT
from simmpp.methods.case import Case
from simmpp.methods.columns import BOUNDED, BY_USE, FURTHER, NUMBERS
from simmpp.placement.placement import Placement


def simulation(case: Case) -> Row:
    """All cells of a run; of a policy that does not fit, no more than that and what it lacks."""
    placement = case.place()
    if placement.capacity is not None:
        needs = needs_of(case.workload, case.machine, placement, case.policy)
        scene_bytes = int(case.workload.object_bytes.sum())
        if not fits(needs, placement, scene_bytes):
            return unfit_cells(needs, placement, scene_bytes)
    result = simulate(
        case.workload,
        case.machine,
        placement,
        case.policy,
        engine=case.engine,
        ready_order=case.ready_order,
        seed=case.seed,
        progress=case.tick,
    )
    return cells(result)


def unfit_cells(needs: Needs, placement: Placement, scene_bytes: int) -> Row:
    """What is known of a policy that does not fit."""
    lacks = lacking(needs, placement, scene_bytes)
    return {"fits": 0, "exceeds_bytes": lacks, "least_bytes": needs.least_bytes}


def cells(result: Result) -> Row:
    """The integers of a result and, if it came to no end, why not."""
    reason = result.memory.reason if result.memory else ""
    return {**integers(result), **({REASON: reason} if reason else {})}


def integers(result: Result) -> dict[str, int]:
    """The integers of a result, by column; a run that came to no end has no others but memory's."""
    use = result.memory
    of_memory = {} if use is None else {name: getattr(use, name) for name in COLUMNS}
    if use is not None and use.infeasible:
        return of_memory
    others = {*BY_USE[BOUNDED], *LEFT}
    names = [name for name in (*NUMBERS, *FURTHER) if name not in others]
    values = {name: np.atleast_1d(getattr(result, name)) for name in names}
    sums = {name: sum(value.tolist()) for name, value in values.items()}
    return sums | result.residuals_ps | of_memory
