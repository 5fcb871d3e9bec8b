"""A scene file as bytes: read whole, and unpacked if its name ends in .gz."""

from __future__ import annotations

import gzip
import zlib
from os import PathLike
from pathlib import Path

from simmpp.common.errors import SceneError
from simmpp.common.files import refuse_special

PACKED = ".gz"
LARGEST_UNPACKED_BYTES = 2**30
"""A kilobyte of gzip may stand for a megabyte; ten million triangles of text are less than this."""
BLOCK_BYTES = 2**20


def kind_of(file: str | PathLike[str]) -> str:
    """What a file is by its name, in small letters: ``obj`` for ``a.obj`` and for ``A.OBJ.gz``."""
    return Path(file).name.lower().removesuffix(PACKED).rpartition(".")[2]


def name_of(file: str | PathLike[str]) -> str:
    """The file's name without what tells its kind: ``a`` for ``a.obj`` and for ``a.obj.gz``."""
    path = Path(file)
    return Path(path.stem).stem if path.suffix.lower() == PACKED else path.stem


def read_whole(file: Path) -> bytes:
    """The bytes of a file, unpacked; SceneError if it can't be read."""
    where = str(file)
    try:
        refuse_special(file)
        return _unpacked(file) if file.suffix.lower() == PACKED else file.read_bytes()
    except EOFError:
        raise SceneError("the gzip file is cut off: its end is missing", where=where) from None
    except (gzip.BadGzipFile, zlib.error) as error:
        raise SceneError(f"not a readable gzip file: {error}", where=where) from None
    except (OSError, ValueError) as error:  # a null byte in the name is a ValueError
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(f"can't read the file: {reason}", where=where) from None


def _unpacked(file: Path) -> bytes:
    """What a gzip file holds, taken in blocks, so that a bomb is found before it goes off."""
    content = bytearray()
    with gzip.open(file) as stream:
        while block := stream.read(BLOCK_BYTES):
            content += block
            if len(content) > LARGEST_UNPACKED_BYTES:
                problem = f"unpacks to more than {LARGEST_UNPACKED_BYTES} bytes: unpack it first"
                raise SceneError(problem, where=str(file))
    return bytes(content)
