"""Method ``simulate``: the machine, message by message."""

from __future__ import annotations

import numpy as np

from simmpp.engine.capacity import fits, lacking, needs_of
from simmpp.engine.result import Result
from simmpp.engine.simulate import simulate
from simmpp.methods.case import Case
from simmpp.methods.columns import BOUNDED, BY_USE, FURTHER, NUMBERS


def simulation(case: Case) -> dict[str, int]:
    """All integers of a run; of a policy that does not fit, no more than that and what it lacks."""
    placement = case.place()
    if placement.capacity is not None:
        needs = needs_of(case.workload, case.machine, placement, case.policy)
        scene_bytes = int(case.workload.object_bytes.sum())
        if not fits(needs, placement, scene_bytes):
            return {"fits": 0, "exceeds_bytes": lacking(needs, placement, scene_bytes)}
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
    return integers(result)


def integers(result: Result) -> dict[str, int]:
    """The integers of a result, by column; a run that came to no end has no others but memory's."""
    use = result.memory
    of_memory = {} if use is None else {name: getattr(use, name) for name in BY_USE[BOUNDED]}
    if use is not None and use.infeasible:
        return of_memory
    names = [name for name in (*NUMBERS, *FURTHER) if name not in BY_USE[BOUNDED]]
    values = {name: np.atleast_1d(getattr(result, name)) for name in names}
    return {name: sum(value.tolist()) for name, value in values.items()} | of_memory
