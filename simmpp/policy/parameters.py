"""What a user sets of a policy: its name and the numbers that its two rules read."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, get_args

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown
from simmpp.common.validate import MOST_COUNT, require_whole, require_word
from simmpp.machine.limits import CLOCK_LIMIT_PS

LoadInfo = Literal["piggyback", "exact", "none"]


@dataclass(frozen=True)
class PolicyParameters:
    """One policy of a run. A rule that a policy does not have ignores its parameters."""

    name: str
    """A key of ``POLICIES``: object, ray, concurrent or replicated."""
    label: str = ""
    """Name in tables and rows; the policy's name when empty."""
    min_load: Fraction | int = Fraction(12, 100)
    """The paper's minimal load: a Fraction is a share of n0 / nb, an int a number of rays."""
    batch: int = 256
    """Rays that wait for one owner before they are sent, unless there is nothing else to do."""
    ask_at_least: int = 32
    """The paper's sufficient count: rays that wait for an object before it is asked for."""
    load_info: LoadInfo = "piggyback"
    """How a PE knows the load of another: from headers (the paper), exactly, or not at all."""
    refresh_ps: int | None = None
    """With piggyback: send the own load to partners that were sent nothing for that long. Policies
    whose send rule reads no load ignore it, as they ignore load_info."""
    merge_requests: bool = True
    """One request per missing object in flight; False sends one request per waiting ray."""

    def __post_init__(self) -> None:
        require_whole("batch", self.batch, 1)
        require_whole("ask_at_least", self.ask_at_least, 1)
        require_word("load_info", self.load_info, get_args(LoadInfo))
        if self.refresh_ps is not None:
            require_whole("refresh_ps", self.refresh_ps, 0, CLOCK_LIMIT_PS)
        least = self.min_load
        if not isinstance(least, int | Fraction) or not 0 <= least <= MOST_COUNT:
            expected = f"a Fraction or an integer from 0 to {MOST_COUNT}"
            raise ConfigError(f"min_load: value {shown(least)}: expected {expected}")

    @property
    def title(self) -> str:
        """The label, or the name where none was given."""
        return self.label or self.name
