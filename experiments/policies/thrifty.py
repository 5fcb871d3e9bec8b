"""Thrifty: a PE fetches only what many rays want, and sends the others to its owner.

Concurrent dataflow sends to the less loaded. This one also sends, whatever the loads, where
fetching would not pay: a fetch takes four startups and brings a ray one test, while a message of
rays takes two and its rays often find what they need next beside it. How many rays are few is
learnt: the fewer rays what was fetched has released, the more are sent. There is no minimal load.

The numbers were chosen on one half of the scenes (README.md), so they are ESTIMATES.
"""

from __future__ import annotations

from simmpp.policy import Policy, hook
from simmpp.policy.view import View

MOST_FEW = 64
"""However little fetches release, more rays than that are not few."""


@hook
def unless_many_want_it(v: View) -> int:
    """All, to an owner that has less to do or for objects that few rays want."""
    its = v.known_load
    if v.age_ps == v.now_ps:  # never heard: at least as much as here
        its = max(its, v.load)
    if v.load * 100 > (its + v.in_flight) * v.share:
        return v.waiting
    few = v.few
    if v.released > 0:
        few = min(MOST_FEW, v.learnt * v.fetched // v.released)
    return v.waiting if v.waiting <= few or v.waiting * 2 <= v.objects * 3 else 0


@hook
def when_sufficient(v: View) -> int:
    """Ask: this is asked when a sufficient number of rays needs it, or nothing else is to do."""
    return 1


POLICY = Policy(
    "thrifty",
    "Nebel 1998, section 4.1, and what a fetch costs beside a message of rays (section 3.1)",
    send=unless_many_want_it,
    ask=when_sufficient,
    like="concurrent",
    batch="batch",
    ask_at_least=32,
    parameters={"share": 133, "few": 8, "learnt": 40},
)
