"""Who owns an object, who else holds a replica of it, and who starts with which pixel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.quantities import Share, Size
from simmpp.common.strict import declared, integer, mistake
from simmpp.common.validate import MOST_COUNT
from simmpp.placement.dealing import OF_HOMES as OF_HOMES
from simmpp.placement.dealing import Cells as Cells
from simmpp.placement.dealing import PixelRule
from simmpp.placement.dealing import Pixels as Pixels
from simmpp.placement.rooms import (
    AS_FRACTION,
    FILL,
    OF_A_CAPACITY,
    Capacity,
    CapacityBytes,
    Escape,
    Flow,
    Part,
    Room,
    Transient,
    Wish,
)
from simmpp.placement.rounds import BARRIER, RoundRule, Tallies

# --- cutting a row of things into near-equal parts ---


def cut(n: int, parts: int) -> NDArray[np.int32]:
    """The part of each of n things in a row, cut at floor(i n / parts): (n,) int32."""
    cuts = np.arange(parts + 1, dtype=np.int64) * n // parts
    return np.repeat(np.arange(parts, dtype=np.int32), np.diff(cuts))


Owners = Literal["bisection", "morton", "round_robin", "random", "used"]
Residents = Literal["random", "nearest", "hot", "used"]


@declared
class Memory:
    """What fits into the memory of one PE."""

    fraction: Part = Fraction(1, 10)
    """Share x of all N objects that is resident on each PE: max(own, floor(x N + 1/2)) objects.
    `fill`, with a capacity: as many as it leaves room for beside rays (25% or more) and buffers."""
    bytes: Size | None = None
    """The other way to say it: room for resident objects, in place of the fraction."""
    residents: Residents = "random"
    """Which objects are resident besides a PE's own: `hot`, most used in a coarse pre-pass; `used`,
    most used there by the PE's own pixels, for their size."""
    transient: Transient = 0
    """Fetched objects kept besides the resident ones (least recently used leaves): a number; a
    share of all N, rounded like the fraction's; `x`, the fraction's share (with bytes, as many as
    are resident in the mean); or room for them in bytes. The replicated scene fetches none."""
    hot: Share = Fraction(0)
    """Share of the objects, those most used for their size in a coarse pre-pass, that come first on
    every PE; they count as residents."""
    capacity: CapacityBytes = None
    """All memory of one PE: objects, rays, buffers. `least` is the least with which a policy runs;
    `none`: as much as it takes. With one, pixels are started as there is room for their rays."""
    flow: Flow = "credits"
    """With a capacity: `credits`, a PE sends rays only where there is room for them; `none`, the
    capacity is only compared with what is held."""
    escape: Escape = "fetch"
    """With credits, what a PE does that can't go on: it fetches the object of its oldest ray into
    room of its own; `none`: it waits, perhaps for ever."""
    buffers: Wish = Fraction(1, 4)
    """With credits, room for rays that arrive: a share of the capacity that permanent parts leave,
    or a size for all senders together."""
    fetch: Wish = Fraction(1, 4)
    """Likewise, room for objects that are fetched: asked for, in use, or kept."""

    if TYPE_CHECKING:  # arguments take more than fields hold

        def __init__(
            self,
            fraction: Fraction | float | str = ...,
            bytes: int | str | None = ...,
            residents: Residents = ...,
            transient: Fraction | int | str | Room = ...,
            hot: Fraction | float | str = ...,
            capacity: int | str | None = ...,
            flow: Flow = ...,
            escape: Escape = ...,
            buffers: Fraction | int | str = ...,
            fetch: Fraction | int | str = ...,
        ) -> None: ...

    @property
    def fills(self) -> bool:
        """Replicas take what the capacity leaves."""
        return self.bytes is None and self.fraction == FILL

    @property
    def share(self) -> Fraction:
        """The fraction; 0, a PE's own objects, where replicas fill what is left."""
        return Fraction(0) if isinstance(self.fraction, str) else self.fraction

    @property
    def kept(self) -> Fraction | int | Literal["x"]:
        """The transient share or number of objects; ``x`` only where no fraction says which."""
        if isinstance(self.transient, Room):
            return 0
        if self.transient == AS_FRACTION and self.bytes is None and not self.fills:
            return self.share
        return self.transient

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, given: object) -> object:
        """Of what users write; Python's ``replace`` always passes both."""
        if isinstance(given, dict) and "fraction" in given and given.get("bytes") is not None:
            raise mistake("expected fraction or bytes, got both")
        return given

    @model_validator(mode="after")
    def _leaves_room_for_rays(self) -> Memory:
        wishes = {"buffers": self.buffers, "fetch": self.fetch}
        shares = {key: wish for key, wish in wishes.items() if isinstance(wish, Fraction)}
        if sum(shares.values()) >= 1:
            said = " and ".join(f"{key} {float(wish):.0%}" for key, wish in shares.items())
            raise mistake(f"{said} leave no room for rays: expected less than 100% together")
        return self

    @property
    def kept_bytes(self) -> int:
        """Room for what is kept of what was fetched; 0 where a number of objects says it."""
        return self.transient.bytes if isinstance(self.transient, Room) else 0

    @property
    def bounds(self) -> Capacity | None:
        """A PE's whole memory, if it ends."""
        if self.capacity is None:
            return None
        return Capacity(self.capacity, self.flow, self.escape, self.buffers, self.fetch)

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if self.bytes is not None:
            del plain["fraction"]
        if not self.hot:
            del plain["hot"]
        if self.capacity is None:
            plain = {key: value for key, value in plain.items() if key not in OF_A_CAPACITY}
        return plain


@declared
class PlacementRules:
    """How owners and pixels are chosen."""

    owners: Owners = "bisection"
    """How objects are dealt to their owners; `used`: to the PE whose pixels use them most in a
    coarse pre-pass."""
    pixels: PixelRule = "blocks"
    """How pixels are dealt to the PEs that start them. In turn: pixels (interleaved), rows, or
    squares of so many pixels along each side (cells). Rays of tables that have a home: with its
    owner (home), or those beyond n0 / nb in turn where it is resident as well (home_spread)."""
    islands: Annotated[int, *integer(1, MOST_COUNT)] = 1
    """Equal parts of the machine, PEs in a row, that own the whole scene each and send one another
    nothing; pixels are dealt over all PEs. As many as PEs: the replicated scene."""
    rounds: RoundRule = BARRIER
    """Of tables whose rays come in rounds, when the next one begins: when all PEs know that the one
    before is over, or with that of so many rounds before (window)."""
    tallies: Tallies = "reduce"
    """Of tables whose objects have results, what becomes of what tests deposit: every PE keeps a
    copy, which are added up in the end (reduce); it is sent to the owner in batches (send); nothing
    (none)."""

    @model_validator(mode="after")
    def _owners_come_first(self) -> PlacementRules:
        if self.owners == "used" and self.pixels in OF_HOMES:
            problem = f"pixels: {self.pixels} starts rays with the owner, and owners: used makes"
            raise mistake(f"{problem} owners of those who start them: expected one of both")
        return self

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        for name in ("islands", "rounds", "tallies"):
            if getattr(self, name) == getattr(PlacementRules, name):
                del plain[name]
        return plain


def island_of(rules: PlacementRules, processors: int) -> int:
    """PEs of an island.

    Raises ConfigError, whose place is the key, if the islands are not equal.
    """
    if processors % rules.islands:
        expected = f"expected a divisor of {processors}, the number of PEs"
        raise ConfigError(f"value {rules.islands}: {expected}", where="placement.islands")
    return processors // rules.islands


Ranking = Callable[[int], NDArray[np.int32]]
"""All objects that a PE does not own, the first to be replicated first."""


@dataclass(frozen=True, eq=False)
class Filling:
    """Replicas that take what a capacity leaves; how much that is depends on the policy."""

    ranking: Ranking
    keeps_as_many: bool = False
    """As many fetched objects are kept as are resident in the mean (``transient: x``)."""


@documented
@dataclass(frozen=True, eq=False)
class Placement:
    """One draw of owners, residents and pixels for a number of PEs."""

    processors: int
    """Number of PEs, nb."""
    owners: NDArray[np.int32]
    """(N,) int32: the PE that owns each object; with islands of each, counted from its first PE."""
    replica_offsets: NDArray[np.int64]
    """(nb + 1,) int64: PE k holds replicas of
    replica_objects[replica_offsets[k]:replica_offsets[k + 1]] besides the objects it owns."""
    replica_objects: NDArray[np.int32]
    """(replicas,) int32 object ids."""
    transient: int
    """Number of fetched objects that a PE's transient memory holds."""
    pixel_pes: NDArray[np.int32]
    """(n0,) int32: the PE that each primary ray starts on."""
    transient_bytes: int = 0
    """Bytes of fetched objects that it holds, where a size says so; else 0."""
    islands: int = 1
    """Equal parts of the machine that own the whole scene each."""
    capacity: Capacity | None = None
    """All memory of one PE; None: as much as it takes."""
    filling: Filling | None = None
    """Replicas that take what the capacity leaves (``memory.fraction: fill``), where there are none
    yet: :func:`~simmpp.engine.filling.filled` deals them."""
    window: int = 1
    """Rounds of rays that may be there together."""
    tallies: Tallies = "reduce"
    """What becomes of what tests deposit."""

    @property
    def island(self) -> int:
        """PEs of an island: PE k is in number k // island, at place k % island."""
        return self.processors // self.islands

    @property
    def effective_fraction(self) -> float:
        """Mean number of resident objects of a PE / number of objects (1 for an empty scene)."""
        n_objects = len(self.owners)
        if n_objects == 0:
            return 1.0
        n_owned = self.islands * n_objects
        return (n_owned + len(self.replica_objects)) / (self.processors * n_objects)
