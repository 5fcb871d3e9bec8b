"""What must hold of messages that carry several things, under every policy and on every network."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest
from builders import SHARING, Case, policies_of, random_case, with_policy
from implementations import IMPLEMENTATIONS, run
from oracles.ledger import Outcome, Slice

from simmpp.engine.arrays.records import NONE
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST
from simmpp.machine.torus import CONTENTIONS

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
CASES = 15
"""Random machines, each of them on both networks and under every policy."""


@cache
def runs(implementation: str) -> list[tuple[Case, Outcome]]:
    """Random cases under every policy, whatever it packs, on every network."""
    drawn = [random_case(seed) for seed in range(CASES)]
    on = [
        replace(case, machine=replace(case.machine, contention=contention))
        for case in drawn
        for contention in CONTENTIONS
    ]
    packed = [each for case in on for each in policies_of(case)]
    return [(case, run(implementation, case)) for case in packed]


def test_parts_of_the_messages_are_those_of_the_run(implementation: str) -> None:
    for case, outcome in runs(implementation):
        sent = [s for s in outcome.slices if s.what == "send" and s.number != NONE]
        kinds = [
            RAYS if s.rays else OBJECT if s.objects else REQUEST if s.requests else LOAD
            for s in sent
        ]
        assert [s.kind for s in sent] == kinds
        assert outcome.messages_by_kind == tuple(kinds.count(kind) for kind in range(4))
        requests, objects = sum(s.requests for s in sent), sum(s.objects for s in sent)
        assert outcome.parts_by_kind == (requests, objects, kinds.count(RAYS), kinds.count(LOAD))
        assert sum(s.rays for s in sent) == outcome.rays_sent
        assert requests == objects
        if case.policy.packing == "none":
            assert outcome.parts_by_kind == outcome.messages_by_kind


def test_a_message_is_received_with_all_its_parts(implementation: str) -> None:
    for _, outcome in runs(implementation):
        sent = {(s.pe, s.number): s for s in outcome.slices if s.what == "send"}
        for got in outcome.slices:
            if got.what == "receive":
                message = sent[got.other, got.number]
                assert parts_of(got) == parts_of(message)
                assert message.other == got.pe


def test_random_machines_pack(implementation: str) -> None:
    sent = [s for _, outcome in runs(implementation) for s in outcome.slices if s.what == "send"]
    assert sum(s.requests > 1 for s in sent) > 50
    assert sum(s.objects > 1 for s in sent) > 50


def parts_of(message: Slice) -> tuple[int, ...]:
    """What is in a message."""
    content = (message.rays, message.objects, message.requests)
    return (message.kind, message.payload_bytes, *content)


def test_all_requests_of_a_message_are_answered_in_one(implementation: str) -> None:
    for _, outcome in runs(implementation):
        for activity, sends in activities_of(outcome):
            answers = [(s.other, s.objects, s.rays, s.requests) for s in sends if s.objects]
            if activity.what == "receive" and activity.requests:
                assert answers == [(activity.other, activity.requests, 0, 0)]
                assert sends[0].objects
            else:
                assert answers == []


def test_a_dispatch_goes_once_round_the_ring(implementation: str) -> None:
    # With requests packed first with rays, then with requests; unpacked several times with requests
    for case, outcome in runs(implementation):
        nb = case.machine.processors
        if case.policy.rules.to_holders and case.policy.packing == "none":
            continue  # the least loaded comes first
        for _, sends in activities_of(outcome):
            turns = [
                (case.policy.packing != "all" and not s.rays, (s.other - s.pe) % nb)
                for s in sends
                if s.rays or s.requests
            ]
            if case.policy.packing == "none":
                assert [rest for rest, _ in turns] == sorted(rest for rest, _ in turns)
                turns = [turn for turn in turns if not turn[0]]
            assert turns == sorted(set(turns))


def activities_of(outcome: Outcome) -> Iterator[tuple[Slice, list[Slice]]]:
    """What each PE received or computed, and the messages that it sent at the end of that."""
    begins = [i for i, each in enumerate(outcome.slices) if each.what != "send"]
    for begin, end in pairwise([*begins, len(outcome.slices)]):
        yield outcome.slices[begin], outcome.slices[begin + 1 : end]


def test_where_a_dispatch_sends_one_thing_packing_changes_nothing(implementation: str) -> None:
    alike = {"object": 0, "concurrent": 0}
    for seed in range(120):
        for name in alike:
            case = with_policy(random_case(seed), name=name, packing="none")
            expected = run(implementation, case)
            if expected.messages_by_kind[REQUEST] and sends_singly(expected):
                alike[name] += 1
                for packing in ("requests", "all") if name == "concurrent" else ("requests",):
                    packed = run(implementation, with_policy(case, packing=packing))
                    assert packed == expected, seed
    assert min(alike.values()) > 8, alike


def sends_singly(outcome: Outcome) -> bool:
    """No dispatch decided more than one thing."""
    return all(
        sum(s.rays > 0 or s.requests > 0 for s in sends) < 2 for _, sends in activities_of(outcome)
    )


def test_rays_and_requests_share_a_message_only_where_each_ray_asks(implementation: str) -> None:
    # A message takes all rays that may go to a PE. What is left there is asked for already: only
    # another request of the same object could ride along
    shared = {False: 0, True: 0}
    for seed in range(100):
        for merged in shared:
            case = replace(random_case(seed), policy=replace(SHARING, merge_requests=merged))
            slices = run(implementation, case).slices
            shared[merged] += sum(
                s.what == "send" and s.rays > 0 and s.requests > 0 for s in slices
            )
    assert shared[True] == 0
    assert shared[False] > 3, shared
