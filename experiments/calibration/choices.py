"""Other choices of constants, parameters and readings, as ``--set`` takes them.

Single choices go to the ends of the ranges that the preset t3e gives (`simmpp machine t3e`), or to
another reading of what the paper leaves open; packing and the bytes of a ray, whose indices are
next to nothing (../sensitivity), are left out. Several at once are drawn from the same ranges.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from scipy.stats import qmc

from simmpp.placement.residents import resident_count
from simmpp.scene.load import load_scene
from simmpp.sweeps.config import Config

sys.path.append(str(Path(__file__).parent.parent / "sensitivity"))
from factors import FACTORS, Values, values_at

SEED = 1998
AS_X = "memory.transient=as many as x"
"""Not a key: the transient memory of each point holds x N objects."""


@dataclass(frozen=True)
class Choice:
    """One set of constants for all scenes."""

    name: str
    kind: str
    """default, constant, policy, reading, several, full or drawn."""
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
BLIND = "policy.merge_requests=false; policy.load_info=none"
SEVERAL = _one(
    "several",
    f"placement.pixels=interleaved; {FAST}",
    "placement.pixels=interleaved; memory.residents=nearest",
    f"placement.pixels=interleaved; {AS_X}",
    "placement.pixels=interleaved; policy.ask_at_least=8",
    f"placement.pixels=interleaved; {FAST}; machine.ray=11 us",
    f"placement.pixels=interleaved; {FAST}; {AS_X}",
    f"placement.pixels=interleaved; {FAST}; memory.residents=nearest; policy.ask_at_least=8",
    "policy.ask_at_least=8; policy.min_load=50%",
    "policy.ask_at_least=8; memory.residents=nearest",
    "policy.ask_at_least=8; machine.test=1 us",
    BLIND,
    f"{BLIND}; placement.pixels=tiles",
    f"{BLIND}; placement.pixels=random; memory.residents=nearest",
    f"{BLIND}; placement.pixels=random; memory.residents=nearest; {SLOW}",
)
"""Combinations of choices that, alone, make some claim hold or come near to it."""
FULL = [
    Choice(f"{text}, at 512 x 512", "full", tuple(text.split("; ")), resolution=512)
    for text in (f"placement.pixels=interleaved; {AS_X}", "policy.ask_at_least=8")
]
"""Sets for which more claims hold than for the default, at full resolution."""


def drawn(number: int) -> list[Choice]:
    """A Sobol sequence over all factors of the sensitivity analysis that a configuration has."""
    sample = qmc.Sobol(len(FACTORS), rng=SEED).random(number)
    return [
        Choice(f"drawn {n}", "drawn", assignments(values_at(quantiles)))
        for n, quantiles in enumerate(sample.tolist())
    ]


def assignments(values: Values) -> tuple[str, ...]:
    """The configuration of a draw; x is swept, and objects have the scene's sizes."""
    startup = float(values["startup_us"])
    info = values["load_info"]
    copies = f"{values['copy_mb_per_s']} MB/s"
    kept = {"0": "memory.transient=0", "1%": "memory.transient=10", "x": AS_X}
    return (
        f"machine.send_startup={startup / 3:.3f} us",
        f"machine.receive_startup={startup * 2 / 3:.3f} us",
        f"machine.pack.bandwidth={copies}",
        f"machine.unpack.bandwidth={copies}",
        f"machine.test={values['test_us']} us",
        f"machine.ray={values['ray_us']} us",
        f"machine.ray_bytes={float(values['ray_bytes']):.0f} B",
        f"machine.quantum={float(values['quantum']):.0f}",
        f"policy.ask_at_least={float(values['ask_at_least']):.0f}",
        f"policy.min_load={float(values['min_load']):.1%}",
        f"policy.batch={float(values['batch']):.0f}",
        f"policy.load_info={'{refresh: 5 ms}' if str(info).startswith('refresh') else info}",
        f"policy.merge_requests={values['merge_requests']}",
        f"memory.residents={values['residents']}",
        kept[str(values["transient"])],
        f"ready_order={values['ready_order']}",
        f"placement.pixels={values['pixels']}",
        f"placement.owners={values['owners']}",
    )


def overrides_of(choice: Choice, figure: Config) -> list[str]:
    """What to set in the configuration of a figure."""
    plain = [each for each in choice.sets if each != AS_X]
    return [*plain, _kept_as_x(figure)] if AS_X in choice.sets else plain


def _kept_as_x(figure: Config) -> str:
    """The figure's sweep with a transient memory for x N objects at each x."""
    sweep = dict(figure.settings.sweep)
    scenes = sweep.pop("scene", [f"{figure.settings.scene.spd}:{figure.settings.scene.size}"])
    fractions = [Fraction(str(x)) for x in sweep.pop("memory.fraction")]
    sizes = {str(scene): len(load_scene(str(scene)).objects) for scene in scenes}
    sweep["scene, memory.fraction, memory.transient"] = [
        [scene, str(x), resident_count(x, n)] for scene, n in sizes.items() for x in fractions
    ]
    return f"sweep={json.dumps(sweep)}"
