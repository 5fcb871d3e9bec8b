"""What rules see when the oracle asks them: exact fractions where the engines have floors."""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from types import SimpleNamespace

from simmpp.policy.parameters import PolicyParameters


class View(SimpleNamespace):
    """The fields of ``simmpp.policy.view.View``, by the same names."""


def numbers(policy: PolicyParameters, n_primaries: int, processors: int) -> dict[str, Fraction]:
    """The policy's own numbers, shares of n0 / nb as that many rays."""
    values = {field.name: getattr(policy, field.name) for field in fields(policy)}
    shares = {name: value for name, value in values.items() if isinstance(value, Fraction)}
    counts = {name: Fraction(value) for name, value in values.items() if type(value) is int}
    share = Fraction(n_primaries, processors)
    return counts | {name: value * share for name, value in shares.items()}
