"""Tallies in the oracle: deposits that are sent to owners, copies that are added up."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from oracles.costs import slowest, transfer_ps
from oracles.rounds import Rounds, barrier_ps
from oracles.state import PE, Message, Part
from simmpp.machine.messages import DEPOSIT
from simmpp.machine.topology import topology_of


@dataclass
class Tallying(Rounds):
    """What tests leave in the results of objects."""

    outstanding: Counter[int] = field(default_factory=Counter)
    """Round: batches that have been begun and not been received."""

    def leave(self, pe: PE, ray: int, position: int) -> None:
        """A test was made: what it leaves is to be sent to the owner of the object."""
        obj = self.itineraries[ray][position]
        owner, workload = self.owner_of(pe.number, obj), self.workload
        counts = len(workload.object_results) > 0 and workload.object_results[obj] > 0
        if self.placement.tallies != "send" or owner == pe.number or not counts:
            return
        if len(workload.test_deposits):
            leaves = workload.test_deposits[workload.itinerary_offsets[ray] + position] > 0
        else:
            weights, root = workload.root_weights, workload.pixels[ray]
            leaves = workload.hits[ray] == obj and obj not in self.itineraries[ray][position + 1 :]
            leaves = leaves and (len(weights) == 0 or weights[root] > 0)
        if leaves:
            if not pe.deposits[owner]:
                self.outstanding[self.round_of[ray]] += 1
            pe.deposits[owner].append(ray)

    def batches(self, pe: PE, nothing_else: bool) -> list[tuple[int, Part]]:
        """To whom which batches go now."""
        parcels = []
        for other in self.others(pe):
            rays = pe.deposits[other]
            if len(rays) >= self.policy.batch or (rays and nothing_else):
                its = self.round_of[rays[0]]
                parcels.append((other, Part(DEPOSIT, 16 * len(rays), of_round=its)))
                pe.deposits[other] = []
        return parcels

    def take_deposits(self, clock: int, message: Message) -> None:
        """A batch has been received."""
        for part in message.parts:
            if part.kind == DEPOSIT:
                self.outstanding[part.of_round] -= 1
                self.ledger.deposited_ps.append(clock)
                self.received_ps[part.of_round].append(clock)
                self.end_rounds()

    def is_over(self, k: int) -> bool:
        """Whether all rays of a round are finished, and its deposits received."""
        return super().is_over(k) and self.outstanding[k] == 0

    def reduction(self) -> tuple[int, int, int]:
        """Time, messages and bytes of adding up the copies of all PEs."""
        n_bytes = sum(int(b) for b in self.workload.object_results)
        if self.placement.tallies != "reduce" or n_bytes == 0 or self.nb == 1:
            return 0, 0, 0
        stages = (self.nb - 1).bit_length()
        rates = [rate for rate in topology_of(self.machine).rates if rate]
        rate = slowest(self.machine) if self.machine.topology == "torus" else min(rates, default=0)
        time = barrier_ps(self.machine) + stages * transfer_ps(n_bytes, rate)
        n = stages * self.nb
        return time, n, n * (n_bytes + self.machine.header_bytes)
