"""The lines of an NFF file, spelled as the SPD spells them: numbers in C's ``%g``, six digits.

Source: E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987, and the
NFF description that comes with the SPD.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

Triple = Sequence[float]


def numbers(*values: float) -> str:
    """Values as C's ``%g`` prints them, between blanks."""
    return " ".join([f"{value:g}" for value in values])


def view(
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
        f"from {numbers(*eye)}\n"
        f"at {numbers(*at)}\n"
        f"up {numbers(*up)}\n"
        f"angle {angle_degrees:g}\n"
        f"hither {hither:g}\n"
        f"resolution {resolution[0]} {resolution[1]}\n"
    )


def background(colour: Triple) -> str:
    """A ``b`` line."""
    return f"b {numbers(*colour)}\n"


def light(position: Triple, colour: Triple = ()) -> str:
    """An ``l`` line; the SPD never writes the optional colour."""
    return f"l {numbers(*position, *colour)}\n"


def material(
    colour: Triple,
    kd: float,
    ks: float = 0.0,
    shine: float = 100000.0,
    transmittance: float = 0.0,
    ior: float = 0.0,
) -> str:
    """An ``f`` line; the defaults are the SPD's matt surface."""
    return f"f {numbers(*colour, kd, ks, shine, transmittance, ior)}\n"


def sphere(centre: Triple, radius: float) -> str:
    """An ``s`` line."""
    return f"s {numbers(*centre, radius)}\n"


def cone(base: Triple, base_radius: float, apex: Triple, apex_radius: float) -> str:
    """A ``c`` line, on one line as SPD 3.x writes it."""
    return f"c {numbers(*base, base_radius, *apex, apex_radius)}\n"


def polygon(vertices: Iterable[Triple]) -> str:
    """A ``p`` block."""
    lines = [numbers(*vertex) + "\n" for vertex in vertices]
    return f"p {len(lines)}\n" + "".join(lines)


def patch(vertices: Iterable[Triple], normals: Iterable[Triple]) -> str:
    """A ``pp`` block: a polygon with a normal per vertex."""
    lines = [
        numbers(*vertex, *normal) + "\n" for vertex, normal in zip(vertices, normals, strict=True)
    ]
    return f"pp {len(lines)}\n" + "".join(lines)
