"""What rounds and tallies did, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from simmpp.common.units import counted, format_bytes, format_ps
from simmpp.placement.rounds import window_of
from simmpp.run.point import Point, PolicyRun


def told(point: Point, runs: Sequence[PolicyRun]) -> list[str]:
    """Nothing for rays of one round whose objects have no results, unless these are asked for."""
    return [*_of_rounds(point, runs), *_of_tallies(point, runs)]


def _of_rounds(point: Point, runs: Sequence[PolicyRun]) -> list[str]:
    workload, rules = point.workload, point.config.settings.placement
    window = window_of(rules.rounds)
    if workload.n_rounds == 1:
        return ["all rays are of one round: placement.rounds decides nothing"] * (window > 1)
    n, barrier_ps = runs[0].result.barriers, runs[0].result.barrier_ps
    rays = f"{counted(workload.n_rounds, 'round')} of rays"
    together = f", {counted(window, 'round')} at a time" if window > 1 else ""
    if n == 0:
        return [f"{rays}{together}: none waits for another"]
    shares = ", ".join(
        f"{run.parameters.title} {barrier_ps / run.result.makespan_ps:.1%}"
        for run in runs
        if run.result.makespan_ps
    )
    each = f"{counted(n, 'barrier')} of {format_ps(barrier_ps // n)}"
    return [f"{rays}{together}: {each} are {format_ps(barrier_ps)}, of the makespan {shares}"]


def _of_tallies(point: Point, runs: Sequence[PolicyRun]) -> list[str]:
    workload, how = point.workload, point.config.settings.placement.tallies
    n_bytes = int(workload.object_results.sum())
    if n_bytes == 0:
        return [f"no object has results: tallies {how} sends nothing"] * (how != "reduce")
    of = f"results of {format_bytes(n_bytes)}, {how}"
    if how == "none":
        return [f"{of}: nothing of them is sent"]
    if how == "reduce":
        each = runs[0].result
        took = f"{format_ps(each.reduction_ps)} and {counted(each.tally_messages, 'message')}"
        return [f"{of}: a copy on every PE, added up at the end in {took}"]
    sent = ", ".join(
        f"{run.parameters.title} {run.result.deposits} in {run.result.tally_messages}"
        for run in runs
    )
    return [f"{of}: deposits, and messages with them: {sent}"]
