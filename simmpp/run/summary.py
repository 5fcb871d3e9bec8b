"""What ``simmpp run`` says: a table with a column for each policy, and what one has to know."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from simmpp.common.units import counted, format_bytes, format_ps
from simmpp.engine.tables.residuals import LEFT
from simmpp.machine.topology import topology_of
from simmpp.machine.uneven import total_speed
from simmpp.policy.parameters import CLASSICAL
from simmpp.run import rounds, words
from simmpp.run.fitting import told
from simmpp.run.held import memory_lines
from simmpp.run.point import Point, PolicyRun, ceiling_of, reference_of
from simmpp.run.profit import ratio
from simmpp.workload.describe import ROOTS_OF, primaries, roots
from simmpp.workload.workload import PARTICLE

Cell = Callable[[PolicyRun], str]


def measures(runs: Sequence[PolicyRun]) -> list[tuple[str, list[str]]]:
    """The name of each measure, and what it is for each policy."""
    return [(label, [cell(run) for run in runs]) for label, cell in _lines(runs)]


def heading(point: Point) -> str:
    """Two lines that say what was simulated."""
    workload, machine, placement = point.workload, point.machine, point.placement
    network = str(topology_of(machine))
    if placement.islands > 1:
        network += f", {placement.islands} islands of {placement.island}"
    memory = point.config.memory
    room = f"{float(memory.share):g} of the scene"
    effective = f"(effectively {placement.effective_fraction:.4g})"
    if memory.bytes is not None:
        room = format_bytes(memory.bytes)
    elif memory.fills:
        room, effective = "filled with replicas", "(as much as each policy leaves room for)"
    return (
        f"{workload.name}: {primaries(workload)}, "
        f"{counted(workload.n_rays, 'ray')} in all, "
        f"{counted(workload.n_tests, 'test')}, {counted(workload.n_objects, 'object')}\n"
        f"{machine.name}: {counted(machine.processors, 'PE')} ({network}), memory {room} on each "
        f"{effective}, seed {point.seed}"
    )


def _lines(runs: Sequence[PolicyRun]) -> list[tuple[str, Cell]]:
    base, ceiling = reference_of(runs).result, ceiling_of(runs)
    lines: list[tuple[str, Cell]] = [
        ("makespan", _makespan),
        ("time profit", lambda run: _times(ratio(base.makespan_ps, run.result.makespan_ps))),
    ]
    if ceiling:
        top_ps = ceiling.result.makespan_ps
        lines += [
            ("  against replicated", lambda run: _times(ratio(top_ps, run.result.makespan_ps)))
        ]
    return [
        *lines,
        *_residual_lines(runs),
        *_message_lines(runs),
        ("bytes sent", lambda run: format_bytes(run.result.bytes_sent)),
        ("rays sent", lambda run: f"{run.result.rays_sent}"),
        ("utilisation, least", lambda run: f"{utilisation(run).min():.1%}"),
        ("  mean", lambda run: f"{utilisation(run).mean():.1%}"),
        ("  most", lambda run: f"{utilisation(run).max():.1%}"),
        ("imbalance", lambda run: f"{imbalance(run):.3f}"),
        ("most rays on a PE", lambda run: f"{run.result.peak_rays}"),
        *memory_lines(runs),
    ]


def _residual_lines(runs: Sequence[PolicyRun]) -> list[tuple[str, Cell]]:
    """When little was left to be done, where that is known."""

    def cell(column: str, run: PolicyRun) -> str:
        time_ps = run.result.residuals_ps.get(column)
        return "-" if time_ps is None else format_ps(time_ps)

    return [
        (f"  until {100 * share:g} % is left", partial(cell, column))
        for column, share in LEFT.items()
        if any(column in run.result.residuals_ps for run in runs)
    ]


def _makespan(run: PolicyRun) -> str:
    use = run.result.memory
    return "stuck" if use and use.infeasible else format_ps(run.result.makespan_ps)


def _message_lines(runs: Sequence[PolicyRun]) -> list[tuple[str, Cell]]:
    """Messages by kind and, where a policy packs, what they carry: requests, objects, batches."""
    base = reference_of(runs).result
    of_parts: list[tuple[str, Cell]] = [
        ("  by what they carry", lambda run: _times(ratio(base.parts, run.result.parts)))
    ]
    parts: list[tuple[str, Cell]] = [
        ("parts of messages", lambda run: f"{run.result.parts}"),
        ("  requests", lambda run: f"{run.result.request_parts}"),
        ("  objects", lambda run: f"{run.result.object_parts}"),
        ("  batches of rays", lambda run: f"{run.result.ray_parts}"),
    ]
    packs, talks, steals = (
        any(use in run.parameters.uses for run in runs) for use in ("packs", "talks", "steals")
    )
    has_tallies = any(run.result.tally_messages for run in runs)
    of_its_own: list[tuple[str, Cell]] = [
        ("  of the policy's own", lambda run: f"{run.result.user_messages}"),
        ("    not sent, too many", lambda run: f"{run.result.user_dropped}"),
    ]
    return [
        ("message profit", lambda run: _times(ratio(base.messages, run.result.messages))),
        *(of_parts if packs else []),
        ("messages", lambda run: f"{run.result.messages}"),
        ("  requests", lambda run: f"{run.result.request_messages}"),
        ("  objects", lambda run: f"{run.result.object_messages}"),
        ("  rays", lambda run: f"{run.result.ray_messages}"),
        ("  loads", lambda run: f"{run.result.load_messages}"),
        *(of_its_own if talks else []),
        *([("  of barriers", lambda run: f"{run.result.round_messages}")] if base.barriers else []),
        *([("  of tallies", lambda run: f"{run.result.tally_messages}")] if has_tallies else []),
        *([("  for pixels", lambda run: f"{run.result.steal_messages}")] if steals else []),
        *(parts if packs else []),
    ]


def _times(value: float) -> str:
    return "inf" if math.isinf(value) else f"{value:.3f}"


def utilisation(run: PolicyRun) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Share of the makespan that each PE computes or communicates: (nb,) float64."""
    busy_ps = run.result.compute_ps + run.result.communication_ps
    return np.asarray(busy_ps / max(run.result.makespan_ps, 1), np.float64)


def imbalance(run: PolicyRun) -> float:
    """Busy time of the busiest PE / mean over PEs; 1 where there is no work."""
    busy = utilisation(run)
    return float(busy.max() / busy.mean()) if busy.any() else 1.0


def _best_classical(runs: Sequence[PolicyRun]) -> str:
    """The faster classical dataflow with the same memory, and how long the other dataflows take."""
    classical = [run for run in runs if run.parameters.name in CLASSICAL]
    best = min(classical, key=lambda run: run.result.makespan_ps)
    best_ps = best.result.makespan_ps
    times = {
        run.parameters.title: _times(ratio(run.result.makespan_ps, best_ps))
        for run in runs
        if run is not best and not run.all_resident
    }
    named = f"best classical dataflow: {best.parameters.title}, {format_ps(best_ps)}"
    others = (f"{title} takes {n} times as long" for title, n in times.items())
    absent = [name for name in CLASSICAL if name not in {run.parameters.name for run in classical}]
    return "; ".join([named, *others, *(f"{name} was not run" for name in absent)])


def _memory(point: Point, runs: Sequence[PolicyRun]) -> list[str]:
    """Whether everything fits; a share of the scene is no number of bytes that could be exceeded.

    ``memory.bytes`` is room for resident objects: rays and fetched objects come on top, and the
    simulation bounds neither.
    """
    workload, room = point.workload, point.config.memory.bytes
    if point.placement.effective_fraction == 1:
        scene = format_bytes(int(workload.object_bytes.sum()))
        return [f"the whole scene, {scene}, fits into every memory: nothing has to be sent"]
    if room is None:
        return []
    held = {run.parameters.title: run.result.peak_bytes for run in runs if not run.all_resident}
    if max(held.values()) <= room:
        most = format_bytes(max(held.values()))
        return [f"everything fits into memory: at most {most} on a PE, rays included"]
    beyond = ", ".join(
        f"{title} {format_bytes(size)} ({_times(ratio(size, room))} times as much)"
        for title, size in held.items()
        if size > room
    )
    return [
        f"memory.bytes, {format_bytes(room)}, holds resident objects; with rays and fetched "
        f"objects a PE holds up to: {beyond}"
    ]


def _idle_at_first(point: Point) -> list[str]:
    """How many PEs have no pixel, where there are such: more PEs than rows, or than pixels."""
    nb, (rows, columns) = point.machine.processors, point.workload.picture
    if not (idle := nb - len(np.unique(point.placement.pixel_pes))):
        return []
    by_rows = point.config.settings.placement.pixels == "rows"
    if (of := roots(point.workload)) in ROOTS_OF.values():
        return [f"{idle} of {counted(nb, 'PE')} start without any of the {of}"]
    picture = counted(rows, "row") if by_rows else f"{columns} x {rows} pixels"
    return [f"{idle} of {counted(nb, 'PE')} start without a ray: the picture has {picture}"]


def _other_words(point: Point) -> list[str]:
    """What those who compute particles call the policies."""
    if roots(point.workload) != ROOTS_OF[PARTICLE]:
        return []
    called = [f"{words.policy(name)} is {word}" for name, word in words.OF_PARTICLES.items()]
    return [f"in the words of particle transport: {', '.join(called)}"]


def _stuck(runs: Sequence[PolicyRun]) -> list[str]:
    """Runs that came to no end, as no PE may escape."""
    uses = [(run.parameters.title, run.result.memory) for run in runs]
    return [f"{title}: {use.reason}" for title, use in uses if use and use.reason]


def notes(point: Point, runs: Sequence[PolicyRun]) -> list[str]:
    """The bound, the best classical dataflow, and what the user may not expect of the runs."""
    speed = total_speed(point.machine.speed, point.machine.processors)
    of = "" if not point.machine.speed else " (the sum of speeds)"
    bound = f"bound: total compute / {float(speed):g}{of} = {format_ps(point.bound_ps)}"
    lines = [bound, *told(point), *_stuck(runs), _best_classical(runs)]
    lines += [*rounds.told(point, runs), *_memory(point, runs)]
    lines += [*_idle_at_first(point), *_other_words(point)]
    lines += [
        f"{run.parameters.title}: its {rule} rule never fired"
        for run in runs
        for rule in run.result.rules_never_fired
    ]
    return lines
