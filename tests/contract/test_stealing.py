"""Stealing of pixels: every integer is the oracle's, whatever else the PEs do, and nobody is asked
too often.

SIMMPP_TEST_CASES says how many random machines (30 if unset), SIMMPP_TEST_FIRST_SEED where they
begin.
"""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from builders import Case, everywhere, stealing_case, with_capacity
from implementations import result_of, run

from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.simulate import ENGINES
from simmpp.machine.messages import RAYS, STEAL
from simmpp.policy.parameters import CEILING, PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.policy.view import View

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "30"))
FIRST = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
RECEIVE, SEND = EVENT_KINDS.index("receive"), EVENT_KINDS.index("send")


def at_once(v: View) -> int:
    return 1


def to_the_next_one(v: View) -> int:
    v.other = (v.me + 1) % v.nb
    return v.now_ps + 10**6


@pytest.mark.parametrize("engine", ENGINES)
def test_every_integer_is_the_oracles(engine: str) -> None:
    stolen = 0
    for seed in range(FIRST, FIRST + CASES):
        case = stealing_case(seed)
        expected = run("oracle", case)
        assert run(engine, case) == expected, f"seed {seed}"
        case = with_capacity(case, seed)
        expected = run("oracle", case)
        assert run(engine, case) == expected, f"seed {seed} in {case.placement.capacity}"
        stolen += expected.steal_messages
    assert stolen > 0


def test_so_it_is_where_a_policy_has_something_to_say_as_well() -> None:
    own = PolicyParameters(file=Policy("own", ask=at_once, idle=to_the_next_one), steal="half")
    for seed in range(FIRST, FIRST + CASES // 3):
        case = replace(stealing_case(seed), policy=own)
        assert run("compiled", case) == run("oracle", case), f"seed {seed}"


def test_who_steals_asks_each_other_pe_once_until_rays_or_pixels_come() -> None:
    for seed in range(FIRST, FIRST + CASES):
        case = stealing_case(seed)
        log = result_of("compiled", case).log
        assert log is not None
        for pe in range(case.machine.processors):
            asked: Counter[int] = Counter()
            for row in log[(log["pe"] == pe) & np.isin(log["event"], (RECEIVE, SEND))]:
                is_question = row["kind"] == STEAL and row["payload_bytes"] == 0
                if row["event"] == SEND and is_question:
                    assert row["load"] == 0, f"seed {seed}"
                    asked[int(row["other"])] += 1
                    assert asked.most_common(1)[0][1] == 1, f"seed {seed}"
                elif row["event"] == RECEIVE and row["kind"] in (RAYS, STEAL) and row["rays"] > 0:
                    asked.clear()


def test_pixels_that_were_given_arrive_and_one_stays() -> None:
    for seed in range(FIRST, FIRST + CASES):
        case = alone_with_all(seed)
        log = result_of("compiled", case).log
        assert log is not None
        answers = log[(log["kind"] == STEAL) & (log["payload_bytes"] > 0)]
        given, taken = answers[answers["event"] == SEND], answers[answers["event"] == RECEIVE]
        assert given["rays"].sum() == taken["rays"].sum()
        assert (given["ready"][given["rays"] > 0] > 0).all()


@pytest.mark.parametrize("engine", ENGINES)
def test_with_everything_everywhere_pixels_of_one_pe_are_shared(engine: str) -> None:
    gained = 0
    for seed in range(FIRST, FIRST + CASES):
        case = alone_with_all(seed)
        alone = replace(case, policy=replace(case.policy, steal="none"))
        shared, kept = run(engine, case), run(engine, alone)
        assert (shared.tests, shared.rays) == (kept.tests, kept.rays)
        assert shared.messages_by_kind == (0, 0, 0, 0)
        gained += shared.makespan_ps < kept.makespan_ps
    assert gained > CASES // 5


def alone_with_all(seed: int) -> Case:
    """The replicated scene, all pixels of each island on its first PE."""
    case = stealing_case(seed)
    placement = everywhere(replace(case.placement, islands=1))
    placement = replace(placement, pixel_pes=np.zeros_like(placement.pixel_pes))
    return replace(case, placement=placement, policy=PolicyParameters(CEILING, steal="half"))
