"""Other choices of constants, parameters and readings, as ``--set`` takes them.

Single choices go to the ends of the ranges that the preset t3e gives (`simmpp machine t3e`), or to
another reading of what the paper leaves open; packing and the bytes of a ray, whose indices are
next to nothing (../sensitivity), are left out. Several at once combine what helps some claim.
"""

from __future__ import annotations

from dataclasses import dataclass

AS_X = "memory.transient=x"


@dataclass(frozen=True)
class Choice:
    """One set of constants for all scenes."""

    name: str
    kind: str
    """default, constant, policy, reading, several or full."""
    sets: tuple[str, ...] = ()
    """``KEY=VALUE``; the rest has its default."""
    resolution: int = 256
    """Pixels along each side; the paper has 512."""


def _one(kind: str, *texts: str) -> list[Choice]:
    return [Choice(text, kind, tuple(text.split("; "))) for text in texts]


DEFAULT = Choice("default", "default")
SINGLE = [
    *_one(
        "constant",
        "machine.send_startup=5 us; machine.receive_startup=8 us",
        "machine.send_startup=20 us; machine.receive_startup=30 us",
        "machine.test=0.4 us",
        "machine.test=1 us",
        "machine.test=2 us",
        "machine.ray=0.5 us",
        "machine.ray=11 us",
        "machine.quantum=16",
        "machine.quantum=256",
    ),
    *_one(
        "policy",
        "policy.ask_at_least=1",
        "policy.ask_at_least=8",
        "policy.ask_at_least=128",
        "policy.min_load=1%",
        "policy.min_load=50%",
        "policy.batch=16",
        "policy.batch=64",
        "policy.batch=1024",
        "policy.load_info=none",
        "policy.load_info=exact",
        "policy.load_info={refresh: 5 ms}",
        "policy.merge_requests=false",
    ),
    *_one(
        "reading",
        "memory.residents=nearest",
        "memory.residents=hot",
        "memory.transient=10",
        "memory.transient=100",
        AS_X,
        "ready_order=breadth-first",
        "placement.pixels=tiles",
        "placement.pixels=interleaved",
        "placement.pixels=random",
        "placement.owners=morton",
        "placement.owners=round_robin",
        "placement.owners=random",
        "picture.shadows=false; picture.refraction=false",
    ),
]

FAST = "machine.send_startup=5 us; machine.receive_startup=8 us"
SLOW = "machine.send_startup=20 us; machine.receive_startup=30 us"
BEST = f"placement.pixels=interleaved; {FAST}; {AS_X}"
BLIND = "policy.merge_requests=false; policy.load_info=none"
SEVERAL = _one(
    "several",
    f"placement.pixels=interleaved; {FAST}",
    "placement.pixels=interleaved; memory.residents=nearest",
    f"placement.pixels=interleaved; {AS_X}",
    "placement.pixels=interleaved; policy.ask_at_least=8",
    f"placement.pixels=interleaved; {FAST}; machine.ray=11 us",
    BEST,
    f"placement.pixels=interleaved; {FAST}; {AS_X}; policy.min_load=50%",
    f"placement.pixels=interleaved; {FAST}; memory.residents=nearest; policy.ask_at_least=8",
    "policy.ask_at_least=8; policy.min_load=50%",
    "policy.ask_at_least=8; memory.residents=nearest",
    "policy.ask_at_least=8; machine.test=1 us",
    BLIND,
    f"{BLIND}; placement.pixels=tiles",
    f"{BLIND}; placement.pixels=random; memory.residents=nearest",
    f"{BLIND}; placement.pixels=random; memory.residents=nearest; machine.send_startup=12 us; "
    "machine.receive_startup=24 us",
    f"{BLIND}; placement.pixels=random; memory.residents=nearest; {SLOW}",
)
"""Combinations of choices that, alone, make some claim hold or come near to it."""
FULL = [Choice(f"{BEST}, at 512 x 512", "full", tuple(BEST.split("; ")), resolution=512)]
"""The set for which most claims hold, at full resolution."""
