"""What the paper and the documents leave open: each factor with its range and where that is from.

A range is drawn log-uniformly if it spans a factor, else uniformly; the levels of a reading are
equally likely. Values are rounded to what is written into rows, and rows are simulated from that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

PROCESSORS = 64
PS_PER_MS = 10**9

Value = str | float
Values = Mapping[str, Value]


@dataclass(frozen=True)
class Factor:
    """One uncertain constant, or one open reading."""

    name: str
    label: str
    source: str
    """Why this range; ESTIMATE where no document bounds it."""
    low: float = 0.0
    high: float = 0.0
    levels: tuple[str, ...] = ()
    """Readings, in place of a range."""
    log: bool = True

    def at(self, u: float) -> Value:
        """The value at quantile ``u`` from 0 to 1."""
        if self.levels:
            return self.levels[min(int(u * len(self.levels)), len(self.levels) - 1)]
        if self.log:
            return float(f"{math.exp(_between(math.log(self.low), math.log(self.high), u)):.3g}")
        return float(f"{_between(self.low, self.high, u):.3g}")

    def level(self, value: Value) -> str:
        """The reading, or the third of the range, with its number in front."""
        if self.levels:
            return f"{self.levels.index(str(value))} {value}"
        bounds = [self.at(n / 3) for n in range(4)]
        third = sum(float(value) > float(bound) for bound in bounds[1:3])
        return f"{third} {bounds[third]} to {bounds[third + 1]}"


def _between(low: float, high: float, u: float) -> float:
    return low + u * (high - low)


T3E = "range in the preset t3e (`simmpp machine t3e`)"
UNSAID = "ESTIMATE: the paper names the parameter, gives no value"
FACTORS = (
    Factor("x", "fraction x", "the abscissa of the paper's figures", 1 / 64, 0.9, log=False),
    Factor("startup_us", "startup, send + receive", f"{T3E}: 5-20 + 8-30 us", 13, 50),
    Factor("copy_mb_per_s", "packing bandwidth", T3E, 150, 340),
    Factor("test_us", "cost of a test", T3E, 0.4, 4),
    Factor("ray_us", "cost of a ray", T3E, 0.5, 11),
    Factor(
        "object_bytes",
        "bytes of an object",
        "ESTIMATE of a primitive: a bare sphere 48, with its material inlined 256",
        48,
        256,
    ),
    Factor("ray_bytes", "bytes of a ray", T3E, 64, 184),
    Factor("quantum", "quantum", T3E, 16, 256),
    Factor("ask_at_least", "ask_at_least", f"{UNSAID}; 1 asks at once, 256 is a batch", 1, 256),
    Factor("min_load", "min_load", f"{UNSAID}; shares of n0 / nb", 0.01, 0.5),
    Factor("batch", "batch", "ESTIMATE: the paper buffers rays, not saying how many", 16, 1024),
    Factor("residents", "residents", "open in the paper", levels=("random", "nearest", "hot")),
    Factor(
        "transient",
        "transient memory",
        "section 2.1 keeps a copy, section 3.1 does not: none, 1 % of the objects, as many as x",
        levels=("0", "1%", "x"),
    ),
    Factor(
        "ready_order",
        "order of ready rays",
        "open in the paper",
        levels=("depth-first", "breadth-first"),
    ),
    Factor(
        "pixels",
        "pixels",
        "open in the paper",
        levels=("blocks", "tiles", "interleaved", "random"),
    ),
    Factor(
        "owners",
        "owners",
        "open in the paper",
        levels=("bisection", "morton", "round_robin", "random"),
    ),
    Factor(
        "load_info",
        "load information",
        "section 4.2.2: piggyback, or its cure; exact and none bound them",
        levels=("piggyback", "refresh 5 ms", "exact", "none"),
    ),
    Factor(
        "merge_requests",
        "requests merged",
        "section 3.1 requests for each ray; an implementation need not",
        levels=("true", "false"),
    ),
)

DEFAULT_OBJECT_BYTES = 128
UNREAD = {
    "object": {"ask_at_least", "min_load", "batch", "load_info"},
    "ray": {"ask_at_least", "min_load", "load_info", "merge_requests", "transient", "object_bytes"},
    "concurrent": set[str](),
}
"""Factors that a policy does not read: its simulation is the same whatever they are."""


def values_at(quantiles: list[float]) -> Values:
    """A value for each factor."""
    return {each.name: each.at(u) for each, u in zip(FACTORS, quantiles, strict=True)}


def machine_of(values: Values) -> Machine:
    """The T3E with the constants drawn; a third of the startup is the sender's, as there."""
    startup = Fraction(str(values["startup_us"]))
    copies = {"bandwidth": f"{values['copy_mb_per_s']} MB/s"}
    overrides: dict[str, object] = {
        "send_startup": round(startup / 3 * 10**6),
        "receive_startup": round(startup * 2 / 3 * 10**6),
        "pack": copies,
        "unpack": copies,
        "test": f"{values['test_us']} us",
        "ray": f"{values['ray_us']} us",
        "ray_bytes": f"{round(float(values['ray_bytes']))} B",
        "quantum": round(float(values["quantum"])),
    }
    for key in ("send_startup", "receive_startup"):
        overrides[key] = f"{overrides[key]} ps"
    return machine("t3e", overrides, PROCESSORS)


def placement_of(values: Values, workload: Workload, seed: int) -> Placement:
    """Owners, residents and pixels as drawn; the same seed at every draw."""
    x = Fraction(str(values["x"]))
    kept = {"0": Fraction(0), "1%": Fraction(1, 100), "x": x}[str(values["transient"])]
    memory = Memory(
        fraction=x,
        residents=values["residents"],  # type: ignore[arg-type]
        transient=math.ceil(kept * workload.n_objects),
    )
    rules = PlacementRules(values["owners"], values["pixels"])  # type: ignore[arg-type]
    return place(workload, PROCESSORS, memory, rules, seed)


def policy_of(name: str, values: Values) -> PolicyParameters:
    """A policy with the parameters drawn."""
    info = str(values["load_info"])
    return PolicyParameters(
        name,
        min_load=Fraction(str(values["min_load"])),
        batch=round(float(values["batch"])),
        ask_at_least=round(float(values["ask_at_least"])),
        load_info="piggyback" if info.startswith("refresh") else info,  # type: ignore[arg-type]
        refresh_ps=5 * PS_PER_MS if info.startswith("refresh") else None,
        merge_requests=values["merge_requests"] == "true",
    )
