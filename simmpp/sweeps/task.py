"""What is simulated once: a point without its names, known by a hash of all that decides it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, fields, replace
from fractions import Fraction
from typing import Any

from simmpp.config.config import Config
from simmpp.methods.table import METHODS, SIMULATE
from simmpp.placement.place import draws
from simmpp.placement.placement import OF_HOMES, Memory, PlacementRules
from simmpp.policy.parameters import CEILING, PolicyParameters
from simmpp.policy.reads import numbers_read, reads
from simmpp.policy.view import NUMBERS
from simmpp.sweeps.grid import GridPoint

TELL_NOTHING = ("name", "sources", "power_mw", "price_micros")
"""Fields of machines that decide no simulation."""


@dataclass(frozen=True, eq=False)
class Task:
    """One simulation, as small as can be sent to another machine."""

    key: str
    """Hexadecimal hash: equal points have equal keys, whatever they are called."""
    placement_key: str
    """Likewise, of the workload, the machine and the placement."""
    digest: str
    """Of the workload."""
    config: Config
    policy: PolicyParameters
    seed: int
    """The point's; 0 where nothing is drawn, so that all seeds are one simulation."""
    is_noisy: bool = False
    """Seeds differ wherever objects are."""


def _of_everything(rules: PlacementRules) -> PlacementRules:
    """What of them matters where everything is in every memory."""
    owners = rules.owners if rules.pixels in OF_HOMES else PlacementRules().owners
    return replace(rules, owners=owners, islands=PlacementRules().islands)


def _said(rules: PlacementRules) -> dict[str, Any]:
    """What they are, but for what tables alone have and these do not ask for."""
    said, usual = asdict(rules), PlacementRules()
    of_tables = [name for name in ("rounds", "tallies") if said[name] == getattr(usual, name)]
    return {name: value for name, value in said.items() if name not in of_tables}


def task_of(point: GridPoint, digest: str) -> Task:
    """The simulation of a point on the workload of that digest.

    Raises ConfigError if the machine does not have the point's number of PEs.
    """
    config, policy = point.config, canonical(point.policy)
    settings = config.settings
    # One that rests has something to say also where nothing else is to do.
    if settings.method == SIMULATE and not policy.rests and _holds_everything(config):
        policy = PolicyParameters(CEILING)
    everywhere = policy.rules.all_resident
    rules = _of_everything(settings.placement) if everywhere else settings.placement
    memory = Memory(fraction=Fraction(1)) if everywhere else config.memory
    machine = constants_of(config)
    is_noisy = machine["noise"] != "0"
    is_random = reads(policy.rules, "random") or policy.load_info == "two" or is_noisy
    is_drawn = draws(memory, rules) or is_random
    is_drawn = is_drawn and METHODS[settings.method].is_placed
    seed = point.seed if is_drawn else 0
    # {}: unlike any fraction's; x and 0% are the share and the number that they stand for
    held = {} if everywhere else asdict(memory) | {"transient": memory.kept or 0}
    held |= {"kept": memory.kept_bytes, "bounds": config.memory.bounds}
    place = _hash(digest, machine, held, _said(rules), seed)
    return Task(
        key=_hash(place, decides(policy), settings.ready_order, settings.method, settings.engine),
        placement_key=place,
        digest=digest,
        config=replace(config, source=None),
        policy=policy,
        seed=seed,
        is_noisy=is_noisy,
    )


def constants_of(config: Config) -> dict[str, Any]:
    """All of a point's machine that decides a simulation."""
    constants = asdict(replace(config.machine_for(config.processors), sources={}))
    return {name: value for name, value in constants.items() if name not in TELL_NOTHING}


def canonical(policy: PolicyParameters) -> PolicyParameters:
    """The policy without its label, and with the defaults of what its rules do not read."""
    rules, defaults = policy.rules, PolicyParameters()
    if rules.all_resident and not policy.rests:
        return PolicyParameters(CEILING)
    ignored = ["label"]
    ignored += sorted(set(NUMBERS) - set(numbers_read(rules)))
    ignored += [] if policy.knows_loads else ["load_info", "refresh_ps", "sample_ps"]
    ignored += [] if rules.asks else ["merge_requests"]
    unread: dict[str, Any] = {name: getattr(defaults, name) for name in ignored}
    return replace(policy, **unread)


def decides(policy: PolicyParameters) -> dict[str, Any]:
    """What decides what a policy does: of a file not where it lies, but what is in it."""
    said = {field.name: getattr(policy, field.name) for field in fields(policy)}
    return said | {"file": policy.own.get("digest"), "set": policy.numbers}


def _holds_everything(config: Config) -> bool:
    """Is the whole scene in every memory, so that no rule of a policy is ever asked?"""
    full = config.memory.bytes is None and config.memory.share >= 1
    return full or config.settings.placement.islands == config.processors


def _hash(*parts: object) -> str:
    """SHA-256 of plain data; fractions and the like as text."""
    text = json.dumps(parts, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
