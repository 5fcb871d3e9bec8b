"""What does not fit, by how much, and what would do: sentences of an advice."""

from __future__ import annotations

from collections.abc import Iterator

from simmpp.common.units import format_bytes
from simmpp.studies.advise.advice import Advice
from simmpp.studies.advise.candidates import capacity_of
from simmpp.studies.advise.told import either, listed, named


def unfit_told(advice: Advice) -> Iterator[str]:
    """Candidates that do not fit, and the least that would do for each."""
    unfit = [candidate for candidate in advice.candidates if not candidate.fits]
    if not unfit:
        return
    has = format_bytes(capacity_of(advice.config))
    sizes = sorted({each.processors for each in advice.candidates})
    nothing = [s for s in sizes if all(not c.fits for c in advice.candidates if c.processors == s)]
    told = []
    if nothing and advice.fitting:
        least = min(c.least_bytes for c in unfit if c.processors == nothing[-1])
        told.append(
            f"anything on {either(nothing)} PEs (at least {format_bytes(least)} on {nothing[-1]})"
        )
    alike: dict[tuple[str, str], list[str]] = {}
    rest = [c for c in unfit if c.processors not in nothing]
    for name in dict.fromkeys(c.setup.name for c in rest):
        of_name = [c for c in rest if c.setup.name == name]
        needs = dict.fromkeys(format_bytes(c.least_bytes) for c in of_name)
        on = either(c.processors for c in of_name)
        alike.setdefault((on, " and ".join(needs)), []).append(name)
    for (on, needs_of), names in alike.items():
        told.append(f"{listed(names)} on {on} (needs {needs_of} a node)")
    if told:
        yield f"Doesn't fit into {has}: {'; '.join(told)}."


def credits_told(advice: Advice) -> Iterator[str]:
    """Whether credits alone keep it within its memory."""
    if advice.beyond_bytes:
        more = format_bytes(int(float(f"{advice.beyond_bytes:.3g}")))
        yield f"It fits with credits only: without them a node would hold {more} more than it has."


def nothing_told(advice: Advice) -> Iterator[str]:
    """Why nothing is advised, and what memory or how many nodes would do."""
    has = format_bytes(capacity_of(advice.config))
    if advice.fitting:
        yield "Nothing came to an end: no candidate can be advised."
        return
    best = min(advice.candidates, key=lambda each: (each.least_bytes, each.order))
    yield (
        f"Nothing fits into {has} a node. The least memory that would do is"
        f" {format_bytes(best.least_bytes)}, for {named(best)}."
    )
    more = advice.least_nodes
    if more is None:
        yield f"With {has} a node no number of nodes that was looked at would do."
    else:
        yield f"With {has} a node it takes {named(more)}: the least nodes that would do."
