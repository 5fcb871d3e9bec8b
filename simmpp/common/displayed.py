"""What notebooks show as a table and a picture, and scripts plot."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from simmpp.common.modules import NOTEBOOK

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Displayed:
    """Something that shows itself.

    How is said above all layers, by a module that is found by its name: what decides results must
    not depend on what draws them.
    """

    def plot(self) -> Figure:
        """A picture of it, as a figure of matplotlib."""
        return _notebook().plot(self)

    def _repr_html_(self) -> str:
        """Called by notebooks."""
        return _notebook().html(self)


def _notebook() -> Any:
    return import_module(NOTEBOOK)
