"""The requirement, if the user sets it, that compiled rulebooks are signed.

The key is in an environment variable, so that child processes require it, too.
"""

from __future__ import annotations

import os
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path

from rulec.automata.bundle.bundle_messages import NO_CRYPTOGRAPHY, NO_KEY, NOT_SIGNED
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


_KEY, _DIGESTED = b"Ed", b"ED"
_TRUSTED = "trusted comment: "


class SignatureFormatError(ValueError):
    """A text that is not a public key or not a signature of minisign."""


@dataclass(frozen=True, slots=True)
class PublicKey:
    """An Ed25519 key (32 bytes) and its number (8 bytes)."""

    number: bytes
    key: bytes


@dataclass(frozen=True, slots=True)
class DetachedSignature:
    """A signature (64 bytes), the number of its key, and the signature over it and its comment."""

    number: bytes
    signature: bytes
    comment: str
    of_comment: bytes


def public_key(text: str) -> PublicKey:
    """The public key in a file's text, or in its second line alone. Raises SignatureFormatError."""
    lines = text.split()
    if not lines:
        raise SignatureFormatError("it is empty")
    kind, number, key = _parts(lines[-1], 32)
    if kind != _KEY:
        raise SignatureFormatError("it is not an Ed25519 key")
    return PublicKey(number, key)


def detached_signature(text: str) -> DetachedSignature:
    """The signature in a file's text. Raises SignatureFormatError."""
    lines = text.splitlines()
    if len(lines) != 4 or not lines[2].startswith(_TRUSTED):
        raise SignatureFormatError("it does not have the four lines of a signature")
    kind, number, signature = _parts(lines[1], 64)
    if kind != _DIGESTED:
        raise SignatureFormatError("it does not sign a digest; sign without `-l`")
    of_comment = _decoded(lines[3])
    if len(of_comment) != 64:
        raise SignatureFormatError("its comment's signature does not have 64 bytes")
    return DetachedSignature(number, signature, lines[2].removeprefix(_TRUSTED), of_comment)


def _parts(line: str, length: int) -> tuple[bytes, bytes, bytes]:
    data = _decoded(line)
    if len(data) != 10 + length:
        raise SignatureFormatError(f"its Base64 does not have {10 + length} bytes")
    return data[:2], data[2:10], data[10:]


def _decoded(line: str) -> bytes:
    try:
        return b64decode(line, validate=True)
    except ValueError:
        raise SignatureFormatError("it has a line that is not Base64") from None


def has_signed(key: PublicKey, signature: DetachedSignature, data: bytes) -> bool:
    """Whether a key has signed some data. Raises ImportError without ``cryptography``."""
    # Native code of 20 MB, installed on request: imported only if a signature is required.
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    verifier = Ed25519PublicKey.from_public_bytes(key.key)
    signed = [
        (signature.signature, blake2b(data).digest()),
        (signature.of_comment, signature.signature + signature.comment.encode()),
    ]
    try:
        for signed_bytes, message in signed:
            verifier.verify(signed_bytes, message)
    except InvalidSignature:
        return False
    return key.number == signature.number
