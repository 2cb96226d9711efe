"""A rulebook's texts in code of other languages: identifiers, comments, literals.

A rulebook may come from anyone. Whatever its texts contain, they cannot end a comment, splice
lines, form a trigraph or change the writing direction.
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
"""Keywords of C, C++ and Rust, non-standard macros, the monitor's fields, ``stddef.h`` names."""

_OF_STDINT = re.compile(r"u?int(_least|_fast|ptr|max)?[0-9]*_t|[A-Z0-9_]+_(MIN|MAX|C)")
"""Names of ``stdint.h``."""

_TAKEN = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign
    stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype
    alloca dirent endian fcntl features grp malloc memory netdb poll pwd regex sched search
    semaphore strings syslog termios unistd values
    aio atomic cnd fanotify inotify mtx nss obstack res sem
    alloc core names proc_macro proof std test
    all clean edit_cache help install package package_source preinstall rebuild_cache
    c dl m pthread rt util
"""
_TAKEN_PREFIXES = frozenset(_TAKEN.split())
"""No names of monitors: headers of C and POSIX, functions ``..._init`` of the C library, Rust's own
crates and the crate's own modules, targets of CMake, libraries."""

_SHOWN = frozenset({"Lu", "Ll", "Lt", "Lm", "Lo", "Nd", "Nl", "No", "Pd", "Po", "Ps", "Pe", "Sc"})
"""Categories of non-ASCII characters that a comment may contain unchanged."""

_RIGHT_TO_LEFT = frozenset({"R", "AL", "AN"})


class Identifiers:
    """Creates identifiers for names, each distinct from all earlier and all ``taken`` ones."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def of(self, *parts: str, upper: bool = False) -> str:
        """An identifier valid in C, C++ and Rust; every call returns a new one."""
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
    """The common prefix of all identifiers of a monitor, in lower case."""
    prefix = Identifiers().of(name.lower())
    return f"{prefix}_of_rule" if prefix in _TAKEN_PREFIXES else prefix


def _letters(text: str) -> str:
    """A name in ASCII letters, digits and single underscores; characters are encoded distinctly."""
    mapped = "".join(
        character
        if character.isascii() and (character.isalnum() or character == "_")
        else f"_{ord(character):x}_"
        if character not in "- "
        else "_"
        for character in text
    )
    # Identifiers with double underscores are reserved in C++.
    return re.sub("_{2,}", "_", mapped).rstrip("_")


def in_comment(text: str) -> str:
    """A text for one line of a comment, with harmful characters replaced by their numbers."""
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
    """A C literal: UTF-8 bytes, all but plain characters as three octal digits each."""
    plain = frozenset(b" !#$%&'()+,-.0123456789:;<=>@[]^_`{|}~")
    shown = "".join(
        chr(byte) if byte in plain or (byte < 128 and chr(byte).isalpha()) else f"\\{byte:03o}"
        for byte in text.encode("utf-8", "surrogatepass")
    )
    shown = re.sub("(?<=rulec)_|(?<=RULEC)_", r"\\137", shown)
    # An escape must end its literal or be followed by another escape (MISRA C:2012, 4.1).
    return '"{}"'.format(re.sub(r"(\\[0-7]{3})(?=[^\\])", r'\1" "', shown))


def rust_string(text: str) -> str:
    """A Rust literal: plain characters, else code points; U+FFFD for lone surrogates."""
    shown = "".join(
        character
        if character.isascii() and (character.isalnum() or character in " .,-_()")
        else f"\\u{{{0xFFFD if 0xD800 <= ord(character) < 0xE000 else ord(character):x}}}"
        for character in text
    )
    return f'"{shown}"'
