"""The lines of an NFF file, in one of two spellings of numbers.

The SPD writes C's ``%g``, six digits, and so its scenes have no more. Others are written in the
fewest digits that read back as the same 64-bit real. Source: E. Haines, "A Proposal for Standard
Graphics Environments", IEEE CG&A 7(11), 1987, and the NFF description that comes with the SPD.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from simmpp.common.errors import SceneError
from simmpp.scene.nff_words import LARGEST

Triple = Sequence[float]


@dataclass(frozen=True)
class NffText:
    """Lines of NFF whose numbers are spelled one way."""

    number: Callable[[float], str]

    def numbers(self, *values: float) -> str:
        """Values between blanks."""
        return " ".join(map(self.number, values))

    def view(
        self,
        eye: Triple,
        at: Triple,
        up: Triple,
        angle_degrees: float = 45.0,
        hither: float = 1.0,
        resolution: tuple[int, int] = (512, 512),
    ) -> str:
        """The ``v`` block; the defaults are those of most SPD scenes."""
        return (
            "v\n"
            f"from {self.numbers(*eye)}\n"
            f"at {self.numbers(*at)}\n"
            f"up {self.numbers(*up)}\n"
            f"angle {self.number(angle_degrees)}\n"
            f"hither {self.number(hither)}\n"
            f"resolution {resolution[0]} {resolution[1]}\n"
        )

    def background(self, colour: Triple) -> str:
        """A ``b`` line."""
        return f"b {self.numbers(*colour)}\n"

    def light(self, position: Triple, colour: Triple = ()) -> str:
        """An ``l`` line; the SPD never writes the optional colour."""
        return f"l {self.numbers(*position, *colour)}\n"

    def material(
        self,
        colour: Triple,
        kd: float,
        ks: float = 0.0,
        shine: float = 100000.0,
        transmittance: float = 0.0,
        ior: float = 0.0,
    ) -> str:
        """An ``f`` line; the defaults are the SPD's matt surface."""
        return f"f {self.numbers(*colour, kd, ks, shine, transmittance, ior)}\n"

    def sphere(self, centre: Triple, radius: float) -> str:
        """An ``s`` line."""
        return f"s {self.numbers(*centre, radius)}\n"

    def cone(self, base: Triple, base_radius: float, apex: Triple, apex_radius: float) -> str:
        """A ``c`` line, on one line as SPD 3.x writes it."""
        return f"c {self.numbers(*base, base_radius, *apex, apex_radius)}\n"

    def polygon(self, vertices: Iterable[Triple]) -> str:
        """A ``p`` block."""
        lines = [self.numbers(*vertex) + "\n" for vertex in vertices]
        return f"p {len(lines)}\n" + "".join(lines)

    def patch(self, vertices: Iterable[Triple], normals: Iterable[Triple]) -> str:
        """A ``pp`` block: a polygon with a normal per vertex."""
        rows = zip(vertices, normals, strict=True)
        lines = [self.numbers(*vertex, *normal) + "\n" for vertex, normal in rows]
        return f"pp {len(lines)}\n" + "".join(lines)


def _exactly(value: float) -> str:
    """The fewest digits; SceneError for a number that no NFF file may hold."""
    if not abs(value) <= LARGEST:
        raise SceneError(f"the scene has the number {value:g}, NFF's are at most {LARGEST:g}")
    return repr(float(value)).removesuffix(".0")


SPD = NffText("{:g}".format)
EXACT = NffText(_exactly)
