"""Files with mistakes in them: cut, with parts missing or twice, with other words and numbers."""

import re
import struct

ELEMENT = re.compile(r"<(\w+)(?: [^<>]*)?/>|<(\w+)(?: [^<>]*)?>(?:(?!<\2\b).)*?</\2>", re.DOTALL)
TEXT = re.compile(r'(?<=>)[^<>\s][^<>]*(?=<)|(?<=")[^"<>]*(?=")')
WORDS = (
    "nan",
    "1e999",
    "-1",
    "0",
    "1e-320",
    "99999999",
    "20000000",
    "9" * 5000,
    "-inf",
    "0x10",
    "soon",
    "",
    " ",
    "\N{ARABIC-INDIC DIGIT SEVEN}",
    "&lt;b&gt;",
)
BYTES = (b"", b"\0", b"\xff", b"<", b"&", b">", b"<!--", b"\r", b"]]>")

NASTY = (
    b"",
    b"\0",
    b"\xff" * 10,
    b"\x80" * 9 + b"\x01",
    struct.pack("<d", float("nan")),
    struct.pack("<d", float("inf")),
    struct.pack("<d", -1e300),
    struct.pack("<f", float("nan")),
    struct.pack("<I", 2**32 - 1),
    struct.pack("<Q", 2**63),
)
"""Numbers that hurt, as they are written in bytes."""


def mutated_bytes(data, pick):
    """The bytes with one to five mistakes: others, more, fewer, again, or cut."""
    content = bytearray(data)
    for _ in range(pick.choice((1, 1, 2, 3, 5))):
        at, length = pick.randrange(len(content) + 1), pick.choice((0, 1, 1, 4, 8, 40))
        match pick.randrange(4):
            case 0 if at < len(content):
                content[at] ^= 1 << pick.randrange(8)
            case 1:
                content[at : at + length] = bytes([pick.choice((0, 1, 127, 128, 255))])
            case 2:
                content[at : at + length] = content[at : at + pick.randint(1, 99)] * 2
            case _:
                content[at : at + length] = pick.choice((*NASTY, pick.randbytes(2)))
    return bytes(content[: pick.randrange(len(content) + 1)] if pick.random() < 0.1 else content)


def mutated_rows(text, pick):
    """The bytes of a table with one to three mistakes."""
    rows = [line.split(",") for line in text.splitlines()]
    for _ in range(pick.choice((1, 1, 2, 3))):
        row = pick.choice(rows)
        at = pick.randrange(len(row)) if row else 0
        match pick.randrange(8):
            case 0:
                rows.remove(row)
            case 1:
                rows.insert(pick.randrange(len(rows)), list(row))
            case 2:
                del row[at : at + 1]
            case 3 | 4:
                row[at : at + 1] = pick.choice(rows)[at : at + 1]
            case _:
                row[at : at + 1] = [pick.choice(WORDS)]
        rows = rows or [[""]]
    data = "\n".join(map(",".join, rows)).encode()
    match pick.randrange(10):
        case 0:
            return data[: pick.randrange(len(data) + 1)]
        case 1:
            at = pick.randrange(len(data) + 1)
            return data[:at] + pick.choice((*BYTES, b'"', b";", b"\x1f\x8b")) + data[at + 1 :]
    return data


def mutated(text, pick):
    """The bytes of a text with one to three mistakes, as ``pick`` (a random.Random) chooses."""
    for _ in range(pick.randint(1, 3)):
        mistake = pick.choice((_without, _twice, _moved, _other_word, _other_word, _other_word))
        text = mistake(text, pick)
    data = text.encode()
    last = pick.randrange(6)
    if last == 0:
        return data[: pick.randrange(len(data))]
    if last == 1:
        at = pick.randrange(len(data))
        return data[:at] + pick.choice(BYTES) + data[at + 1 :]
    return text.encode("utf-16") if last == 2 and pick.random() < 0.1 else data


def _without(text, pick):
    start, end = _element(text, pick)
    return text[:start] + text[end:]


def _twice(text, pick):
    start, end = _element(text, pick)
    return text[:end] + text[start:]


def _moved(text, pick):
    start, end = _element(text, pick)
    to, _ = _element(text, pick)
    return text[:to] + text[start:end] + text[to:]


def _other_word(text, pick):
    found = pick.choice(list(TEXT.finditer(text)) or [re.match("", text)])
    return text[: found.start()] + pick.choice(WORDS) + text[found.end() :]


def _element(text, pick):
    """Where an element begins and ends, of those that have not been cut."""
    begins = [match.start() for match in re.finditer(r"<\w", text)]
    match = ELEMENT.match(text, pick.choice(begins)) if begins else None
    return match.span() if match else (0, 0)
