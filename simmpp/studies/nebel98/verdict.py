"""Whether a claim holds: its criteria, one by one, and how far the tightest is from its bound."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

HOLDS, IN_PART, DOES_NOT = "holds", "in part", "does not"
PAPER = "Nebel 1998, "
CLAIM_COLUMNS = ("claim", "paper", "simulated", "holds", "by")
"""Of ``claims.csv``."""


@dataclass(frozen=True)
class Criterion:
    """One value that must lie between two bounds."""

    label: str
    """The point it is of, such as ``tetra:5, 64 PEs, x = 0.8``."""
    value: float
    low: float = -math.inf
    high: float = math.inf
    strict: bool = False
    """The bounds themselves do not count."""
    accounts: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """What the PEs spend their time with, for each policy concerned; shares by account."""

    @property
    def holds(self) -> bool:
        """Within the bounds; a value that is missing (nan) is not."""
        if self.strict:
            return self.low < self.value < self.high
        return self.low <= self.value <= self.high

    @property
    def margin(self) -> float:
        """Distance to the nearest bound, negative beyond it; nan comes before everything."""
        margin = min(self.value - self.low, self.high - self.value)
        return -math.inf if math.isnan(margin) else margin

    @property
    def wanted(self) -> str:
        """The bounds in words."""
        if math.isinf(self.high):
            return f"{'>' if self.strict else '>='} {self.low:.4g}"
        if math.isinf(self.low):
            return f"{'<' if self.strict else '<='} {self.high:.4g}"
        return f"{self.low:.4g} to {self.high:.4g}"


Part = Sequence[Criterion]
"""What a predicate asks of each of several cases; without a case it is true."""


@dataclass(frozen=True)
class Verdict:
    """A row of ``claims.csv``."""

    claim: str
    paper: str
    """Where the paper says what, with its numbers."""
    simulated: str
    holds: str
    by: str
    """By what margin, and what the PEs of the tightest case spend their time with."""


def verdict(claim: str, paper: str, simulated: str, *parts: Part) -> Verdict:
    """Judge a predicate of one or more parts; ``paper`` is the place in it, and what it says.

    It holds if all cases of all parts do, and in part if at least half of the cases of each part
    do: a part with a single case, such as "the best scene is Mountain5", holds or does not.
    """
    return Verdict(claim, f"{PAPER}{paper}", simulated, judged(parts), by_what(parts))


def judged(parts: Sequence[Part]) -> str:
    """HOLDS, IN_PART or DOES_NOT."""
    if all(case.holds for part in parts for case in part):
        return HOLDS
    half = all(2 * sum(case.holds for case in part) >= len(part) for part in parts)
    return IN_PART if half else DOES_NOT


def by_what(parts: Sequence[Part]) -> str:
    """For each part how many cases hold, and the tightest one."""
    return "; ".join(_by_what(part) for part in parts)


def _by_what(part: Part) -> str:
    if not part:
        return "no case"
    tightest = min(part, key=lambda case: case.margin)
    good = sum(case.holds for case in part)
    text = f"{good} of {len(part)}; " if len(part) > 1 else ""
    text += "tightest: " if tightest.holds and len(part) > 1 else "worst: " if len(part) > 1 else ""
    text += f"{tightest.label}: {tightest.value:.4g} (wanted {tightest.wanted})"
    return text + "".join(_spent(policy, a) for policy, a in tightest.accounts.items())


def _spent(policy: str, accounts: Mapping[str, float]) -> str:
    shares = ", ".join(f"{name} {share:.0%}" for name, share in accounts.items())
    return f"; {policy}: {shares}"
