"""A rulebook's texts in code of other languages: identifiers, comments, literals.

A rulebook may be anybody's. Whatever its texts hold, they end no comment, splice no lines, form no
trigraph and turn no writing round.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from itertools import count

_KEYWORDS = """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t
    class compl concept const const_cast consteval constexpr constinit continue co_await co_return
    co_yield decltype default delete do double dynamic_cast else enum explicit export extern false
    float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr
    operator or or_eq private protected public register reinterpret_cast requires restrict return
    short signed sizeof static static_assert static_cast struct switch template this thread_local
    throw true try typedef typeid typename typeof union unsigned using virtual void volatile wchar_t
    while xor xor_eq
    abstract as async await become box crate dyn extern final fn gen impl in let loop macro match
    mod move mut override priv pub ref self static super trait type unsafe unsized use where yield
    linux unix i386 arm mips sun near far errno assert stdin stdout stderr environ main
    id objects n_objects Self NULL size_t ptrdiff_t max_align_t offsetof nullptr_t NAN INFINITY
"""
_RESERVED = frozenset(_KEYWORDS.split())
"""Keywords of C, C++ and Rust, macros of compilers that are no words of the standard, the monitor's
own fields, and names of ``stddef.h``."""

_OF_STDINT = re.compile(r"u?int(_least|_fast|ptr|max)?[0-9]*_t|[A-Z0-9_]+_(MIN|MAX|C)")
"""Names of ``stdint.h``."""

_SHOWN = frozenset({"Lu", "Ll", "Lt", "Lm", "Lo", "Nd", "Nl", "No", "Pd", "Po", "Ps", "Pe", "Sc"})
"""Categories of characters beyond ASCII that a comment may have as they are."""

_RIGHT_TO_LEFT = frozenset({"R", "AL", "AN"})


class Identifiers:
    """Identifiers for names, each another one than all before, and than those ``taken``."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def of(self, *parts: str, upper: bool = False) -> str:
        """An identifier of C, C++ and Rust; the same parts again have another one."""
        text = _letters("_".join(part.strip() for part in parts))
        text = text.upper() if upper else text
        if text in _RESERVED or not text or _OF_STDINT.fullmatch(text):
            text += "_OF_RULE" if upper else "_of_rule"
        elif text[0] in "_0123456789" or text.lower().startswith("rulec_"):
            text = f"{'X' if upper else 'x'}{text}"
        name = text
        numbers = count(2)
        while name in self._taken:
            name = f"{text}_{next(numbers)}"
        self._taken.add(name)
        return name


def prefix_of(name: str) -> str:
    """What all of a monitor's identifiers begin with, in lower case."""
    return Identifiers().of(name.lower())


def _letters(text: str) -> str:
    """A name in letters, digits and single underscores of ASCII, no two different ones alike."""
    mapped = "".join(
        character
        if character.isascii() and (character.isalnum() or character == "_")
        else f"_{ord(character):x}_"
        if character not in "- "
        else "_"
        for character in text
    )
    # Identifiers with two underscores belong to C++.
    return re.sub("_{2,}", "_", mapped).rstrip("_")


def in_comment(text: str) -> str:
    """A text on one line of a comment; characters that could do harm by their numbers."""
    shown = "".join(map(_shown, " ".join(text.split())))
    return re.sub(_HARMFUL, lambda match: _number(match[0]), shown)


_HARMFUL = r"(?<=\*)/|(?<=/)[*/]|(?<=\?)\?|(?<=rulec)_|(?<=RULEC)_"
"""Ends and beginnings of comments, trigraphs, and names that get the monitor's own prefix."""


def _shown(sign: str) -> str:
    if sign.isascii():
        return sign if sign.isprintable() and sign != "\\" else _number(sign)
    fits = unicodedata.category(sign) in _SHOWN
    return sign if fits and unicodedata.bidirectional(sign) not in _RIGHT_TO_LEFT else _number(sign)


def _number(sign: str) -> str:
    return f"<U+{ord(sign):04X}>"


def c_string(text: str) -> str:
    """A literal of C: its bytes in UTF-8, all but plain letters as three octal digits each."""
    plain = frozenset(b" !#$%&'()+,-.0123456789:;<=>@[]^_`{|}~")
    shown = "".join(
        chr(byte) if byte in plain or (byte < 128 and chr(byte).isalpha()) else f"\\{byte:03o}"
        for byte in text.encode("utf-8", "surrogatepass")
    )
    shown = re.sub("(?<=rulec)_|(?<=RULEC)_", r"\\137", shown)
    # An escape is the last of its literal, or followed by another one (MISRA C:2012, 4.1).
    return '"{}"'.format(re.sub(r"(\\[0-7]{3})(?=[^\\])", r'\1" "', shown))


def rust_string(text: str) -> str:
    """A literal of Rust: plain letters, else numbers of characters; U+FFFD for what is none."""
    shown = "".join(
        character
        if character.isascii() and (character.isalnum() or character in " .,-_()")
        else f"\\u{{{0xFFFD if 0xD800 <= ord(character) < 0xE000 else ord(character):x}}}"
        for character in text
    )
    return f'"{shown}"'
