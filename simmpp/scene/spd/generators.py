"""The table of scene generators: the Standard Procedural Databases, by name.

Source: E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. The
texts are byte for byte those of SPD 3.x (on platforms whose libm agrees to the last printed digit).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from simmpp.common.errors import ConfigError
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Scene
from simmpp.scene.spd import balls, gears, jacks, lattice, mountain, rings, tetra, tree

MAX_OBJECTS = 1_000_000
"""Above, the text alone takes hundreds of megabytes; ESTIMATE of what is still useful."""


@dataclass(frozen=True)
class Generator:
    """One of the SPD's scenes, of any size."""

    name: str
    nff: Callable[[int], str]
    """Size -> the file's text."""
    objects: Callable[[int], int]
    """Size -> number of objects, known without generating them."""
    default_size: int
    """The SPD's own; about 10^4 objects but for jacks."""
    aliases: tuple[str, ...] = ()
    largest: int | None = None
    """Largest size with a defined result; None where only MAX_OBJECTS limits it."""
    why_largest: str = ""

    @property
    def max_size(self) -> int:
        """The largest size that :meth:`check` accepts."""
        if self.largest is not None:
            return self.largest
        size = 1
        while self.objects(size + 1) <= MAX_OBJECTS:
            size += 1
        return size

    def check(self, size: int) -> None:
        """Raise ConfigError unless ``size`` can be generated."""
        if isinstance(size, bool) or not isinstance(size, int):
            raise ConfigError(f"the size of {self.name} must be a whole number, got {size!r}")
        if size < 1:
            raise ConfigError(f"the size of {self.name} must be at least 1, got {size}")
        if size <= self.max_size:
            return
        problem = f"the size of {self.name} must be at most {self.max_size}, got {size}"
        if self.why_largest:
            raise ConfigError(f"{problem}: {self.why_largest}")
        # 10^4 levels of a recursive scene have more objects than digits worth printing.
        count = f"{self.objects(size):,} objects" if size < 64 else "far too many objects"
        raise ConfigError(f"{problem}: {count}, the limit is {MAX_OBJECTS:,}")


GENERATORS: dict[str, Generator] = {
    generator.name: generator
    for generator in (
        Generator("balls", balls.nff, balls.objects, 4, aliases=("sphereflake",)),
        Generator("gears", gears.nff, gears.objects, 4, aliases=("gear",)),
        Generator("jacks", jacks.nff, jacks.objects, 1),
        Generator("lattice", lattice.nff, lattice.objects, 12),
        Generator(
            "mountain",
            mountain.nff,
            mountain.objects,
            6,
            aliases=("mount",),
            largest=7,
            why_largest="beyond it the SPD's hash shifts by a negative count, undefined in C",
        ),
        Generator("rings", rings.nff, rings.objects, 7, aliases=("ring",)),
        Generator("tetra", tetra.nff, tetra.objects, 6),
        Generator("tree", tree.nff, tree.objects, 11),
    )
}


def find_generator(name: str) -> Generator:
    """The generator of that name or alias; ConfigError lists what is known."""
    for generator in GENERATORS.values():
        if name == generator.name or name in generator.aliases:
            return generator
    raise ConfigError(f"unknown SPD scene {name!r}; known: {', '.join(GENERATORS)}")


def nff(name: str, size: int | None = None) -> str:
    """NFF text of the scene ``name`` at ``size`` (default: the SPD's own size)."""
    generator = find_generator(name)
    size = generator.default_size if size is None else size
    generator.check(size)
    return generator.nff(size)


def load_spd(name: str, size: int | None = None) -> Scene:
    """The scene of that text, read as a file would be: both ways in are one scene."""
    generator = find_generator(name)
    label = f"{generator.name}:{generator.default_size if size is None else size}"
    return read_nff(nff(name, size), name=label, where=label)


def known_names() -> list[str]:
    """All names and aliases, as ``scene.spd`` takes them."""
    return [name for g in GENERATORS.values() for name in (g.name, *g.aliases)]
