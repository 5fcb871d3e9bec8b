"""What of a scene is to be traced: samples, depth, kinds of rays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from simmpp.common.validate import require_whole, require_word

Samples = Literal["centres", "corners"]


@dataclass(frozen=True)
class Picture:
    """Settings of one picture.

    ``centres`` takes one primary ray through each of resolution x resolution pixel centres,
    ``corners`` one through each of the (resolution + 1) x (resolution + 1) pixel corners, as the
    SPD's testing procedures ask; the outermost edges of the picture lie at +-tan(angle / 2).
    """

    resolution: int = 512
    samples: Samples = "centres"
    max_depth: int = 5
    """Depth of the deepest ray; the eye ray has depth 1."""
    shadows: bool = True
    reflection: bool = True
    refraction: bool = True

    def __post_init__(self) -> None:
        require_whole("resolution", self.resolution, 1)
        require_whole("max_depth", self.max_depth, 1)
        require_word("samples", self.samples, get_args(Samples))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of primary rays."""
        n = self.resolution + (1 if self.samples == "corners" else 0)
        return n, n
