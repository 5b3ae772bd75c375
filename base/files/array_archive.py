"""Archives of numpy arrays and one JSON header, safe to read from anyone.

A zip file whose members are stored, never compressed, with a fixed date: equal content gives
equal bytes, and no member can declare more than the file holds.  Arrays are ``.npy`` of format
1.0, little-endian, C order, without pickles.
"""

import io
import struct
import zipfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..reader_guard import guarded
from .whole_file import whole_file

_DATE = (1980, 1, 1, 0, 0, 0)
_MAX_FILE_BYTES = 4 << 30
_MAX_HEADER_BYTES = 16 << 20
_DAMAGE = (
    zipfile.BadZipFile,
    struct.error,
    NotImplementedError,  # a method or version that zipfile does not know
    RuntimeError,  # an encrypted member
    EOFError,
    ValueError,
    UnicodeError,
)


def write_archive(
    path: Path, header_name: str, header: bytes, arrays: Mapping[str, NDArray[Any]]
) -> None:
    """Write the header and the arrays as `whole_file` does, which may raise its errors."""
    with whole_file(path) as partial, zipfile.ZipFile(partial, "x", zipfile.ZIP_STORED) as archive:
        archive.writestr(zipfile.ZipInfo(header_name, _DATE), header)
        for name, array in arrays.items():
            little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, little, version=(1, 0), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", _DATE), buffer.getbuffer())


@contextmanager
def open_archive(path: Path) -> Generator["ArrayArchive"]:
    """Open an archive for reading; an InputError of the block is about this file.

    Raises `InputError` if the file is missing, not such an archive, or too large, and for whatever
    the block raises (`guarded`).
    """
    with guarded(path, "an archive of arrays", "build the file anew"):
        if not path.is_file():
            raise _error("a file", "no such file")
        size = path.stat().st_size
        if size > _MAX_FILE_BYTES:
            raise _error("at most 4 GiB", f"{size} bytes")
        try:
            archive = zipfile.ZipFile(path)
        except _DAMAGE as error:
            raise _error("a zip archive", f"a damaged or other file ({error})") from error
        with archive:
            members = archive.infolist()
            if any(info.compress_type != zipfile.ZIP_STORED for info in members):
                raise _error("stored members", "compressed ones")
            if sum(max(info.file_size, info.compress_size) for info in members) > size:
                raise _error(f"members within the file's {size} bytes", "larger declared sizes")
            yield ArrayArchive(archive)


def _error(expected: str, got: str) -> InputError:
    return InputError(f"expected {expected}, got {got}; build the file anew")


class ArrayArchive:
    """An archive that is open for reading."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._zip = archive

    def __contains__(self, name: str) -> bool:
        """Whether there is an array of that name."""
        return f"{name}.npy" in self._zip.NameToInfo

    def header(self, name: str) -> bytes:
        """Return the bytes of the header.

        Raises `InputError` if it is missing, damaged or larger than 16 MiB.
        """
        data = self._member(name)
        if len(data) > _MAX_HEADER_BYTES:
            raise _error(f"{name} of at most 16 MiB", f"{len(data)} bytes")
        return data

    def array(self, name: str, dtype: type[Any], dimensions: int) -> NDArray[Any]:
        """Return an array, read-only, of exactly this dtype and number of dimensions.

        Raises `InputError` if it is missing, damaged, or of another dtype, order, or number of
        dimensions.
        """
        stream = io.BytesIO(self._member(f"{name}.npy"))
        try:
            version = np.lib.format.read_magic(stream)
            shape, fortran, got = np.lib.format.read_array_header_1_0(stream)
        except (*_DAMAGE, SyntaxError, TypeError) as error:
            raise _error(f"{name}.npy in .npy format 1.0", "a damaged header") from error
        wanted = np.dtype(dtype).newbyteorder("<")
        if version != (1, 0) or got != wanted or fortran or len(shape) != dimensions:
            raise _error(
                f"{name}.npy with {dimensions} dimensions of {wanted.name}",
                f"{len(shape)} of {got.name}",
            )
        data = stream.getbuffer()[stream.tell() :]
        count = 1
        for length in shape:  # in Python integers, which do not overflow
            count *= int(length)
        if min(shape, default=0) < 0 or count * wanted.itemsize != len(data):
            raise _error(f"{name}.npy of {len(data)} bytes", f"a declared shape of {shape}")
        if dtype is np.bool_ and np.frombuffer(data, dtype=np.uint8).max(initial=0) > 1:
            raise _error(f"{name}.npy of bytes 0 and 1", "others")
        return np.frombuffer(data, dtype=wanted).reshape(shape)

    def _member(self, name: str) -> bytes:
        if name not in self._zip.NameToInfo:
            raise _error(f"a member {name}", "none")
        try:
            return self._zip.read(name)
        except _DAMAGE as error:
            raise _error(f"an intact {name}", f"a damaged one ({error})") from error
