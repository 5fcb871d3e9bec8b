"""When the oracle's PE sends rays and asks for objects: the four policies as plain conditions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from simmpp.policy.parameters import PolicyParameters


@dataclass(frozen=True)
class View:
    """What a PE knows when it decides about PE j, or about an object."""

    load: int
    waiting: int
    """Rays that could be sent to PE j, or that no request for the object covers."""
    nothing_else: bool
    min_load: Fraction = Fraction(0)
    """In rays."""
    known_load: Fraction | None = None
    """Of PE j; None with load_info none."""
    age_ps: int = 0
    """Time since that was heard."""


Rule = Callable[[View], bool]


@dataclass(frozen=True)
class Rules:
    """A policy; None is a rule that it does not have."""

    may_send: Rule | None = None
    may_ask: Rule | None = None
    ask_at_least: int | None = None
    """Fixed number of rays that is enough to ask; None: the parameter."""
    knows_loads: bool = False
    """The send rule reads the load of PE j; only then are loads refreshed."""


def always(view: View) -> bool:
    """Whenever a batch is full or there is nothing else to do."""
    return True


def to_the_less_loaded(view: View) -> bool:
    """The paper's rule of concurrent dataflow."""
    return view.load > view.min_load and (view.known_load is None or view.load > view.known_load)


RULES = {
    "object": Rules(may_ask=always, ask_at_least=1),
    "ray": Rules(may_send=always),
    "concurrent": Rules(may_send=to_the_less_loaded, may_ask=always, knows_loads=True),
    "replicated": Rules(),
}


def minimum_load(policy: PolicyParameters, n_primaries: int, processors: int) -> Fraction:
    """The minimal load in rays: a share of n0 / nb, or a count as it is."""
    if isinstance(policy.min_load, Fraction):
        return policy.min_load * Fraction(n_primaries, processors)
    return Fraction(policy.min_load)
