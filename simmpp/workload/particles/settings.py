"""The key ``particles``: how many are followed, and how."""

from __future__ import annotations

from typing import Annotated, Literal

from simmpp.common.strict import Switch, declared, integer
from simmpp.common.validate import MOST_COUNT

ROULETTE = 0.01
"""Weight below which chance decides whether a particle goes on."""
SURVIVORS = 10
"""One of so many does, with so many times the weight: both as MCML has it (Wang, Jacques and Zheng
1995, "MCML: Monte Carlo modeling of light transport in multi-layered tissues"), which begins at
0.0001."""


@declared
class Particles:
    """Particles of one group, all with the weight 1 at first."""

    count: Annotated[int, *integer(1, MOST_COUNT)] = 100_000
    """Particles that the source emits."""
    seed: Annotated[int, *integer(0, 2**32 - 1)] = 0
    """What chance is drawn from."""
    capture: Literal["analogue", "implicit"] = "analogue"
    """A collision absorbs a particle, or scatters it, by chance; or it takes its share of the
    particle's weight, which goes on: below a weight of 0.01 one in ten, with ten times the weight.
    """
    splitting: Switch = False
    """Particles are split where they come into cells of greater importance (`scene.cells.boxes`),
    and each part is a particle of its own."""
