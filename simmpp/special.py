"""Files that must not be opened: a named pipe waits for a writer, a device may never end."""

from __future__ import annotations

import errno
import os


def refuse_special(path: str | os.PathLike[str]) -> None:
    """Raise OSError if ``path`` is neither a file nor a folder; no such file is fine."""
    if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
        raise OSError(errno.EINVAL, "expected a regular file", os.fspath(path))
