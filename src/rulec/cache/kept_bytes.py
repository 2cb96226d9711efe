"""Files of the cache, named by a digest of all their sources and of rulec.

So a file is never out of date. If an entry cannot be cached, was damaged, or may have been written
by someone else, it counts as missing.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from rulec.cache.cache_folder import program_digest, tidy, usable_folder, write_own
from rulec.cache.keeping import is_keeping
from rulec.files.written_files import is_own

_QUICKLY = 1
"""The compression level of zlib: fast rather than small."""


@dataclass(frozen=True, slots=True)
class KeptBytes:
    """Up to ``most`` files with the ending ``kind``; the least recently used are removed first.

    They are kept ``always``, or only by the command line.
    """

    kind: str
    most: int
    always: bool = False

    @property
    def can_be(self) -> bool:
        """Whether entries may be cached, and there is a folder for them."""
        return self._folder is not None

    @property
    def _folder(self) -> Path | None:
        return usable_folder() if self.always or is_keeping() else None

    def key(self, *parts: str) -> str:
        """The name of the entry made from these texts by this version of rulec."""
        seen = sha256(f"{program_digest()}\0{self.kind}".encode())
        for part in parts:
            data = part.encode("utf-8", "surrogatepass")
            seen.update(f"\0{len(data)}\0".encode())
            seen.update(data)
        return seen.hexdigest()

    def recall(self, key: str) -> bytes | None:
        """The data cached under a key; None if there is none."""
        folder = self._folder
        if folder is None:
            return None
        path = self._path(folder, key)
        with suppress(OSError, ValueError, zlib.error):
            with path.open("rb") as stream:
                if not is_own(os.fstat(stream.fileno())):
                    return None
                digest, packed = stream.read(sha256().digest_size), stream.read()
            if digest == _digest(key, packed):
                os.utime(path)
                return zlib.decompress(packed)
        return None

    def keep(self, contents: Mapping[str, bytes]) -> None:
        """Cache data under each key, if possible."""
        folder = self._folder
        if folder is None or not contents:
            return
        with suppress(OSError, ValueError):
            for key, data in contents.items():
                packed = zlib.compress(data, _QUICKLY)
                write_own(self._path(folder, key), _digest(key, packed) + packed)
            tidy(folder, f".{self.kind}", self.most)

    def _path(self, folder: Path, key: str) -> Path:
        return folder / f"{key}.{self.kind}"


def _digest(key: str, packed: bytes) -> bytes:
    """A digest that shows whether a file is unchanged and has its own name."""
    return sha256(key.encode() + packed).digest()
