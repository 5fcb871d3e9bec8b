"""Messages of a policy's own and times to be woken at, worked out by hand (costs in ``by_hand``).

A message of a policy's own has 32 bytes and costs what a request does: 10 + 2 ps to send, 20 + 6
to receive, and 130 + 32 + 4 = 166 in between.
"""

from __future__ import annotations

import pytest
from by_hand import case_of
from implementations import IMPLEMENTATIONS, result_of, run
from oracles.ledger import Slice

from simmpp.engine.simulate import ENGINES
from simmpp.machine.messages import OBJECT, REQUEST, USER
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.policy.view import View
from simmpp.run.limits import COPYING, limits_of_run

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)


def when_told(v: View) -> int:
    return v.memory[0] == 42


def note_and_answer(v: View) -> int:
    v.memory[0] = v.words[0]
    return v.words[1]


def tell_the_other(v: View) -> int:
    v.memory[1] += 1
    if v.me == 1 and v.memory[1] == 1:
        v.other, v.words[0], v.words[1] = 0, 42, v.me
    return 0


def test_a_word_is_heard_and_answered_with_the_same_words(implementation: str) -> None:
    # PE 1   0 has nothing to do: says 42 to 12; 12 + 166 = 178
    # PE 0   0 compute: probe 1; object 1 is missing, it may not ask
    # PE 0 178 hears to 204, answers to 216 (arrives 382), may ask now, to 228; 228 + 142 = 370
    # PE 1 370 receives the request to 396, has answered at 459 (643); hears to 485, answers to 497
    # PE 0 643 receives to 720, hears what came at 663 to 746, answers to 758 (924); compute:
    #          probe 759, object 1 to 1759, the ray's 500 to 2259
    # PE 1 924 hears to 950, but has said 2 (2 - 1) things and not got on: its answer is dropped
    policy = Policy("told", ask=when_told, heard=note_and_answer, idle=tell_the_other)
    case = case_of(PolicyParameters(file=policy), [(0, [1])])
    outcome = run(implementation, case)
    assert outcome.makespan_ps == 2259
    assert (outcome.user_messages, outcome.user_dropped) == (4, 1)
    assert outcome.messages_by_kind == (1, 1, 0, 0)
    assert outcome.bytes_sent == 4 * (32 + 4) + (8 + 4) + (50 + 4)
    assert [one[:4] for one in outcome.slices] == [
        (0, 0, "compute", 1),
        (0, 178, "receive", 204),
        (0, 204, "send", 216),
        (0, 216, "send", 228),
        (0, 643, "receive", 720),
        (0, 720, "receive", 746),
        (0, 746, "send", 758),
        (0, 758, "compute", 2259),
        (1, 0, "send", 12),
        (1, 370, "receive", 396),
        (1, 396, "send", 459),
        (1, 459, "receive", 485),
        (1, 485, "send", 497),
        (1, 924, "receive", 950),
    ]
    if implementation in ENGINES:  # of communication, copying is an object to and fro, and 2 probes
        limits = limits_of_run(result_of(implementation, case), case.machine)
        assert limits.parts_ps[COPYING] == 2 * 50 + 2 * 1
    kinds = [one.kind for one in outcome.slices if one.what != "compute"]
    assert kinds[:6] == [USER, USER, REQUEST, OBJECT, USER, USER]
    assert kinds[6:] == [USER, REQUEST, OBJECT, USER, USER, USER]
    assert outcome.communication_ps == [
        1 + 26 + 12 + 12 + 77 + 26 + 12 + 1,
        12 + 26 + 63 + 26 + 12 + 26,
    ]


def the_second_time(v: View) -> int:
    v.memory[0] += 1
    return v.memory[0] == 2


def as_soon_as_possible(v: View) -> int:
    return v.now_ps + 1


def test_who_wants_to_be_woken_decides_again_then(implementation: str) -> None:
    # PE 0 1 may not ask; wants to be woken at 2, is 1 us after the start: asks to 1_000_012
    # unpacked 504 ps after the dispatch, probe, test, the ray: 1 + 1000 + 500
    policy = Policy("later", ask=the_second_time, idle=as_soon_as_possible)
    outcome = run(implementation, case_of(PolicyParameters(file=policy), [(0, [1])]))
    assert outcome.makespan_ps == 1_000_000 + 504 + 1501
    assert outcome.slices[:2] == [
        Slice(0, 0, "compute", 1, load=1),
        Slice(0, 1_000_000, "send", 1_000_012, 0, 0, 1, 0, 1, REQUEST, 0, 8, 0, 1),
    ]
    assert outcome.waiting_ps[0] == 1_002_005 - 1500 - (1 + 12 + 77 + 1)
