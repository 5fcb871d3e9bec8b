"""Where what can be made again is kept: workloads, compiled code, words for completion."""

from __future__ import annotations

import os
from pathlib import Path

from platformdirs import user_cache_path


def cache_folder() -> Path:
    """SIMMPP_CACHE, or a folder in XDG_CACHE_HOME or the user's."""
    chosen, xdg = os.environ.get("SIMMPP_CACHE"), os.environ.get("XDG_CACHE_HOME")
    if chosen:
        return Path(chosen)
    return Path(xdg) / "simmpp" if xdg else user_cache_path("simmpp", appauthor=False)
