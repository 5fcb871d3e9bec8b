"""What hooks see when the oracle asks them: all fields of the view, read or not."""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from math import floor
from types import SimpleNamespace

import numpy as np

from oracles.costs import intersection_ps, packing, receiving, sending, unpacking
from oracles.network import distance, network_ps
from oracles.state import PE
from oracles.world import World
from simmpp.common.randomness import key
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.view import View


def numbers(policy: PolicyParameters, n_primaries: int, processors: int) -> dict[str, int]:
    """The numbers that every policy has, shares of n0 / nb as that many rays."""
    values = {field.name: getattr(policy, field.name) for field in fields(policy)}
    share = Fraction(n_primaries, processors)
    shares = {k: floor(v * share) for k, v in values.items() if isinstance(v, Fraction)}
    return shares | {k: v for k, v in values.items() if type(v) is int}


def random_draw(seed: int, pe: PE) -> int:
    """The PE's next random number, from numpy's own generator."""
    bits = np.random.Philox(key=[key(seed, "policy"), pe.number], counter=pe.draws)
    pe.draws += 1
    return int(bits.random_raw()) >> 1


class Views(World):
    """The oracle's views."""

    def view(self, pe: PE, other: int, nothing_else: bool, draws: bool) -> SimpleNamespace:
        """What any hook of this PE sees when it decides about another."""
        known, age = self.known_load(pe.clock, pe, other)
        own = dict(zip(self.rules.parameters, self.policy.numbers, strict=True))
        return SimpleNamespace(
            now_ps=pe.clock,
            me=pe.number,
            nb=self.nb,
            load=pe.load,
            ready=len(pe.ready),
            held_bytes=self.held_bytes(pe),
            nothing_else=int(nothing_else),
            initial_load=self.workload.n_primaries // self.nb,
            other=other,
            known_load=known,
            age_ps=age,
            in_flight=pe.in_flight_to[other] if self.policy.load_info == "piggyback" else 0,
            hops=distance(self.machine, pe.number, other),
            parameter=[*self.policy.numbers, *[0] * 8][:8],
            memory=pe.memory,
            random=random_draw(self.seed, pe) if draws else None,
            **numbers(self.policy, self.workload.n_primaries, self.nb),
            **own,
        )

    def view_of_destination(
        self, pe: PE, other: int, waiting: int, nothing_else: bool, draws: bool
    ) -> View:
        """What send is shown."""
        view = self.view(pe, other, nothing_else, draws)
        view.waiting, view.unasked = waiting, 0
        view.object = view.owner = -1
        view.object_bytes = view.test_ps = view.holders = view.requests = 0
        n_bytes, machine = waiting * self.machine.ray_bytes, self.machine
        here = pe.number
        view.send_ps = sending(machine, here, other, RAYS) + packing(machine, RAYS, n_bytes)
        receipt = receiving(machine, other, here, RAYS) + unpacking(machine, RAYS, n_bytes)
        view.receive_ps, view.flight_ps = receipt, network_ps(machine, here, other, n_bytes)
        self.with_thread(view)
        return view  # type: ignore[return-value]

    def with_thread(self, view: SimpleNamespace) -> None:
        """What a thread receives its PE takes over."""
        if self.machine.service == "thread":
            view.flight_ps += view.receive_ps
            view.receive_ps = self.machine.handoff_ps

    def view_of_object(
        self, pe: PE, obj: int, unasked: int, nothing_else: bool, draws: bool
    ) -> View:
        """What ask is shown."""
        owner, machine, n_bytes = self.owners[obj], self.machine, self.object_bytes[obj]
        view = self.view(pe, owner, nothing_else, draws)
        view.object, view.owner, view.object_bytes = obj, owner, n_bytes
        view.test_ps = intersection_ps(machine, self.workload, obj)
        view.holders = sum(obj in each.resident for each in self.pes)
        view.waiting, view.unasked = len(pe.rays_of(obj)), unasked
        view.requests = pe.in_flight[obj]
        asked, fetched = machine.request_bytes, n_bytes
        here = pe.number
        view.send_ps = sending(machine, here, owner, REQUEST) + packing(machine, REQUEST, asked)
        receipt = receiving(machine, here, owner, OBJECT) + unpacking(machine, OBJECT, fetched)
        there, back = (
            network_ps(machine, here, owner, asked),
            network_ps(machine, owner, here, fetched),
        )
        answering = receiving(machine, owner, here, REQUEST) + unpacking(machine, REQUEST, asked)
        answering += sending(machine, owner, here, OBJECT) + packing(machine, OBJECT, fetched)
        view.receive_ps = receipt
        view.flight_ps = there + back + (0 if machine.service == "nic" else answering)
        self.with_thread(view)
        return view  # type: ignore[return-value]

    def known_load(self, clock: int, pe: PE, other: int) -> tuple[int, int]:
        """What a PE knows of another's load, and for how long it has."""
        if self.policy.load_info == "none":
            return -1, clock
        if self.policy.load_info in ("exact", "two") or self.policy.sample_ps == 0:
            return self.pes[other].ended_load, 0
        if self.policy.load_info == "sampled":
            return self.sampled[other], clock - self.sampled_at
        return pe.known_load[other], clock - pe.heard[other]
