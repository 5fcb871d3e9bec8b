"""Options that set one key of a configuration, as ``--set`` would.

They are named before anything heavy is imported: what they set is worked out with the overrides.
"""

from __future__ import annotations

from typing import NamedTuple


class ShortCut(NamedTuple):
    """What a user typed for one key."""

    option: str
    """Such as ``--fraction``."""
    key: str
    """Such as ``memory.fraction``."""
    texts: tuple[str, ...]
    """A value, or values with commas between them, for each time that the option is there."""
    is_swept: bool = False
    """The values are those of an axis, but where the key itself takes several."""
