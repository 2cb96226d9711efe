"""C code that reads the digits of letters from an input, where values may be unknown.

The functions that it calls are in ``c_texts/readings.c``. Digits are ranges: the least and the
greatest digit that a read may have (see there).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from math import isfinite, lcm
from typing import Any

from rulec.automata.alphabet import letters_with, reads_of
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.code_generation.code_messages import too_large
from rulec.code_generation.input_fields import InputFields
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.free_names import variables_of
from rulec.logic.kleene import alias_of

NAME = "\0"
"""The placeholder for the name in a definition."""

Places = Mapping[str, str]
"""Maps variables to expressions for the places of their objects in the input."""

MOST_DIGITS = 255
"""A digit and its range have 16 bits."""

_FAR = 2.0**60
"""Greater than all numbers that count as known."""

_LARGEST_FACTOR = 1 << 20
_LARGEST_LIMIT = 1 << 59


class ReadingCode:
    """Generates expressions for reads, and the ``definitions`` that they need, in file order."""

    def __init__(self, fields: InputFields) -> None:
        self._fields = fields
        self._named: dict[str, str] = {}
        self.definitions: list[str] = []

    def place_of(self, variable: int) -> str:
        """The expression for the place of a rule variable's object, in reads about several."""
        return f"who[{self._whole(variable)}]"

    def digits(self, read: Read | NumberRead, places: Places) -> str:
        """The expression for a read's digits. Raises RulecError R0750 if there are too many."""
        if read.size > MOST_DIGITS:
            raise too_large(
                f"a rule distinguishes {read.size} values of one read, at most {MOST_DIGITS}"
            )
        if read.size == 1:
            return self._whole(0)  # for example a count that is at least 0
        if isinstance(read, Read):
            return self._digits_of_value(read, places)
        match read.terms:
            case ((1, ltl.QuantityTerm(name, arguments)),):
                floors = [min(max(floor, -_FAR), _FAR) for floor in scale(read).floors]
                table = self._array("double", "floors", floors)
                value = self._value(name, arguments, places)
                return self._call("number", value, table, self._whole(len(floors)))
            case ((1, ltl.Count() as count),):
                limits = [min(int(side.limit), 1 << 16) for side in read.thresholds]
                table = self._array("uint32_t", "counts", limits)
                counted = self._count(count, places)
                return self._call("counted", counted, table, self._whole(len(limits)))
        return self._sum(read, places)

    def _digits_of_value(self, read: Read, places: Places) -> str:
        value = self._value(read.name, read.variables, places)
        if not read.values:
            return self._call("truth", value)
        declared = self._fields.values_of(read.name)
        table = self._array("uint8_t", "digits", [read.digit(each) for each in declared])
        sizes = self._whole(len(declared)), self._whole(read.size)
        return self._call("value", value, table, *sizes)

    def _value(self, name: str, arguments: Sequence[str], places: Places) -> str:
        return self._fields.expression(name, [places[variable] for variable in arguments])

    def _truth(self, formula: ltl.Formula, places: Places) -> str:
        def identity(same: ltl.Same) -> str:
            left, right = places[same.left], places[same.right]
            return "RULEC_YES" if left == right else f"(({left} == {right}) ? RULEC_YES : RULEC_NO)"

        algebra: Algebra[str] = Algebra(
            proposition=lambda proposition: self._proposition(proposition, places),
            constant=lambda value: "RULEC_YES" if value else "RULEC_NO",
            identity=identity,
            negation=partial(self._call, "not"),
            conjunction=partial(self._call, "and"),
            disjunction=partial(self._call, "or"),
            equivalence=partial(self._call, "same"),
        )
        return fold(formula, algebra)

    def _proposition(self, proposition: ltl.Proposition, places: Places) -> str:
        if isinstance(proposition, ltl.Atom):
            value = self._value(proposition.name, proposition.arguments, places)
            if proposition.value is None:
                return self._call("is", value)
            declared = self._fields.values_of(proposition.name)
            numbers = declared.index(proposition.value), len(declared)
            return self._call("has", value, *map(self._whole, numbers))
        reads = reads_of(proposition, self._fields.vocabulary)
        mask = letters_with(reads, [proposition])[proposition]
        return self._call("among", self.digits(reads[0], places), self._whole(mask))

    def _count(self, count: ltl.Count, places: Places) -> str:
        """The expression for the number of counted objects."""
        free = list(dict.fromkeys(variables_of(count)))
        inner = {variable: f"who{number}" for number, variable in enumerate(free)}
        alias = alias_of(count.variable, count.body)
        each = inner[count.variable] = "each" if alias is None else inner[alias]
        body = self._truth(count.body, inner)
        kind = self._fields.types.index(count.type)
        counts = self._call("counts", "in", each, self._whole(kind), body)
        lines = self._counting(counts) if alias is None else [f"return {counts};"]
        return self._function("uint32_t", "count", {inner[x]: places[x] for x in free}, lines)

    def _sum(self, read: NumberRead, places: Places) -> str:
        free = list(dict.fromkeys(name for _, term in read.terms for name in variables_of(term)))
        inner = {variable: f"who{number}" for number, variable in enumerate(free)}
        flags = {(side.limit, side.inclusive) for side in read.thresholds}
        match read.terms:
            case ((1, ltl.QuantityTerm() as first), (-1, ltl.QuantityTerm() as second)) if all(
                limit == 0 for limit, _ in flags
            ):
                # Doubles are ordered as their decimals are.
                sides = sum(1 if inclusive else 2 for _, inclusive in flags)
                pair = [self._value(term.name, term.arguments, inner) for term in (first, second)]
                lines = [f"return {self._call('order', *pair, self._whole(sides))};"]
            case _:
                lines = self._weighed(read, inner)
        return self._function("uint16_t", "sum", {inner[x]: places[x] for x in free}, lines)

    def _weighed(self, read: NumberRead, places: Places) -> list[str]:
        values = [
            self._count(term, places)
            if isinstance(term, ltl.Count)
            else self._value(term.name, term.arguments, places)
            for _, term in read.terms
        ]
        counted = [isinstance(term, ltl.Count) for _, term in read.terms]
        return self._weighing(values, counted, self._shape(read))

    def _shape(self, read: NumberRead) -> str:
        """The factors and limits of a sum, also as whole numbers if they are small enough."""
        factors = [factor for factor, _ in read.terms]
        limits = [side.limit for side in read.thresholds]
        if len(factors) > MOST_DIGITS or not all(map(_is_double, [*factors, *limits])):
            raise too_large("a sum has too many terms, or too large ones")
        common = lcm(*[number.denominator for number in (*factors, *limits)])
        whole = [int(factor * common) for factor in factors]
        bounds = [int(limit * common * 8) for limit in limits]
        fits = (
            len(factors) <= 32
            and max(map(abs, whole)) <= _LARGEST_FACTOR
            and max(map(abs, bounds)) <= _LARGEST_LIMIT
        )
        parts = [
            self._array("double", "factors", [float(factor) for factor in factors]),
            self._array("double", "limits", [float(limit) for limit in limits]),
            self._array("uint8_t", "inclusive", [int(side.inclusive) for side in read.thresholds]),
            *[self._array("int64_t", "whole", own) if fits else "NULL" for own in (whole, bounds)],
            *map(self._whole, (len(factors), len(limits))),
        ]
        name = self._defined("shape", f"static const rulec_shape {NAME} = {{{', '.join(parts)}}};")
        return f"&{name}"

    def _function(self, kind: str, about: str, places: Places, lines: Sequence[str]) -> str:
        """A call of a function with this body; ``places`` maps its parameters to arguments."""
        name = self._defined(about, self._function_pattern(kind, list(places), lines))
        return f"{name}({', '.join(['in', *places.values()])})"

    def _defined(self, about: str, pattern: str) -> str:
        """The name of a definition; equal definitions are made once."""
        if pattern not in self._named:
            name = self._named[pattern] = f"rulec_{about}_{len(self._named)}"
            self.definitions.append(pattern.replace(NAME, name))
        return self._named[pattern]

    def _call(self, name: str, *arguments: str) -> str:
        return f"rulec_{name}({', '.join(arguments)})"

    def _whole(self, number: int) -> str:
        return f"{number}u"

    def _array(self, kind: str, about: str, items: Sequence[float]) -> str:
        shown: dict[str, Callable[[Any], str]] = {
            "double": float.hex,
            "int64_t": "INT64_C({})".format,
        }
        content = ", ".join(map(shown.get(kind, "{}u".format), items))
        return self._defined(about, f"static const {kind} {NAME}[{len(items)}u] = {{{content}}};")

    def _counting(self, counts: str) -> list[str]:
        return [
            "uint32_t found = 0u;",
            "size_t each;",
            "for (each = 0u; each < in->n_objects; each++) {",
            f"    found += {counts};",
            "}",
            "return found;",
        ]

    def _weighing(self, values: Sequence[str], counted: Sequence[bool], shape: str) -> list[str]:
        size, counting = len(values), any(counted)
        lines = [f"double low[{size}u];", *[f"double high[{size}u];"] * counting]
        for number, (value, is_count) in enumerate(zip(values, counted, strict=True)):
            if is_count:
                # After all declarations of the block
                lines.insert(2, f"const uint32_t count{number} = {value};")
                lines += [
                    f"low[{number}u] = (double)(count{number} & 0xffffu);",
                    f"high[{number}u] = (double)(count{number} >> 16);",
                ]
            else:
                lines.append(f"low[{number}u] = {value};")
                lines += [f"high[{number}u] = low[{number}u];"] * counting
        high = "high" if counting else "low"
        return [*lines, f"return rulec_weigh(low, {high}, {shape});"]

    def _function_pattern(self, kind: str, parameters: Sequence[str], lines: Sequence[str]) -> str:
        given = "".join(f", size_t {name}" for name in parameters)
        *first, last = lines
        code = "\n    ".join([*first, *ignored_in_c(unread(parameters, lines)), last])
        return f"static {kind} {NAME}(const rulec_input *in{given})\n{{\n    {code}\n}}"


def unread(parameters: Iterable[str], lines: Sequence[str]) -> list[str]:
    """The parameters that code does not read, as if a count is compared that any number passes."""
    words = {word for line in lines for word in re.findall(r"(?<![.>\w])\w+", line)}
    return [name for name in parameters if name not in words]


def ignored_in_c(parameters: Iterable[str]) -> list[str]:
    """Statements for parameters that are not read, of which compilers would warn."""
    return [f"(void){name};" for name in parameters]


def _is_double(number: Fraction) -> bool:
    try:
        return isfinite(float(number)) and abs(float(number)) < _FAR
    except OverflowError:
        return False
