"""Files that commands write: their folders are checked before hours of work, not after."""

from __future__ import annotations

import os
from pathlib import Path

from simmpp.errors import ConfigError


def writable(path: Path | None, option: str, suffix: str = "") -> None:
    """Raise ConfigError unless a file so called can be written at ``path``; None is fine."""
    if path is None:
        return
    if not path.name.lower().endswith(suffix):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file {suffix}")
    if path.is_dir():
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file, it is a folder")
    if not path.parent.is_dir():
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file in an existing folder")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file that can be written")


def folder(path: Path | None, option: str) -> None:
    """Make the folder at ``path``; ConfigError if that can't be; None is fine."""
    if path is None:
        return
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ConfigError(f"{option}: value {str(path)!r}: can't make it: {reason}") from None
    if not os.access(path, os.W_OK):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a folder that can be written")
