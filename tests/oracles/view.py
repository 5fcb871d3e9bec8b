"""What hooks see when the oracle asks them: all fields of the view, read or not."""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from math import floor
from types import SimpleNamespace

import numpy as np

from oracles.costs import intersection_ps, packing, unpacking
from oracles.network import distance, network_ps, receiving, sending
from oracles.pace import rounded, speed_of
from oracles.state import PE
from oracles.tallies import Tallying
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


class Views(Tallying):
    """The oracle's views."""

    def view(self, pe: PE, other: int, nothing_else: bool, draws: bool) -> SimpleNamespace:
        """What any hook of this PE sees when it decides about another."""
        known, age = self.known_load(pe.clock, pe, other)
        own = dict(zip(self.rules.parameters, self.policy.numbers, strict=True))
        island = self.island_of(pe.number)
        return SimpleNamespace(
            now_ps=pe.clock,
            me=island.index(pe.number),
            nb=len(island),
            load=pe.load,
            ready=pe.n_ready,
            held_bytes=self.held_bytes(pe),
            nothing_else=int(nothing_else),
            initial_load=self.roots_at_once // self.nb,
            other=island.index(other),
            known_load=known,
            age_ps=age,
            in_flight=pe.in_flight_to[other] if self.policy.load_info == "piggyback" else 0,
            hops=distance(self.machine, pe.number, other),
            parameter=[*self.policy.numbers, *[0] * 8][:8],
            memory=pe.memory,
            random=random_draw(self.seed, pe) if draws else None,
            finished=pe.finished,
            busy_ps=pe.worked["compute"] + pe.worked["communication"],
            compute_ps=pe.worked["compute"],
            fetched=pe.fetched,
            released=pe.released,
            speed=rounded(1000 * speed_of(self.machine, pe.number)),
            other_speed=rounded(1000 * speed_of(self.machine, other)),
            **numbers(self.policy, self.roots_at_once, self.nb),
            **own,
        )

    def view_of_destination(
        self, pe: PE, other: int, groups: list[list[int]], nothing_else: bool, draws: bool
    ) -> View:
        """What send is shown; the rays that may go are grouped by what they wait for."""
        view, waiting = self.view(pe, other, nothing_else, draws), sum(map(len, groups))
        view.waiting, view.unasked = waiting, 0
        self.show_fetches(view, pe, [self.next_object(rays[0]) for rays in groups])
        view.object = view.owner = -1
        view.object_bytes = view.test_ps = view.holders = view.requests = 0
        n_bytes, machine = waiting * self.machine.ray_bytes, self.machine
        here = pe.number
        view.send_ps = sending(machine, here, other, RAYS) + packing(machine, RAYS, n_bytes)
        view.receive_ps, by_thread_ps = self.taken_in(other, here, RAYS, n_bytes)
        view.flight_ps = network_ps(machine, here, other, n_bytes) + by_thread_ps
        return view  # type: ignore[return-value]

    def view_of_object(
        self, pe: PE, obj: int, unasked: int, nothing_else: bool, draws: bool
    ) -> View:
        """What ask is shown."""
        owner = self.owner_of(pe.number, obj)
        view = self.view(pe, owner, nothing_else, draws)
        view.object, view.owner, view.object_bytes = obj, view.other, self.object_bytes[obj]
        cost_ps = intersection_ps(self.machine, self.workload, obj)
        view.test_ps = rounded(cost_ps / speed_of(self.machine, pe.number))
        view.holders = sum(obj in self.pes[k].resident for k in self.island_of(pe.number))
        view.waiting, view.unasked = len(pe.rays_of(obj)), unasked
        view.requests = pe.in_flight[obj]
        view.send_ps, view.receive_ps, view.flight_ps = self.fetch_ps(pe, obj)
        self.show_fetches(view, pe, [obj])
        return view  # type: ignore[return-value]

    def show_fetches(self, view: SimpleNamespace, pe: PE, objects: list[int]) -> None:
        """What fetching all of these objects would take."""
        costs = [self.fetch_ps(pe, obj) for obj in objects]
        view.objects = len(objects)
        view.fetch_ps = sum(there + back for there, back, _ in costs)
        view.fetch_flight_ps = sum(between for *_, between in costs)

    def fetch_ps(self, pe: PE, obj: int) -> tuple[int, int, int]:
        """Of a request, of the object, and of all that is in between."""
        here, owner, machine = pe.number, self.owner_of(pe.number, obj), self.machine
        asked, fetched = machine.request_bytes, self.object_bytes[obj]
        ask_ps = sending(machine, here, owner, REQUEST) + packing(machine, REQUEST, asked)
        between_ps = network_ps(machine, here, owner, asked)
        between_ps += network_ps(machine, owner, here, fetched)
        if machine.service != "nic":
            between_ps += receiving(machine, owner, here)
            between_ps += unpacking(machine, REQUEST, asked)
            between_ps += sending(machine, owner, here, OBJECT) + packing(machine, OBJECT, fetched)
        receive_ps, by_thread_ps = self.taken_in(here, owner, OBJECT, fetched)
        return ask_ps, receive_ps, between_ps + by_thread_ps

    def taken_in(self, pe: int, other: int, kind: int, n_bytes: int) -> tuple[int, int]:
        """What receipt costs a PE, and what its thread does for it before."""
        receipt = receiving(self.machine, pe, other) + unpacking(self.machine, kind, n_bytes)
        if self.machine.service == "thread":
            return self.machine.handoff_ps, receipt
        return receipt, 0

    def known_load(self, clock: int, pe: PE, other: int) -> tuple[int, int]:
        """What a PE knows of another's load, and for how long it has."""
        if self.policy.load_info == "none":
            return -1, clock
        if self.policy.load_info in ("exact", "two") or self.policy.sample_ps == 0:
            return self.pes[other].ended_load, 0
        if self.policy.load_info == "sampled":
            return self.sampled[other], clock - self.sampled_at
        return pe.known_load[other], clock - pe.heard[other]
