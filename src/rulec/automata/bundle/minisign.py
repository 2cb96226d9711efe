"""Signatures in minisign's format: Ed25519 over a BLAKE2b digest, in a file beside the signed one.

The format is described at https://jedisct1.github.io/minisign/: the second line of a key file or
signature file is Base64 of two letters, a key number, and the key or the signature. A second
signature covers the first one and the trusted comment. Only signatures of a digest (``ED``) are
accepted.
"""

from __future__ import annotations

from base64 import b64decode
from dataclasses import dataclass
from hashlib import blake2b

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
