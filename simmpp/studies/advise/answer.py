"""An advice in sentences, the most important first, and the settings to run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from simmpp.common.units import counted, format_bytes, format_ps
from simmpp.common.yamlfile import written
from simmpp.run import words
from simmpp.studies.advise.advice import NODE_SECONDS, Advice
from simmpp.studies.advise.candidates import Candidate, capacity_of
from simmpp.studies.advise.confidence import LEAST_SEEDS
from simmpp.studies.advise.sensitivity import Swing
from simmpp.sweeps.intervals import MeanInterval

TURNS_TOLD = 3
"""Constants that are told to change the advice, at most; the page shows more."""
MOST_TOLD = 4
"""Names in a list, before the rest is counted."""


def sentences_of(advice: Advice) -> list[str]:
    """All of it."""
    of_a_part = [advice.left_out] if advice.left_out else []
    number = advice.verdict.chosen
    if number is None:
        return [*_nothing(advice), *of_a_part, *_unfit(advice)]
    told = [*_use(advice, number), *of_a_part, *_sure(advice)]
    told += [*_next(advice, number), *_unfit(advice)]
    return [*told, *_hangs_on(advice)]


def settings_of(advice: Advice) -> str:
    """What to set over the configuration, in YAML; empty if nothing is advised."""
    chosen = advice.chosen
    if chosen is None:
        return ""
    nested: dict[str, Any] = {}
    for key, value in chosen.keys.items():
        *above, last = key.split(".")
        node = nested
        for part in above:
            node = node.setdefault(part, {})
        node[last] = value
    return "".join(f"{key}: {written(value)}\n" for key, value in nested.items())


def named(candidate: Candidate, short: bool = False) -> str:
    """``"concurrent dataflow (rows-used) on 16 PEs"``."""
    flow = words.policy(candidate.policy.name)
    name = candidate.setup.name
    flow = "the " * flow.endswith("scene") + flow
    called = flow if name == candidate.policy.name else f"{flow} ({name})"
    where = words.said("processors", candidate.processors)
    return f"{name} on {candidate.processors}" if short else f"{called} on {where}"


# --- the parts ---


def _use(advice: Advice, number: int) -> Iterator[str]:
    chosen, found = advice.fitting[number], advice.makespan_ps(number)
    bound = rounded_time(advice.bounds[number])
    text = f"Use {named(chosen)}: {_time(found)}, of which computing alone takes {bound}"
    if advice.asked.goal == NODE_SECONDS:
        text += f"; {_node_seconds(found.mean * chosen.processors)}"
    yield f"{text}."
    if isinstance(advice.asked.goal, int) and not advice.verdict.is_within:
        yield (
            f"Nothing takes at most {format_ps(advice.asked.goal)}: this is what comes nearest"
            f" ({found.mean / advice.asked.goal:.2g} times as long)."
        )


def _sure(advice: Advice) -> Iterator[str]:
    verdict, asked, given = advice.verdict, advice.asked, advice.sensitivity
    n, sizes = len(advice.fitting), len({each.processors for each in advice.fitting})
    of = f"{counted(n, 'candidate')} on {counted(sizes, 'number')} of nodes"
    unrun = len(advice.fitting) - len(advice.contest.race.costs) - len(advice.contest.race.dropped)
    if advice.broken_off:
        untried = f", {unrun} were not tried" if unrun > 0 and not verdict.sure else ""
        told = f"of {of}{untried}, this was the best so far"
        if advice.contest.race.is_over:
            told = "the race was over, what it hangs on is not all known"
        yield f"Broken off ({advice.broken_off}): {told}."
    if verdict.sure is None:
        yield f"How sure that is can't be said from fewer than {LEAST_SEEDS} seeds."
        return
    claim = _claim(advice, of)
    is_drawn = any(advice.fitting[number].is_drawn for number in verdict.likely)
    if claim and is_drawn:
        yield f"{words.capital(_share(verdict.sure))} sure, with {LEAST_SEEDS} seeds, that {claim}."
    elif claim:
        yield f"{words.capital(claim)}; nothing about them is drawn, so seeds have no part in that."
    if given.kept is not None:
        yield (
            f"With the machine's constants drawn from their ranges it stays so on"
            f" {given.n_kept} of {given.n_draws} machines:"
            f" {_share(verdict.sure * given.kept)} sure{' of both' * is_drawn}."
        )
    if verdict.ties and not isinstance(asked.goal, int):
        others = _listed(named(advice.fitting[n]) for n in verdict.ties)
        yield f"A tie within {float(asked.indifference):.0%} with {others}."


def _claim(advice: Advice, of: str) -> str:
    """What is sure, or not; nothing where a limit is not kept."""
    goal, most = advice.asked.goal, f"{float(advice.asked.indifference):.0%}"
    if isinstance(goal, int):
        text = f"it takes at most {format_ps(goal)}, and fewer nodes do not (each within {most})"
        return text if advice.verdict.is_within else ""
    measure = "cheaper" if goal == NODE_SECONDS else "faster"
    return f"no other of {of} is more than {most} {measure}"


def _next(advice: Advice, number: int) -> Iterator[str]:
    """The best of the others, and its price."""
    chosen, others = advice.fitting[number], advice.others()
    if not others:
        return
    runner_up, own = advice.fitting[others[0]], advice.makespan_ps(number)
    found = advice.makespan_ps(others[0])
    first = "Runner-up" if found.mean >= own.mean else "As good, but not as simple"
    text = f"{first}: {named(runner_up)}: {_time(found)}, {_compared(found.mean / own.mean)}"
    if runner_up.processors != chosen.processors:
        text += f", with {_times_the_nodes(runner_up.processors / chosen.processors)}"
    yield f"{text}."


def _unfit(advice: Advice) -> Iterator[str]:
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
            f"anything on {_or(nothing)} PEs (at least {format_bytes(least)} on {nothing[-1]})"
        )
    alike: dict[tuple[str, str], list[str]] = {}
    rest = [c for c in unfit if c.processors not in nothing]
    for name in dict.fromkeys(c.setup.name for c in rest):
        of_name = [c for c in rest if c.setup.name == name]
        needs = dict.fromkeys(format_bytes(c.least_bytes) for c in of_name)
        on = _or(c.processors for c in of_name)
        alike.setdefault((on, " and ".join(needs)), []).append(name)
    for (on, needs_of), names in alike.items():
        told.append(f"{_listed(names)} on {on} (needs {needs_of} a node)")
    if told:
        yield f"Doesn't fit into {has}: {'; '.join(told)}."


def _nothing(advice: Advice) -> Iterator[str]:
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


def _hangs_on(advice: Advice) -> Iterator[str]:
    given = advice.sensitivity
    if not given.swings:
        return
    turning = [told for swing in given.swings for told in _turns(advice, swing)]
    if turning:
        yield f"Sensitive to: {'; '.join(turning[:TURNS_TOLD])}."
        return
    most = given.swings[0]
    low, high = (most.constant.text(end) for end in (most.constant.low, most.constant.high))
    n = len(given.swings)
    yield (
        f"No one of {counted(n, 'constant')} of the machine changes the advice within its range;"
        f" most hangs on {most.constant.name} ({low} to {high})."
    )


def _turns(advice: Advice, swing: Swing) -> Iterator[str]:
    for side, at, rival in zip(("below", "above"), swing.turns_at, swing.rivals, strict=True):
        if at is not None:
            then = "takes too long"
            if rival is not None:
                then = f"would change to {named(advice.fitting[rival], short=True)}"
            yield f"{swing.constant.name} ({then} {side} {_rounded(swing, at)})"


# --- words ---


def _rounded(swing: Swing, value: int) -> str:
    """With three digits."""
    return swing.constant.text(int(float(f"{value:.3g}")))


def _time(found: MeanInterval) -> str:
    text = rounded_time(found.mean)
    if found.low == found.high:
        return text
    if found.low != found.low:
        return f"{text} (one seed)"
    return f"{text} (95 %: {rounded_time(found.low)} to {rounded_time(found.high)})"


def rounded_time(time_ps: float) -> str:
    """With three digits."""
    return format_ps(int(float(f"{time_ps:.3g}")))


def _node_seconds(time_ps: float) -> str:
    return f"{time_ps / 1e12:.3g} node-seconds"


def _times_the_nodes(ratio: float) -> str:
    known = {2.0: "twice the nodes", 0.5: "half the nodes", 0.25: "a quarter of the nodes"}
    return known.get(ratio, f"{ratio:.3g} times the nodes")


def _compared(ratio: float) -> str:
    return f"{ratio - 1:.1%} longer" if ratio >= 1 else f"{1 - ratio:.1%} shorter"


def _share(share: float) -> str:
    """Never more than it can be known."""
    return "more than 99 %" if share > 0.99 else f"{share * 100:.0f} %"


def _or(numbers: Iterable[int]) -> str:
    return words.any_of(map(str, numbers))


def _listed(names: Iterable[str]) -> str:
    every = list(names)
    more = len(every) - MOST_TOLD
    return words.any_of([*every[:MOST_TOLD], f"{more} others"] if more > 0 else every, "and")
