"""What of a scene is to be traced: samples, depth, kinds of rays."""

from __future__ import annotations

from typing import Annotated, Literal

from simmpp.common.strict import Switch, declared, integer


@declared
class Picture:
    """Settings of one picture.

    ``centres`` takes one primary ray through each of resolution x resolution pixel centres,
    ``corners`` one through each of the (resolution + 1) x (resolution + 1) pixel corners, as the
    SPD's testing procedures ask; the outermost edges of the picture lie at +-tan(angle / 2).
    """

    resolution: Annotated[int, *integer(1, 16384, "pixels")] = 512
    """Pixels along each side."""
    samples: Literal["centres", "corners"] = "centres"
    """A ray per pixel centre, or per corner (the SPD's rules)."""
    max_depth: Annotated[int, *integer(1, 100)] = 5
    """Depth of the deepest ray that is not a shadow ray; the eye ray has depth 1."""
    shadows: Switch = True
    """Trace shadow rays."""
    reflection: Switch = True
    """Trace reflected rays."""
    refraction: Switch = True
    """Trace refracted rays."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of primary rays."""
        n = self.resolution + (1 if self.samples == "corners" else 0)
        return n, n
