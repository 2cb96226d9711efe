"""Files of the cache with a JSON value behind its digest.

If a file was damaged, or may have been written by someone else, it counts as missing.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

from rulec.cache.cache_folder import tidy, write_own
from rulec.files.written_files import is_own


def recall_json(path: Path) -> Any:
    """The value in a file, which is marked as used now; None if there is none."""
    with suppress(OSError, ValueError):
        with path.open("rb") as stream:
            if not is_own(os.fstat(stream.fileno())):
                return None
            digest, _, text = stream.read().partition(b"\n")
        if digest == _digest(text):
            os.utime(path)
            return json.loads(text)
    return None


def keep_json(path: Path, value: Any, most: int = 0) -> None:
    """Write a value if possible; keep at most ``most`` files with its ending (0: any number)."""
    with suppress(OSError, ValueError):
        text = json.dumps(value).encode()
        write_own(path, _digest(text) + b"\n" + text)
        if most:
            tidy(path.parent, path.suffix, most)


def _digest(text: bytes) -> bytes:
    return sha256(text).hexdigest().encode()
