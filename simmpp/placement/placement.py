"""Who owns an object, who else holds a replica of it, and who starts with which pixel."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from simmpp.common.validate import require_share, require_whole, require_word
from simmpp.machine.limits import MOST_BYTES

# --- cutting a row of things into near-equal parts ---


def cut(n: int, parts: int) -> NDArray[np.int32]:
    """The part of each of n things in a row, cut at floor(i n / parts): (n,) int32."""
    cuts = np.arange(parts + 1, dtype=np.int64) * n // parts
    return np.repeat(np.arange(parts, dtype=np.int32), np.diff(cuts))


Owners = Literal["bisection", "morton", "round_robin", "random"]
Residents = Literal["random", "nearest", "hot"]
Pixels = Literal["blocks", "tiles", "interleaved", "random"]


@dataclass(frozen=True)
class Memory:
    """What fits into the memory of one PE."""

    fraction: Fraction = Fraction(1, 10)
    """Share x of all N objects that is resident: max(own, floor(x N + 1/2)) objects."""
    bytes: int | None = None
    """The other way to say it: resident objects may take that many bytes; overrides fraction."""
    residents: Residents = "random"
    transient: int = 0
    """Room for that many fetched objects besides the resident ones (least recently used leaves)."""

    def __post_init__(self) -> None:
        require_share("fraction", self.fraction)
        if self.bytes is not None:
            require_whole("bytes", self.bytes, 0, MOST_BYTES)
        require_whole("transient", self.transient, 0)
        require_word("residents", self.residents, get_args(Residents))


@dataclass(frozen=True)
class PlacementRules:
    """How owners and pixels are chosen."""

    owners: Owners = "bisection"
    pixels: Pixels = "blocks"

    def __post_init__(self) -> None:
        require_word("owners", self.owners, get_args(Owners))
        require_word("pixels", self.pixels, get_args(Pixels))


@dataclass(frozen=True, eq=False)
class Placement:
    """One draw of owners, residents and pixels for a number of PEs."""

    processors: int
    owners: NDArray[np.int32]
    """(N,) int32: the PE that owns each object."""
    replica_offsets: NDArray[np.int64]
    """(nb + 1,) int64: PE k holds replicas of
    replica_objects[replica_offsets[k]:replica_offsets[k + 1]] besides the objects it owns."""
    replica_objects: NDArray[np.int32]
    """(replicas,) int32 object ids."""
    transient: int
    """Number of fetched objects that a PE's transient memory holds."""
    pixel_pes: NDArray[np.int32]
    """(n0,) int32: the PE that each primary ray starts on."""

    @property
    def effective_fraction(self) -> float:
        """Mean number of resident objects of a PE / number of objects (1 for an empty scene)."""
        n_objects = len(self.owners)
        if n_objects == 0:
            return 1.0
        return (n_objects + len(self.replica_objects)) / (self.processors * n_objects)
