"""The requirement, if the user sets it, that compiled rulebooks are signed.

The key is in an environment variable, so that child processes require it, too.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rulec.automata.bundle.bundle_messages import NO_CRYPTOGRAPHY, NO_KEY, NOT_SIGNED
from rulec.automata.bundle.minisign import (
    PublicKey,
    SignatureFormatError,
    detached_signature,
    has_signed,
    public_key,
)
from rulec.diagnostics import RulecError, SourceLocation
from rulec.resources import install_command, variable_set

VARIABLE = "RULEC_REQUIRE_SIGNED"
"""The path of a public key, or the key itself; unset or empty if no signature is required."""

_LARGEST = 10_000
_KEY_CHARACTERS = 56


@contextmanager
def in_force(key: str) -> Iterator[None]:
    """Within a block, require that all compiled rulebooks that are read are signed by a key.

    Raises RulecError R0413 if it is not a valid key.
    """
    _key(key)
    with variable_set(VARIABLE, key):
        yield


def check_signed(path: Path, data: bytes) -> None:
    """Refuse a file that is not signed by the required key, if there is one.

    Raises RulecError R0412, R0413 for an invalid key, R0414 without ``cryptography``.
    """
    if not (required := os.environ.get(VARIABLE)):
        return
    key = _key(required)
    beside = path.with_name(f"{path.name}.minisig")
    if not beside.is_file():
        raise _not_signed(path, f"there is no signature beside it: `{beside.name}`")
    try:
        signature = detached_signature(_text(beside))
    except (OSError, ValueError) as problem:
        message = f"`{beside.name}` beside it is not a signature: {problem}"
        raise _not_signed(path, message) from None
    try:
        signed = has_signed(key, signature, data)
    except ImportError:
        raise NO_CRYPTOGRAPHY.error(
            SourceLocation(str(path)),
            "a signature cannot be checked: the package `cryptography` is not installed",
            help=f"`{install_command('signed')}`",
        ) from None
    if not signed:
        raise _not_signed(path, "it is not signed by the required key")


def refuse_source(reference: str | Path) -> None:
    """Raise R0412 for a rulebook that is not compiled if a signature is required."""
    if os.environ.get(VARIABLE):
        raise _not_signed(
            Path(reference), "only compiled rulebooks can be signed, and this is not one"
        )


def _not_signed(path: Path, message: str) -> RulecError:
    return NOT_SIGNED.error(
        SourceLocation(str(path)),
        message,
        help="get the file and its signature from their author, or sign it with "
        "`minisign -S -m FILE`",
    )


def _is_key(text: str) -> bool:
    """Whether a text may be a key itself: Base64 has slashes, too."""
    return text.startswith("RW") and len(text) == _KEY_CHARACTERS


def _key(required: str) -> PublicKey:
    try:
        path = Path(required)
        if (os.sep in required or path.suffix) and not path.exists() and not _is_key(required):
            raise NO_KEY.error(
                SourceLocation(required),
                "there is no such file",
                help="give the path of a key that `minisign -G` made, or its second line",
            )
        return public_key(_text(path) if path.is_file() else required)
    except (OSError, SignatureFormatError, ValueError) as problem:
        raise NO_KEY.error(
            SourceLocation(required),
            f"this is not a public key of minisign: {problem}",
            help="give the path of a key that `minisign -G` made, or its second line",
        ) from None


def _text(path: Path) -> str:
    with path.open("rb") as stream:
        return stream.read(_LARGEST).decode()
