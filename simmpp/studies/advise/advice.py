"""An advice: what is advised, and all that it was found from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING

from simmpp.common.documented import documented
from simmpp.common.files import Row
from simmpp.config.advice import AdviseSettings
from simmpp.config.config import Config
from simmpp.studies.advise.candidates import Candidate
from simmpp.studies.advise.memory_map import Place
from simmpp.studies.advise.sensitivity import Sensitivity
from simmpp.studies.advise.verdict import Contest, Verdict
from simmpp.sweeps.intervals import MeanInterval, of_logarithms

if TYPE_CHECKING:
    import pandas

NODE_SECONDS = "node-seconds"


@documented
@dataclass(eq=False)
class Advice:
    """What is advised, and all that it was found from."""

    config: Config
    """That asks."""
    scene: str
    """How the workload is called."""
    candidates: list[Candidate]
    """Also those that do not fit."""
    bounds: list[int]
    """Of those that fit, in ps."""
    contest: Contest
    """The race, with all that was measured."""
    verdict: Verdict
    """What came out of it."""
    sensitivity: Sensitivity = field(default_factory=Sensitivity)
    """What it hangs on."""
    runs: int = 0
    """Simulations of the race."""
    further_runs: int = 0
    """Simulations with other constants."""
    left_out: str = ""
    """Of which part of the picture it is, if all of it was too large."""
    broken_off: str = ""
    """What ended it before it was done, if anything did."""
    interrupt: KeyboardInterrupt | None = None
    """Ctrl-C, if it was that."""
    beyond_bytes: int = 0
    """By how much more than a node has the one advised would hold without credits."""
    least_nodes: Candidate | None = None
    """Where nothing fits, what would with more nodes."""
    places: list[Place] = field(default_factory=list)
    """The map of memory and nodes, if it was asked for."""

    sentences: list[str] = field(default_factory=list)
    """What to use, how sure that is, what comes next, what does not fit, what it hangs on."""
    settings: str = ""
    """What to set over the configuration to run it, in YAML."""
    rows: list[Row] = field(default_factory=list)
    """As advise.csv: one for each candidate."""

    @property
    def table(self) -> pandas.DataFrame:
        """The rows; what isn't known is missing."""
        import pandas  # takes half a second

        return pandas.DataFrame(self.rows).replace("", pandas.NA)

    @property
    def asked(self) -> AdviseSettings:
        """The question."""
        return self.config.settings.advise or AdviseSettings()

    @cached_property
    def fitting(self) -> list[Candidate]:
        """Candidates that fit, by their numbers in the race."""
        return [candidate for candidate in self.candidates if candidate.fits]

    @property
    def chosen(self) -> Candidate | None:
        """What is advised, if anything is."""
        number = self.verdict.chosen
        return None if number is None else self.fitting[number]

    def makespan_ps(self, number: int) -> MeanInterval:
        """Mean and 95 % interval of one that was run."""
        costs, weight = self.contest.race.costs[number], weight_of(self.asked, self.fitting[number])
        makespans = [cost / weight for cost in costs.values()]
        if not self.fitting[number].is_drawn:
            return MeanInterval(*(makespans[0],) * 3)
        return of_logarithms(makespans)

    def others(self) -> list[int]:
        """All that came to an end but the one that is advised, the best first."""
        race = self.contest.race
        ended = [n for n in race.costs if n != self.verdict.chosen and isfinite(race.mean(n))]
        return sorted(ended, key=lambda n: (race.mean(n), self.fitting[n].order))


def weight_of(asked: AdviseSettings, candidate: Candidate) -> int:
    """What a makespan is multiplied by for the goal."""
    return candidate.processors if asked.goal == NODE_SECONDS else 1
