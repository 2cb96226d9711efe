"""Target of signed rulebooks: the book, its signature beside it, the key that is required."""

import base64
from hashlib import blake2b

from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from support.fuzz.mutators import mutated_json, mutated_words
from support.generators.mutated_files import mutated_bytes

KEY_NUMBER = b"numbered"
SIGNS = Ed25519PrivateKey.from_private_bytes(bytes(range(32)))


def signatures(place, pick):
    """Signatures beside compiled rulebooks, and keys; one of them, or neither, is whole."""
    data = place.text("out/lane.json")
    key = "untrusted comment: a key\n" + _base64(b"Ed", KEY_NUMBER, SIGNS.public_key())
    kind = pick.choice((b"ED", b"ED", b"Ed"))
    made = SIGNS.sign(blake2b(data.encode()).digest() if kind == b"ED" else data.encode())
    comment = "today"
    signature = (
        f"untrusted comment: whatever\n{_base64(kind, KEY_NUMBER, made)}"
        f"trusted comment: {comment}\n{_base64(SIGNS.sign(made + comment.encode()))}"
    )
    broken = pick.choice(("book", "key", "signature", "signature"))
    given = {"book": data, "key": key, "signature": signature}
    if broken == "book":
        given[broken] = mutated_json(data, pick)
    elif pick.random() < 0.5:
        given[broken] = mutated_bytes(given[broken].encode(), pick)
    else:
        given[broken] = mutated_words(given[broken], pick, [key, signature])
    book = place.write("tried.json", given["book"])
    place.write("tried.json.minisig", given["signature"])
    public = place.write("tried.pub", given["key"])
    word = key.splitlines()[1] if broken != "key" and pick.random() < 0.3 else public
    traces = str(place.folder / "traces.jsonl")
    return ["verify", traces, "-r", book, "--require-signed", word]


def _base64(*parts):
    data = [part if isinstance(part, bytes) else part.public_bytes_raw() for part in parts]
    return base64.b64encode(b"".join(data)).decode() + "\n"
