"""What limits a run: of what its makespan consists, and what would help first.

The time of all PEs together, nb x makespan, is told in parts that add up to it exactly:

- *compute*: tests and rays. That is the bound, which no way of sending messages changes, but who
  computes where speeds differ.
- *launches*: startups of computing, and what lanes of an accelerator add that are left empty.
- *reductions*: the adding up of tallies at the end.
- *startups*: what messages cost their two PEs whatever their size, fixed costs of packing and
  unpacking included; with a thread what the PEs pay.
- *copying*: the rest of communication, which is packing and unpacking by the byte, and probes.
- *one hot PE*: nb x (busy time of the busiest PE - that of the next, or the mean if larger).
- *imbalance*: nb x (busy time of the next, or the mean if larger, - the mean).
- *barriers*: that time of rounds, as far as even the busiest PE waits.
- *latency*: nb x (makespan - busy time of the busiest PE), when even that one waits: for messages
  on their way, and for those who answer. Of that, the part that flights are latency. Flights are
  the mean of those between all pairs of PEs (``flights``): rows don't say who sent to whom.
- *bandwidth*: the rest of that, the part that flights are bytes on a link.

Busy is who computes or communicates. The last four are what PEs wait; where only sums over PEs are
known, as in rows of sweeps, they are one part, *waiting*, or *imbalance* if no message was sent.
Where the machine's constants are not known, startups and copying are one, *communication*. Startups
are those of all messages sent, so of the few that are still in flight at the end, too, and no more
than all communication.

Parts are means over PEs and say where the time is; without one of them the makespan may be shorter
by more than that, as where the busiest PE has most of it, or by less, as where others wait instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from simmpp.engine.result import Result
from simmpp.machine.machine import Machine
from simmpp.machine.messages import RAYS, REQUEST
from simmpp.machine.service import fixed_costs
from simmpp.machine.transfer import PS_PER_S
from simmpp.methods.simulation import integers
from simmpp.run.flights import mean_flight

COMPUTE, LAUNCHES = "compute", "launches"
STARTUPS, COPYING = "startups", "copying"
REDUCTIONS, BARRIERS = "reductions", "barriers"
HOT, IMBALANCE, LATENCY, BANDWIDTH = "one hot PE", "imbalance", "latency", "bandwidth"
COMMUNICATION, WAITING = "communication", "waiting"
"""Startups and copying; the four that follow them."""
SENT = (REDUCTIONS, STARTUPS, COPYING, COMMUNICATION)
PARTS = (COMPUTE, LAUNCHES, *SENT, HOT, IMBALANCE, BARRIERS, LATENCY, BANDWIDTH, WAITING)
KINDS = ("request", "object", "ray", "load")
NEAR_THE_BOUND = 0.9
"""Share of compute from which little else is left to be gained."""

Numbers = Mapping[str, Any]
"""Integers of a run by the columns of ``results.csv``."""


@dataclass(frozen=True)
class MessageCosts:
    """What limits need of a machine."""

    startups_ps: tuple[int, ...]
    """Of both PEs, for each kind of message; the mean of levels'."""
    fixed_ps: tuple[int, ...]
    """Of packing and unpacking, for each kind of part."""
    flight_ps: int
    """Latency, with the hops between two PEs in the mean; of levels the mean."""
    bytes_per_s: int
    """0: unlimited."""

    @classmethod
    def of(cls, constants: Mapping[str, Any]) -> MessageCosts:
        """From a machine's fields, as ``run.json`` has them; KeyError where these were others."""
        flight = mean_flight(constants)
        costs = fixed_costs(constants, flight.send_startup_ps, flight.receive_startup_ps)
        return cls(*costs, flight.latency_ps, flight.bytes_per_s)


@dataclass(frozen=True)
class Limits:
    """The parts of a makespan, or of those of several seeds."""

    parts_ps: Mapping[str, int]
    """Of all PEs together; their sum is nb x makespan."""
    help: Mapping[str, str]
    """What makes a part less."""

    @property
    def shares(self) -> dict[str, float]:
        """Each part over their sum."""
        total = sum(self.parts_ps.values()) or 1
        return {part: ps / total for part, ps in self.parts_ps.items()}

    @property
    def first(self) -> str:
        """The largest part; compute only near the bound, for all else is easier to change."""
        shares = self.shares
        others = {part: share for part, share in shares.items() if part != COMPUTE}
        if shares[COMPUTE] >= NEAR_THE_BOUND or not any(others.values()):
            return COMPUTE
        return max(others, key=lambda part: others[part])

    def __str__(self) -> str:
        """``"limited most by startups, 45 % of the makespan (compute is 20 %); what ..."``."""
        first, shares = self.first, self.shares
        text = f"limited most by {first}, {shares[first] * 100:.0f} % of the makespan"
        if first != COMPUTE:
            text += f" (compute is {shares[COMPUTE] * 100:.0f} %)"
        return f"{text}; what would help first: {self.help[first]}"


def limits_of_run(result: Result, machine: Machine) -> Limits:
    """The parts of a run, all of them."""
    accounts = result.compute_ps.tolist(), result.communication_ps.tolist()
    costs = MessageCosts.of(asdict(machine))
    return limits_of(integers(result), machine.processors, costs, *accounts)


def limits_of(
    numbers: Numbers,
    processors: int,
    costs: MessageCosts | None = None,
    compute_ps: Sequence[int] = (),
    communication_ps: Sequence[int] = (),
) -> Limits:
    """The parts of a run, from its row, and as far as known its machine and the accounts of PEs."""
    sent = _sent(numbers, processors, costs)
    waits = _waits(numbers, processors, costs, compute_ps, communication_ps)
    is_owner = _owners_are_hot(numbers, compute_ps, communication_ps)
    launch_ps = numbers.get("launch_ps") or 0
    computing = {COMPUTE: numbers["compute_ps"] - launch_ps}
    if launch_ps:
        computing[LAUNCHES] = launch_ps
    return Limits({**computing, **sent, **waits}, _help(numbers, is_owner))


def together(of_seeds: Iterable[Limits]) -> Limits:
    """The parts of several seeds, added up."""
    limits = list(of_seeds)
    there = [part for part in PARTS if any(part in of.parts_ps for of in limits)]
    parts = {part: sum(of.parts_ps.get(part, 0) for of in limits) for part in there}
    return Limits(parts, limits[0].help)


def _sent(numbers: Numbers, processors: int, costs: MessageCosts | None) -> dict[str, int]:
    """The parts of communication."""
    total_ps = numbers["communication_ps"]
    if costs is None:
        return {COMMUNICATION: total_ps}
    reductions_ps = processors * (numbers.get("reduction_ps") or 0)
    total_ps -= reductions_ps
    parts = [numbers.get(f"{kind}_parts") or numbers[f"{kind}_messages"] for kind in KINDS]
    fixed_ps = sum(n * each for n, each in zip(parts, costs.fixed_ps, strict=True))
    counts = (numbers[f"{kind}_messages"] for kind in KINDS)
    each_ps = sum(n * each for n, each in zip(counts, costs.startups_ps, strict=True))
    # One of a policy's own, or for pixels, is sent as rays are, and copied as a request is.
    own_ps = costs.startups_ps[RAYS] + costs.fixed_ps[REQUEST]
    of_own = (numbers.get(name) or 0 for name in ("user_messages", "steal_messages"))
    each_ps += sum(of_own) * own_ps
    if reductions_ps == 0:  # deposits are sent as rays are
        of_rays_ps = costs.startups_ps[RAYS] + costs.fixed_ps[RAYS]
        each_ps += (numbers.get("tally_messages") or 0) * of_rays_ps
    startups_ps = min(total_ps, each_ps + fixed_ps)
    sent = {STARTUPS: startups_ps, COPYING: total_ps - startups_ps}
    return {REDUCTIONS: reductions_ps, **sent} if reductions_ps else sent


def _waits(
    numbers: Numbers,
    nb: int,
    costs: MessageCosts | None,
    compute_ps: Sequence[int],
    communication_ps: Sequence[int],
) -> dict[str, int]:
    """The parts of waiting."""
    if costs is None or not len(compute_ps):
        return {WAITING if numbers["messages"] else IMBALANCE: numbers["waiting_ps"]}
    busy_ps = sorted(c + m for c, m in zip(compute_ps, communication_ps, strict=True))
    next_ps = max(nb * busy_ps[-2] if nb > 1 else 0, sum(busy_ps))  # times nb, as all the others
    nobody_ps = nb * (numbers["makespan_ps"] - busy_ps[-1])
    barriers_ps = min(nobody_ps, nb * (numbers.get("barrier_ps") or 0))
    nobody_ps -= barriers_ps
    flights_ps = numbers["messages"] * costs.flight_ps
    rate = costs.bytes_per_s
    transfers_ps = numbers["bytes_sent"] * PS_PER_S // rate if rate else 0
    latency_ps = nobody_ps * flights_ps // ((flights_ps + transfers_ps) or 1)
    return {
        HOT: nb * busy_ps[-1] - next_ps,
        IMBALANCE: next_ps - sum(busy_ps),
        **({BARRIERS: barriers_ps} if barriers_ps else {}),
        LATENCY: latency_ps if transfers_ps else nobody_ps,
        BANDWIDTH: nobody_ps - latency_ps if transfers_ps else 0,
    }


def _owners_are_hot(
    numbers: Numbers, compute_ps: Sequence[int], communication_ps: Sequence[int]
) -> bool:
    """Whether the busiest PE is so for what it owns: rays come to it, or it answers most."""
    if not len(compute_ps) or numbers["rays_sent"]:
        return bool(numbers["rays_sent"])
    nb = len(compute_ps)
    busiest = max(range(nb), key=lambda pe: compute_ps[pe] + communication_ps[pe])
    more = [of[busiest] - sum(of) / nb for of in (compute_ps, communication_ps)]
    return more[1] > more[0]


def _help(numbers: Numbers, is_owner: bool) -> dict[str, str]:
    """What makes each part less, in keys of the configuration."""
    fetches = numbers["request_messages"] + numbers["object_messages"] > numbers["ray_messages"]
    owners = "deal objects otherwise (placement.owners), hold the most used (memory.residents: hot)"
    deal = owners if is_owner else "deal pixels otherwise (placement.pixels)"
    fewer = (
        "fewer requests: room for fetched objects (memory.transient), packing, more memory"
        if fetches
        else "fewer messages: larger batches of rays (policy.batch)"
    )
    lighter = "smaller objects, or rays instead" if fetches else "fewer rays on their way"
    return {
        COMPUTE: "more PEs or faster tests: little else is left to gain",
        LAUNCHES: "more rays at each go: a larger machine.quantum, fewer PEs, a larger picture",
        REDUCTIONS: "fewer or smaller results, or placement.tallies: send",
        STARTUPS: fewer,
        COPYING: f"fewer bytes: {lighter}",
        COMMUNICATION: fewer,
        HOT: deal,
        IMBALANCE: deal,
        BARRIERS: "fewer and larger rounds, several at a time (placement.rounds), fewer PEs",
        LATENCY: "more rays at once on each PE: fewer PEs, a larger picture",
        BANDWIDTH: f"faster links, or fewer bytes: {lighter}",
        WAITING: "find out for what, as simmpp run --out tells",
    }
