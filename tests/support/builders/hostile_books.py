"""A rulebook whose names and texts would break out of the code that they get into."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace

from rulec.rulebook.rulebook_model import SourceFile

TEXTS = [
    "*/ int main(void) { return system(0); } /*",
    "ends in a backslash \\",
    "trigraph ??/",
    "lines\nbroken\r\nand\u2028again\u0085and\x0bso",
    "turned \u202e round \u2066 \u200f \u05d0",
    '"); system("\' \'\'\' """',
    "zero\0and\x1b[31m",
    "%s %n {0} ${HOME} $(id) @PATH@ // # rulec_step",
    "]]> --> <license>&amp;&lol;</license> <!--",
    "#![allow(unsafe_code)] #include <stdlib.h>",
]
EVIL = " ".join(TEXTS)

PARTS = [*TEXTS, "from", "class", "any", "ß\u00e9", "__a__", "9"]


def hostile(compiled, names):
    """The rulebook with these names changed for hostile ones, and with hostile texts."""
    evil = {name: PARTS[n % len(PARTS)] for n, name in enumerate(names)}
    assert len(names) <= len(PARTS)
    book = _renamed(compiled, evil | {"km/h": EVIL})
    rules = tuple(replace(rule, cite=EVIL, says=EVIL) for rule in book.rules)
    sources = (SourceFile(EVIL, EVIL),)
    return replace(book, rules=rules, title=EVIL, law=EVIL, as_of=EVIL, sources=sources)


def _renamed(value, names):
    if isinstance(value, str):
        return names.get(value, value)
    if isinstance(value, Mapping):
        return {_renamed(key, names): _renamed(inner, names) for key, inner in value.items()}
    if isinstance(value, tuple | list):
        return type(value)([_renamed(inner, names) for inner in value])
    if is_dataclass(value):
        own = {one.name: getattr(value, one.name) for one in fields(value) if one.init}
        changed = {name: _renamed(inner, names) for name, inner in own.items()}
        return replace(value, **{name: new for name, new in changed.items() if new != own[name]})
    return value
