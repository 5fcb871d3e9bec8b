"""How the sentences of an advice call candidates, times and shares."""

from __future__ import annotations

from collections.abc import Iterable

from simmpp.common.units import format_ps
from simmpp.run import words
from simmpp.studies.advise.candidates import Candidate
from simmpp.sweeps.intervals import MeanInterval

MOST_TOLD = 4
"""Names in a list, before the rest is counted."""


def named(candidate: Candidate, short: bool = False) -> str:
    """``"concurrent dataflow (rows-used) on 16 PEs"``."""
    flow = words.policy(candidate.policy.name)
    name = candidate.setup.name
    flow = "the " * flow.endswith("scene") + flow
    called = flow if name == candidate.policy.name else f"{flow} ({name})"
    where = words.said("processors", candidate.processors)
    return f"{name} on {candidate.processors}" if short else f"{called} on {where}"


def time_told(found: MeanInterval) -> str:
    """A mean and its interval, with three digits."""
    text = rounded_time(found.mean)
    if found.low == found.high:
        return text
    if found.low != found.low:
        return f"{text} (one seed)"
    return f"{text} (95 %: {rounded_time(found.low)} to {rounded_time(found.high)})"


def rounded_time(time_ps: float) -> str:
    """With three digits."""
    return format_ps(int(float(f"{time_ps:.3g}")))


def node_seconds(time_ps: float) -> str:
    """``"0.12 node-seconds"``."""
    return f"{time_ps / 1e12:.3g} node-seconds"


def times_the_nodes(ratio: float) -> str:
    """``"twice the nodes"``."""
    known = {2.0: "twice the nodes", 0.5: "half the nodes", 0.25: "a quarter of the nodes"}
    return known.get(ratio, f"{ratio:.3g} times the nodes")


def compared(ratio: float) -> str:
    """``"1.7% longer"``."""
    return f"{ratio - 1:.1%} longer" if ratio >= 1 else f"{1 - ratio:.1%} shorter"


def share_told(share: float) -> str:
    """Never more than it can be known."""
    return "more than 99 %" if share > 0.99 else f"{share * 100:.0f} %"


def either(numbers: Iterable[int]) -> str:
    """``"4, 16 or 64"``."""
    return words.any_of(map(str, numbers))


def listed(names: Iterable[str]) -> str:
    """``"a, b, c, d and 3 others"``."""
    every = list(names)
    more = len(every) - MOST_TOLD
    return words.any_of([*every[:MOST_TOLD], f"{more} others"] if more > 0 else every, "and")
