"""How an advice is told on a terminal, and what is written of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.progress import Progress, TaskID

from simmpp.commands.parts.tables import texts
from simmpp.commands.parts.terminal import notice, progress_bars, say, wrote
from simmpp.common.files import write_csv
from simmpp.common.yamlfile import written
from simmpp.config.advice import AdviseSettings
from simmpp.config.config import Config
from simmpp.report.advice.figures import advice_figures
from simmpp.report.advice.page import write_advice_page
from simmpp.studies.advise.advice import Advice
from simmpp.studies.advise.candidates import setups_of, sizes_of
from simmpp.studies.advise.running import Watcher
from simmpp.studies.advise.table import COLUMNS, FILE


class _Bars(Watcher):
    """Draws a bar for tracing and counts simulations."""

    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tracing: TaskID | None = None
        self._simulating: TaskID | None = None

    def tracing(self, done: int, total: int) -> None:
        """Move the bar."""
        if self._tracing is None:
            self._tracing = self._bars.add_task("tracing rays", total=total)
        self._bars.update(self._tracing, completed=done, total=total)

    def simulated(self, runs: int) -> None:
        """Count."""
        if self._simulating is None:
            self._simulating = self._bars.add_task("simulating", total=None)
        self._bars.update(self._simulating, description=f"simulating: {runs} runs")

    def notice(self, text: str) -> None:
        """Show it."""
        notice(text)


@contextmanager
def advice_bar() -> Iterator[Watcher]:
    """Who tells the user how it gets on."""
    with progress_bars() as bars:
        yield _Bars(bars)


def print_advice(advice: Advice) -> None:
    """The sentences, and the settings to run."""
    for sentence in advice.sentences:
        say(sentence)
    if advice.settings:
        say("\nTo run it, over the configuration:\n")
        say("".join(f"    {line}\n" for line in advice.settings.splitlines()))


def write_advice(advice: Advice, out: Path, *, figures: bool) -> None:
    """The table and the page, and if wanted the pictures."""
    write_csv(advice.rows, COLUMNS, out / FILE)
    wrote(out / FILE, write_advice_page(advice, advice.places, out))
    if figures:
        from simmpp.plot.matplotlib_panels import draw  # half a second, which few want

        for _, figure in advice_figures(advice, advice.places):
            for panels in figure.plates.values():
                wrote(*draw(panels, out / figure.stem))


def list_candidates(config: Config) -> None:
    """What there is to choose from for a question of so many numbers of nodes."""
    asked = config.settings.advise or AdviseSettings()
    setups = setups_of(config, asked, len(sizes_of(config)))
    rows = [(setup.name, _keys(setup.keys)) for setup in setups]
    say(texts(("candidate", "sets"), rows, whole=1))


def _keys(keys: object) -> str:
    return written(keys).strip("{}")
