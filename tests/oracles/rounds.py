"""Rounds in the oracle: who is of which, when one is over, and when the next one begins."""

from __future__ import annotations

import heapq
from collections import defaultdict
from dataclasses import dataclass, field

from oracles.memory import Bounded
from oracles.state import PE
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD
from simmpp.workload.workload import FORM_FACTOR


def barrier_ps(machine: Machine) -> int:
    """A message of each PE in each of as many stages as it takes to double 1 up to nb."""
    of = machine.levels[-1] if machine.topology == "levels" else machine
    stages = 0
    while 2**stages < machine.processors:
        stages += 1
    return stages * (of.send_startup_ps + of.receive_startup_ps + of.latency_ps)


@dataclass
class Rounds(Bounded):
    """Bounded PEs whose roots begin round by round."""

    begins: list[int | None] = field(default_factory=list)
    """When each round begins; None: not known yet."""
    round_messages: int = 0
    over_ps: list[int] = field(default_factory=list)
    """When the rounds that are over were known to be, as far as rays go."""

    received_ps: defaultdict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    """Round: when batches of its deposits were received."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.begins = [0 if k < self.placement.window else None for k in range(self.n_rounds)]

    def look_for_rounds(self, time: int, pe: PE) -> bool:
        """Start the roots of rounds that have begun; have any?"""
        began = False
        while pe.round < self.n_rounds:
            begin = self.begins[pe.round]
            if begin is None or begin > time:
                break
            pe.asked = set()
            self.start(pe, [ray for ray in pe.later if self.round_of[ray] == pe.round])
            pe.round += 1
            pe.owes += barrier_ps(self.machine) if self.chooses() else 0
            began = True
        if began:
            self.sample_rays(pe)
            self.sample_bytes(pe)
        return began

    def start(self, pe: PE, roots: list[int]) -> None:
        """Behind the pixels that are not touched, breadth-first before all else."""
        if self.credits or self.steals:
            pe.pixels += roots
            return
        pixels = [n for n, ray in enumerate(pe.ready) if ray in pe.untouched]
        at = len(pe.ready) if self.ready_order == "depth-first" else int(pe.cut)
        at = max([at, *(n + 1 for n in pixels)])
        pe.ready[at:at] = roots
        pe.untouched |= set(roots)

    def chooses(self) -> bool:
        """Whether a reduction says what the next round is."""
        return self.n_rounds > 1 and FORM_FACTOR in self.workload.kinds[: self.workload.n_primaries]

    def reduce(self, time: int, pe: PE) -> int:
        """Take part in reductions; returns the end of that."""
        pe.refresh_allowed = True
        clock = self.pay("communication", pe, time, pe.owes)
        pe.owes = 0
        self.ledger.did(pe, time, "receive", clock, None, kind=LOAD)
        return clock

    def end_rounds(self) -> None:
        """Some rays are finished: which rounds are over, and what begins when?"""
        while (k := len(self.over_ps)) < self.n_rounds:
            if not self.is_over(k):
                return
            self.over_ps.append(max([*self.over_ps, *self.ends_of(k)]))
            if (then := k + self.placement.window) < self.n_rounds:
                begin = self.over_ps[k] + barrier_ps(self.machine)
                self.begins[then] = begin
                stages = (self.machine.processors - 1).bit_length()
                self.round_messages += self.nb * stages * (2 if self.chooses() else 1)
                heapq.heappush(self.queue, ((begin, 0, self.nb, then, 0), "round", None))

    def round_ends(self) -> list[int]:
        """When the last ray of each was finished."""
        return [
            max(self.ends_of(k), default=0) if self.is_over(k) else -1 for k in range(self.n_rounds)
        ]

    def is_over(self, k: int) -> bool:
        """Whether all rays of a round are finished."""
        return all(ray in self.done for ray in self.rays_of_round(k))

    def rays_of_round(self, k: int) -> list[int]:
        """All of them."""
        return [ray for ray, its in enumerate(self.round_of) if its == k]

    def ends_of(self, k: int) -> list[int]:
        """When its rays were finished, and its deposits received."""
        return [self.ledger.ray_ends[ray] for ray in self.rays_of_round(k)] + self.received_ps[k]

    def round_begins(self, time: int, _: None) -> None:
        """Wake all who sleep."""
        for pe in self.pes:
            if pe.asleep:
                pe.asleep = False
                self.schedule(time, pe, "begin")
