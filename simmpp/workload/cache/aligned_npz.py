"""npz files whose arrays can be used in place: several processes share one copy in memory.

An uncompressed member of a zip archive is its npy file as it is, but numpy lets it begin anywhere.
Here each begins at a multiple of 64 bytes, by padding in the extra field of its header, as
Android's zipalign does. Any npz reader reads the result.
"""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

ALIGNMENT = 64
"""Bytes; a cache line, and what npy files align their data to."""
PADDING_ID = 0xD935
"""Extra field of zipalign: readers skip it."""
ZIP64_BYTES, LOCAL_BYTES = 20, 30
"""Of the extra field for sizes above 4 GiB, and of a member's header without name and extra."""
MOST_HEADER_BYTES = 4096
"""Of an npy file, which says a type and a shape."""
EPOCH = (1980, 1, 1, 0, 0, 0)
"""The earliest time that a zip archive can say, so that equal arrays make equal files."""


def write_aligned(file: IO[bytes], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write an uncompressed npz; each array's data begins at a multiple of 64 bytes."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            member = zipfile.ZipInfo(f"{name}.npy", EPOCH)
            begins = file.tell() + LOCAL_BYTES + len(member.filename.encode()) + ZIP64_BYTES + 4
            padding = -begins % ALIGNMENT
            member.extra = struct.pack("<HH", PADDING_ID, padding) + bytes(padding)
            with archive.open(member, "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)


def map_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an uncompressed npz, read-only and backed by the file itself.

    Each is checked against the archive's CRC-32. One that isn't aligned is copied.
    Raises OSError, ValueError or zipfile.BadZipFile for a file that isn't such an archive.
    """
    content = np.memmap(path, np.uint8, mode="r")
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
    return {
        member.filename.removesuffix(".npy"): _array(_member(content, member)) for member in members
    }


def _member(content: NDArray[np.uint8], member: zipfile.ZipInfo) -> NDArray[np.uint8]:
    """The bytes of a member, if they are what was written."""
    if member.compress_type != zipfile.ZIP_STORED:
        raise ValueError(f"{member.filename}: expected an uncompressed member")
    at = member.header_offset
    lengths = (content[at + 26 : at + 28], content[at + 28 : at + LOCAL_BYTES])  # name, extra field
    at += LOCAL_BYTES + sum(int.from_bytes(length.tobytes(), "little") for length in lengths)
    data = np.asarray(content[at : at + member.file_size])
    if zlib.crc32(data.data) != member.CRC:
        raise ValueError(f"{member.filename}: damaged, its checksum does not fit")
    return data


def _array(data: NDArray[np.uint8]) -> NDArray[Any]:
    """The array of an npy file."""
    head = io.BytesIO(data[:MOST_HEADER_BYTES].tobytes())
    version = np.lib.format.read_magic(head)
    read = np.lib.format.read_array_header_1_0
    if version != (1, 0):
        read = np.lib.format.read_array_header_2_0
    shape, fortran, dtype = read(head)
    if (fortran and len(shape) > 1) or dtype.hasobject:
        raise ValueError("expected an array in C order, without objects")
    array = data[head.tell() :].view(dtype).reshape(shape)
    return array if array.flags.aligned else array.copy()
