"""Policies that send messages of their own and want to be woken: bounded, and as the oracle has it.

Each hook is plain Python, compiled for the engines and called as it is by the oracle.
SIMMPP_TEST_CASES says how many random machines each pair of hooks meets (12 if unset).
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from pathlib import Path

import pytest
from builders import Case, random_case, served
from implementations import result_of, run

from simmpp.common.errors import ModelError
from simmpp.engine.record.log import EVENT_KINDS
from simmpp.engine.simulate import ENGINES
from simmpp.machine.machine import SERVICES
from simmpp.machine.messages import USER
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.policy import Hook, Policy
from simmpp.policy.view import View

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "12"))


def always_answers(v: View) -> bool:
    v.words[0] += 1
    return True


def by_all_that_it_hears(v: View) -> int:
    costs = v.send_ps + v.receive_ps + v.flight_ps + v.hops + v.age_ps + v.held_bytes
    seen = v.other + v.me + v.load + v.ready + v.waiting + v.known_load + v.in_flight + v.unasked
    nothing = v.object + v.owner + v.object_bytes + v.test_ps + v.holders + v.requests
    done = v.finished + v.busy_ps + v.compute_ps + v.fetched + v.released
    done += v.objects + v.fetch_ps + v.fetch_flight_ps
    said = done + v.words[0] + 3 * v.words[1] + 5 * v.words[2] + 7 * v.words[3]
    v.memory[0] = (v.memory[0] * 31 + costs + seen + nothing + said + v.now_ps) % 1000003
    v.words[1], v.words[3] = v.memory[0], v.random % 100
    v.other = v.nb + 5  # of no consequence: answers go to who asked
    return v.memory[0] % 3 - 1 - v.nothing_else


def in_a_picosecond(v: View) -> int:
    return v.now_ps + 1


def to_the_next_one_at_once_and_again(v: View) -> int:
    v.other = (v.me + 1) % v.nb
    v.words[0] = v.me
    return 1


def to_itself_or_to_nobody(v: View) -> int:
    v.memory[2] += 1
    v.other = (v.me, v.nb, -7, (v.me + 1) % v.nb)[v.memory[2] % 4]
    return -3


def in_the_far_future(v: View) -> int:
    v.memory[3] += 1
    v.other = (v.me + v.memory[3]) % v.nb
    return 2**63 - 1 if v.memory[3] % 2 else v.now_ps + 10**6 * v.memory[3]


def by_all_that_it_knows(v: View) -> int:
    costs = v.send_ps + v.receive_ps + v.flight_ps + v.hops + v.held_bytes + v.now_ps
    seen = v.me + v.load + v.ready + v.waiting + v.known_load + v.age_ps + v.in_flight + v.unasked
    nothing = v.object + v.owner + v.object_bytes + v.test_ps + v.holders + v.requests + v.other
    nothing += v.finished + v.busy_ps + v.compute_ps + v.fetched + v.released
    nothing += v.objects + v.fetch_ps + v.fetch_flight_ps + v.speed + v.other_speed
    nothing += v.words[0] + v.words[3] + v.nothing_else
    v.memory[1] = (v.memory[1] * 31 + costs + seen + nothing + v.random % 1009) % 1000003
    v.other = v.memory[1] % (v.nb + 2) - 1
    for i in range(4):
        v.words[i] = v.memory[1] >> i
    return v.now_ps + (v.memory[1] % 5) ** 9 if v.memory[1] % 3 else 0


def of_those_who_spoke(v: View) -> int:
    return v.waiting if v.memory[0] % 2 == v.other % 2 or v.nothing_else else 0


def at_once(v: View) -> int:
    return 1


PAIRS: list[tuple[Hook | None, Hook | None]] = [
    (always_answers, in_a_picosecond),
    (always_answers, to_the_next_one_at_once_and_again),
    (None, in_the_far_future),
    (by_all_that_it_hears, to_itself_or_to_nobody),
    (by_all_that_it_hears, by_all_that_it_knows),
    (by_all_that_it_hears, None),
]


def talking_case(seed: int, heard: Hook | None, idle: Hook | None) -> Case:
    case = served(random_case(seed), SERVICES[seed % 3], seed)
    send = of_those_who_spoke if heard is by_all_that_it_hears else None
    own = Policy(
        "talks",
        send=send,
        ask=at_once,
        heard=heard,
        idle=idle,
        candidates="holders" if seed % 2 else "owner",
    )
    packing = own.packings[seed % len(own.packings)]
    return replace(case, policy=replace(case.policy, name="talks", packing=packing, file=own))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("heard", "idle"), PAIRS)
def test_every_integer_is_the_oracles(engine: str, heard: Hook | None, idle: Hook | None) -> None:
    said = 0
    for seed in range(CASES):
        case = talking_case(seed, heard, idle)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
        said += got["user_messages"] + got["user_dropped"]
    assert (said > 0) == (idle not in (None, in_a_picosecond))


@pytest.mark.parametrize(("heard", "idle"), PAIRS[1:5])
def test_who_does_not_get_on_says_no_more_than_is_allowed(
    heard: Hook | None, idle: Hook | None
) -> None:
    dropped = 0
    for seed in range(10):
        case = talking_case(seed, heard, idle)
        result, most = result_of("compiled", case), 2 * (case.machine.processors - 1)
        said = [0] * case.machine.processors
        assert result.log is not None
        for row in result.log:
            event, pe = EVENT_KINDS[row["event"]], row["pe"]
            gets_on = event == "compute" and row["tests"] + row["rays"] > 0
            if gets_on or (event == "receive" and row["rays"] + row["objects"] > 0):
                said[pe] = 0
            said[pe] += event == "send" and row["kind"] == USER
            assert said[pe] <= most
        dropped += result.user_dropped
        assert result.messages == sum(result.messages_by_kind) + result.user_messages
    assert dropped > 0


def never(v: View) -> int:
    return 0


@pytest.mark.parametrize("engine", ENGINES)
def test_who_only_talks_starves_and_is_told_so(engine: str) -> None:
    policy = Policy("starves", ask=never, heard=always_answers, idle=in_a_picosecond)
    with pytest.raises(ModelError, match="rays are left and nothing is scheduled"):
        for seed in range(10):
            run(engine, replace(random_case(seed), policy=PolicyParameters(file=policy)))


def test_the_policy_of_the_guide_is_the_oracles_and_moves_work() -> None:
    policy = PolicyParameters(file=str(Path(__file__).parents[2] / "configs" / "hungry.py"))
    moved = said = 0
    for seed in range(CASES):
        case = replace(random_case(seed), policy=policy)
        expected, got = run("oracle", case), run("compiled", case)
        assert got == expected, seed
        moved += got.rays_sent
        said += got.user_messages
    assert min(moved, said) > 0
