"""Checks that a comparison's words say the same as its numbers, by computing from the words alone.

`gap(v) >= 2 s * speed` is a condition on `gap(v)` and `speed` with a factor and a limit, both in
the units of the declarations. The tree contains these numbers; the words are what people read.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from rulec.validation.formula_words import comparisons_in, formula_words, term_words
from rulec.validation.unprovable import UnprovableError, exact, require

_MIRRORED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "=": "=", "!=": "!="}

# Sizes in metres, seconds, kilograms and degrees.
KNOWN_UNITS: Mapping[str, tuple[Fraction, str]] = {
    name: (Fraction(size), kind)
    for kind, units in {
        "m": "1 m meter metre; 1000 km kilometer kilometre; 1/100 cm centimeter centimetre; "
        "1/1000 mm millimeter millimetre; 1/10 dm; 127/5000 inch inches; 381/1250 ft foot feet; "
        "1143/1250 yd yard; 201168/125 mi mile; 1852 nmi",
        "s": "1 s sec second; 1/1000 ms millisecond; 60 min minute; 3600 h hr hour; 86400 d day; "
        "604800 week",
        "m/s": "1397/3125 mph; 5/18 kph; 463/900 kt knot; 1 mps; 381/1250 fps",
        "kg": "1 kg kilogram; 1000 t tonne; 1/1000 g gram; 45359237/100000000 lb pound",
        "deg": "1 ° deg degree",
        "rad": "1 rad radian",
        "": "1/100 % percent; 1/1000 permille; 1 number",
        "/s": "1 Hz hertz",
    }.items()
    for unit in units.split(";")
    for size, *names in [unit.split()]
    for single in names
    for name in (single, f"{single}s")
}

_Kind = tuple[tuple[str, int], ...]


def check_comparison(comparison: Mapping[str, Any], units: Mapping[str, str]) -> None:
    """Raise UnprovableError unless a comparison's words say the same as its numbers.

    ``units`` are the declared units of the quantities.
    """
    terms, text = comparison["terms"], comparison["text"]
    require(len(terms) > 0, "a comparison has no terms")
    for _, term in terms:
        if "count" in term:
            for inner in comparisons_in(term["body"]):
                check_comparison(inner, units)
    if len(terms) == 1 and "count" in terms[0][1] and text.startswith(("some ", "every ")):
        require(_says_some_or_every(comparison), f"`{text}` does not say what is compared")
        return
    names = {term_words(term): f"term_{place}" for place, (_, term) in enumerate(terms)}
    for words in sorted(names, key=len, reverse=True):
        text = text.replace(words, names[words])
    sizes = {}
    for _, term in terms:
        unit = "number" if "count" in term else units[term["quantity"]]
        sizes[names[term_words(term)]] = _unit(unit)
    difference, relation = _Reader(text, sizes).comparison()
    factors = [difference.factors.get(f"term_{place}", Fraction(0)) for place in range(len(terms))]
    first = factors[0]
    same = (
        first != 0
        and (_MIRRORED[relation] if first < 0 else relation) == comparison["relation"]
        and [each / first for each in factors] == [exact(factor) for factor, _ in terms]
        and -difference.constant / first == exact(comparison["limit"])
    )
    require(same, f"`{comparison['text']}` does not say what is compared")


def _says_some_or_every(comparison: Mapping[str, Any]) -> bool:
    term, text = comparison["terms"][0][1], comparison["text"]
    body, of = term["body"], f"{term['count']}: {term['type']}"
    numbers = [comparison["terms"][0][0], comparison["relation"], comparison["limit"]]
    if text == f"some {of} ({formula_words(body)})":
        return numbers == ["1", ">=", "1"]
    if isinstance(body, bool):
        opposites: list[Any] = [not body]
    else:
        opposites = [["not", body]]
        if isinstance(body, list) and body[0] == "not":
            opposites.append(body[1])
    of_every = [f"every {of} ({formula_words(opposite)})" for opposite in opposites]
    return text in of_every and numbers == ["1", "<", "1"]


def _unit(text: str) -> tuple[Fraction, _Kind]:
    """The size of a unit in base units, and its dimension."""
    size, kind = Fraction(1), Counter[str]()
    for place, part in enumerate(text.split("/")):
        name, _, power = part.partition("^")
        known = KNOWN_UNITS.get(name)
        require(known is not None, f"this checker does not know the unit `{text}`")
        assert known is not None
        times = int(power or 1) * (-1 if place else 1)
        size *= known[0] ** times
        for at, base in enumerate(known[1].split("/")):
            if base:
                kind[base] += -times if at else times
    return size, _normal(kind)


def _normal(kind: Counter[str]) -> _Kind:
    return tuple(sorted((base, power) for base, power in kind.items() if power))


@dataclass(frozen=True, slots=True)
class _Sum:
    """Factors of terms, and a constant, in base units; ``kind`` is None for a bare 0."""

    factors: Mapping[str, Fraction]
    constant: Fraction
    kind: _Kind | None

    def plus(self, other: _Sum, sign: int) -> _Sum:
        kinds = {self.kind, other.kind} - {None}
        require(len(kinds) < 2, "its words compare numbers of different dimensions")
        factors = dict(self.factors)
        for name, factor in other.factors.items():
            factors[name] = factors.get(name, Fraction(0)) + sign * factor
        kind = self.kind if other.kind is None else other.kind
        return _Sum(factors, self.constant + sign * other.constant, kind)

    def times(self, other: _Sum, power: int) -> _Sum:
        if power < 0 or not other.factors:
            require(not other.factors, "its words divide by a term that varies")
            factor = other.constant**power
            kinds = Counter(dict(self.kind or ()))
            for base, times in other.kind or ():
                kinds[base] += power * times
            factors = {name: each * factor for name, each in self.factors.items()}
            return _Sum(factors, self.constant * factor, _normal(kinds))
        require(not self.factors, "its words multiply terms that vary")
        return other.times(self, 1)


_TOKEN = re.compile(
    r"\s*(?:([0-9]+(?:\.[0-9]+)?)(?:\s*((?:[%°]|[^\W\d]\w*(?:\^-?[0-9]+)?"
    r"(?:/[^\W\d]\w*(?:\^-?[0-9]+)?)*)))?|([^\W\d]\w*)|([<>!]=|[-+*/()<>=]))"
)


class _Reader:
    """Recursive descent parser of a comparison; ``sizes`` are the units of its terms."""

    def __init__(self, text: str, sizes: Mapping[str, tuple[Fraction, _Kind]]) -> None:
        self._text, self._sizes, self._at = text, sizes, 0

    def comparison(self) -> tuple[_Sum, str]:
        """The left side minus the right side, and its relation to 0."""
        left = self._sum()
        relation = self._next()[3]
        right = self._sum()
        require(relation in _MIRRORED and not self._text[self._at :].strip(), self._unread())
        return left.plus(right, -1), relation

    def _unread(self) -> str:
        return f"this checker cannot read `{self._text}`"

    def _peek(self) -> re.Match[str] | None:
        return _TOKEN.match(self._text, self._at)

    def _next(self) -> tuple[str, str, str, str]:
        match = self._peek()
        if match is None:
            raise UnprovableError(self._unread())
        self._at = match.end()
        number, unit, name, sign = (part or "" for part in match.groups())
        return number, unit, name, sign

    def _sign(self, *signs: str) -> str:
        match = self._peek()
        if match is None or match[4] not in signs:
            return ""
        self._at = match.end()
        return str(match[4])

    def _sum(self) -> _Sum:
        whole = self._product()
        while sign := self._sign("+", "-"):
            whole = whole.plus(self._product(), 1 if sign == "+" else -1)
        return whole

    def _product(self) -> _Sum:
        whole = self._signed()
        while sign := self._sign("*", "/"):
            whole = whole.times(self._signed(), 1 if sign == "*" else -1)
        return whole

    def _signed(self) -> _Sum:
        if self._sign("-"):
            return _Sum({}, Fraction(0), None).plus(self._signed(), -1)
        number, unit, name, sign = self._next()
        if sign == "(":
            inner = self._sum()
            require(self._next()[3] == ")", self._unread())
            return inner
        if name in self._sizes:
            size, kind = self._sizes[name]
            return _Sum({name: size}, Fraction(0), kind)
        require(bool(number), self._unread())
        size, kind = _unit(unit) if unit else (Fraction(1), ())
        value = Fraction(number) * size
        return _Sum({}, value, None if value == 0 and not unit else kind)
