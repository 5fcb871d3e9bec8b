"""What does not fit together is refused before compiled code sees it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import Case, random_case

from simmpp.common.errors import InputError
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import CopyCost, TestCost


def a_case() -> Case:
    return next(
        case
        for case in map(random_case, range(1000))
        if case.workload.n_tests > 20 and case.machine.processors > 2
    )


def run(case: Case) -> None:
    simulate(case.workload, case.machine, case.placement, case.policy)


def broken(case: Case, part: str, **changes: Any) -> Case:
    return replace(case, **{part: replace(getattr(case, part), **changes)})


def test_the_case_itself_runs() -> None:
    run(a_case())


@pytest.mark.parametrize(
    ("part", "name", "change"),
    [
        ("workload", "child_offsets", lambda a: a[:-1]),
        ("workload", "child_offsets", lambda a: a + 1),
        ("workload", "itinerary_offsets", lambda a: a[::-1].copy()),
        ("workload", "itinerary_offsets", lambda a: np.where(a == a[-1], a + 5, a)),
        ("workload", "itinerary_objects", lambda a: a + 1000),
        ("workload", "itinerary_objects", lambda a: a - 1000),
        ("workload", "object_bytes", lambda a: a[1:]),
        ("placement", "owners", lambda a: a[1:]),
        ("placement", "owners", lambda a: a + 100),
        ("placement", "owners", lambda a: a - 100),
        ("placement", "replica_offsets", lambda a: a + 1),
        ("placement", "replica_objects", lambda a: np.append(a, 0).astype(np.int32)),
        ("placement", "pixel_pes", lambda a: a[1:]),
        ("placement", "pixel_pes", lambda a: a + 100),
        ("placement", "transient", lambda n: -1),
        ("placement", "processors", lambda n: n + 1),
        ("machine", "quantum", lambda n: 0),
        ("machine", "ray_ps", lambda n: -1),
        ("machine", "contention", lambda word: "link"),
        ("machine", "test", lambda cost: TestCost(1, 1, -1, 1)),
        ("machine", "unpack", lambda costs: (*costs[:3], CopyCost(0, -1))),
        ("policy", "batch", lambda n: 0),
        ("policy", "ask_at_least", lambda n: 0),
        ("policy", "min_load", lambda n: -1),
        ("policy", "refresh_ps", lambda n: -1),
        ("policy", "name", lambda name: "best"),
    ],
)
def test_what_does_not_fit_is_refused(part: str, name: str, change: Any) -> None:
    case = a_case()
    with pytest.raises(InputError) as refused:
        run(broken(case, part, **{name: change(getattr(getattr(case, part), name))}))
    assert "\n" not in str(refused.value)
