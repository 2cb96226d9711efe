"""The digest of a compiled rulebook's file: its second line, over all bytes from the third on.

The digest covers the bytes, not their meaning, so checking whether a file is unchanged needs
neither rulec nor JSON: ``tail -n +3 FILE | sha256sum``. It detects damage, not forgery: a person
who changes a file on purpose can change its digest, too.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

from rulec.automata.bundle.bundle_messages import CHANGED_BUNDLE, NO_DIGEST
from rulec.diagnostics import RulecError, SourceLocation

_BEFORE, _AFTER = b'{\n "sha256": "', b'",\n'
_DIGITS = 64


def with_digest(text: str) -> str:
    """The text of a file, an indented JSON object, with a digest added as its first field."""
    rest = text.removeprefix("{\n").encode()
    return b"".join((_BEFORE, _digest(rest), _AFTER, rest)).decode()


def _digest(rest: bytes | memoryview) -> bytes:
    return sha256(rest).hexdigest().encode()


def has_digest(data: bytes) -> bool:
    """Whether a file begins like one with a digest."""
    return data.startswith(_BEFORE)


def check_digest(data: bytes, file: str) -> None:
    """Raise R0410 if a file with a digest has been changed since it was written."""
    end = len(_BEFORE) + _DIGITS
    stated, rest = data[len(_BEFORE) : end], memoryview(data)[end + len(_AFTER) :]
    digest = _digest(rest)
    if stated == digest and data[end : end + len(_AFTER)] == _AFTER:
        return
    raise changed(
        file,
        f"this compiled rulebook has been changed: the SHA-256 of all that follows its second "
        f"line is {digest[:12].decode()}…, but that line has another one",
    )


def changed(file: str, message: str) -> RulecError:
    """R0410, with the command that writes the file again."""
    return CHANGED_BUNDLE.error(SourceLocation(file, 2), message, help=_way_out(file))


def without_digest(file: str, version: int, steps: Iterable[str]) -> RulecError:
    """R0411 for a file of an earlier version, with the command that writes it again."""
    return NO_DIGEST.error(
        SourceLocation(file),
        f"this compiled rulebook is of version {version}, which has no digest, so changes to it "
        "would go unnoticed",
        help=_way_out(file, steps),
    )


def _way_out(file: str, steps: Iterable[str] = ()) -> str:
    path = Path(file)
    # A damaged file does not say reliably which rulebook it was, and its own name may differ.
    words = ["rulec", "compile", "RULEBOOK", *(word for step in steps for word in ("--step", step))]
    command = shlex.join([*words, "-o", str(path.parent)])
    return f"compile it again from its source, a name or a path: `{command}`"
