"""An advice in sentences, the most important first, and the settings to run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from simmpp.common.units import counted, format_ps
from simmpp.common.yamlfile import written
from simmpp.run import words
from simmpp.studies.advise.advice import NODE_SECONDS, Advice
from simmpp.studies.advise.answer_memory import credits_told, nothing_told, unfit_told
from simmpp.studies.advise.confidence import LEAST_SEEDS
from simmpp.studies.advise.sensitivity import Swing
from simmpp.studies.advise.told import (
    compared,
    listed,
    named,
    node_seconds,
    rounded_time,
    share_told,
    time_told,
    times_the_nodes,
)

TURNS_TOLD = 3
"""Constants that are told to change the advice, at most; the page shows more."""


def sentences_of(advice: Advice) -> list[str]:
    """All of it."""
    of_a_part = [advice.left_out] if advice.left_out else []
    number = advice.verdict.chosen
    if number is None:
        return [*nothing_told(advice), *of_a_part, *unfit_told(advice)]
    told = [*_use(advice, number), *of_a_part, *_sure(advice)]
    told += [*_next(advice, number), *credits_told(advice), *unfit_told(advice)]
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


# --- the parts ---


def _use(advice: Advice, number: int) -> Iterator[str]:
    chosen, found = advice.fitting[number], advice.makespan_ps(number)
    bound = rounded_time(advice.bounds[number])
    text = f"Use {named(chosen)}: {time_told(found)}, of which computing alone takes {bound}"
    if advice.asked.goal == NODE_SECONDS:
        text += f"; {node_seconds(found.mean * chosen.processors)}"
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
        sure = words.capital(share_told(verdict.sure))
        yield f"{sure} sure, with {LEAST_SEEDS} seeds, that {claim}."
    elif claim:
        yield f"{words.capital(claim)}; nothing about them is drawn, so seeds have no part in that."
    if given.kept is not None:
        yield (
            f"With the machine's constants drawn from their ranges it stays so on"
            f" {given.n_kept} of {given.n_draws} machines:"
            f" {share_told(verdict.sure * given.kept)} sure{' of both' * is_drawn}."
        )
    if verdict.ties and not isinstance(asked.goal, int):
        others = listed(named(advice.fitting[n]) for n in verdict.ties)
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
    text = f"{first}: {named(runner_up)}: {time_told(found)}, {compared(found.mean / own.mean)}"
    if runner_up.processors != chosen.processors:
        text += f", with {times_the_nodes(runner_up.processors / chosen.processors)}"
    yield f"{text}."


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


def _rounded(swing: Swing, value: int) -> str:
    """With three digits."""
    return swing.constant.text(int(float(f"{value:.3g}")))
