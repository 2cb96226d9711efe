"""Files of the cache whose names say what they come from: a digest of all of it, and of rulec.

Such a file is never out of date. What cannot be kept, or is not as it was written, or may have been
written by somebody else, is not there.
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
from rulec.files import is_own
from rulec.version import __version__

_QUICKLY = 1
"""How hard it is tried to write little."""


@dataclass(frozen=True, slots=True)
class KeptBytes:
    """Files of one ``kind``, their ending: at most ``most``, the ones longest unused go first."""

    kind: str
    most: int

    @property
    def can_be(self) -> bool:
        """Tell whether any may be kept, and there is a folder for them."""
        return is_keeping() and usable_folder() is not None

    def key(self, *parts: str) -> str:
        """The name for what comes from these texts, and from this version of rulec."""
        seen = sha256(f"{__version__}\0{program_digest()}\0{self.kind}".encode())
        for part in parts:
            data = part.encode("utf-8", "surrogatepass")
            seen.update(f"\0{len(data)}\0".encode())
            seen.update(data)
        return seen.hexdigest()

    def recall(self, key: str) -> bytes | None:
        """What was kept under a key; None if that is not known."""
        folder = usable_folder() if is_keeping() else None
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
        """Keep something under each key, if that is possible."""
        folder = usable_folder() if is_keeping() else None
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
    """What tells whether a file is as it was written, and under its own name."""
    return sha256(key.encode() + packed).digest()
