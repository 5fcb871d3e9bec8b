"""Method ``simulate``: the machine, message by message."""

from __future__ import annotations

import numpy as np

from simmpp.engine.result import Result
from simmpp.engine.simulate import simulate
from simmpp.methods.case import Case
from simmpp.methods.columns import FURTHER, NUMBERS


def simulation(case: Case) -> dict[str, int]:
    """All integers of a run."""
    result = simulate(
        case.workload,
        case.machine,
        case.place(),
        case.policy,
        engine=case.engine,
        ready_order=case.ready_order,
        seed=case.seed,
        progress=case.tick,
    )
    return integers(result)


def integers(result: Result) -> dict[str, int]:
    """The integers of a result, by column."""
    values = {column: np.atleast_1d(getattr(result, column)) for column in (*NUMBERS, *FURTHER)}
    return {column: sum(value.tolist()) for column, value in values.items()}
