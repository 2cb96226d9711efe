"""Signatures in minisign's format: Ed25519 over a BLAKE2b digest, in a file beside what is signed.

The format is minisign's own (https://jedisct1.github.io/minisign/): of both files the second line
is Base64 of two letters, a key's number and the key or the signature; a second signature is over
the first one and the comment that is trusted. Only signatures of a digest (``ED``) are taken.
"""

from __future__ import annotations

from base64 import b64decode
from dataclasses import dataclass
from hashlib import blake2b

_KEY, _DIGESTED = b"Ed", b"ED"
_TRUSTED = "trusted comment: "


class SignatureFormatError(ValueError):
    """A text that is no public key or no signature of minisign's."""


@dataclass(frozen=True, slots=True)
class PublicKey:
    """An Ed25519 key (32 bytes) and its number (8 bytes)."""

    number: bytes
    key: bytes


@dataclass(frozen=True, slots=True)
class DetachedSignature:
    """A signature (64 bytes) by the key of a number, and that of it and its comment together."""

    number: bytes
    signature: bytes
    comment: str
    of_comment: bytes


def public_key(text: str) -> PublicKey:
    """The key of a file, or of its second line alone. Raises SignatureFormatError."""
    lines = text.split()
    if not lines:
        raise SignatureFormatError("it is empty")
    kind, number, key = _parts(lines[-1], 32)
    if kind != _KEY:
        raise SignatureFormatError("it is no Ed25519 key")
    return PublicKey(number, key)


def detached_signature(text: str) -> DetachedSignature:
    """The signature of a file. Raises SignatureFormatError."""
    lines = text.splitlines()
    if len(lines) != 4 or not lines[2].startswith(_TRUSTED):
        raise SignatureFormatError("it has not the four lines of a signature")
    kind, number, signature = _parts(lines[1], 64)
    if kind != _DIGESTED:
        raise SignatureFormatError("it is not of a digest; sign without `-l`")
    of_comment = _decoded(lines[3])
    if len(of_comment) != 64:
        raise SignatureFormatError("its comment's signature is not of 64 bytes")
    return DetachedSignature(number, signature, lines[2].removeprefix(_TRUSTED), of_comment)


def _parts(line: str, length: int) -> tuple[bytes, bytes, bytes]:
    data = _decoded(line)
    if len(data) != 10 + length:
        raise SignatureFormatError(f"its Base64 is not of {10 + length} bytes")
    return data[:2], data[2:10], data[10:]


def _decoded(line: str) -> bytes:
    try:
        return b64decode(line, validate=True)
    except ValueError:
        raise SignatureFormatError("it has a line that is not Base64") from None


def has_signed(key: PublicKey, signature: DetachedSignature, data: bytes) -> bool:
    """Tell whether a key has signed some data. Raises ImportError without ``cryptography``."""
    # Native code of 20 MB that is installed on request: only where a signature is asked for.
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
