"""Files with mistakes in them: cut, with parts missing or twice, with other words and numbers."""

import re

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
