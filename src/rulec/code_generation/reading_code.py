"""Code of C that reads letters' digits from an input, where values may be unknown.

What it calls is in ``c_texts/readings.c``. Digits are a range: the least and the greatest that a
read may have (see there).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isfinite, lcm

from rulec.automata.alphabet import letters_with, reads_of
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.code_generation.code_messages import too_large
from rulec.code_generation.input_fields import InputFields
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.free_names import variables_of
from rulec.logic.kleene import alias_of

Places = Mapping[str, str]
"""Variables, and the expressions of their objects' places in the input."""

MOST_DIGITS = 255
"""A digit and its range have 16 bits."""

_FAR = 2.0**60
"""Beyond all numbers that count as known."""

_LARGEST_FACTOR = 1 << 20
_LARGEST_LIMIT = 1 << 59


class ReadingCode:
    """Expressions for reads, and the ``definitions`` that they need, in the order of the file."""

    def __init__(self, fields: InputFields) -> None:
        self._fields = fields
        self._named: dict[str, str] = {}
        self.definitions: list[str] = []

    def digits(self, read: Read | NumberRead, places: Places) -> str:
        """Expression for the digits of a read. Raises RulecError R0750 if they are too many."""
        if read.size > MOST_DIGITS:
            raise too_large(f"{read.size} values of one read are told apart, at most {MOST_DIGITS}")
        if isinstance(read, Read):
            return self._digits_of_value(read, places)
        match read.terms:
            case ((1, ltl.QuantityTerm(name, arguments)),):
                floors = [min(max(floor, -_FAR), _FAR) for floor in scale(read).floors]
                table = self._array("double", "floors", [each.hex() for each in floors])
                value = self._value(name, arguments, places)
                return f"rulec_number({value}, {table}, {len(floors)}u)"
            case ((1, ltl.Count() as count),):
                limits = [min(int(side.limit), 1 << 16) for side in read.thresholds]
                table = self._array("uint32_t", "counts", [f"{limit}u" for limit in limits])
                return f"rulec_counted({self._count(count, places)}, {table}, {len(limits)}u)"
        return self._sum(read, places)

    def _digits_of_value(self, read: Read, places: Places) -> str:
        value = self._value(read.name, read.variables, places)
        if not read.values:
            return f"rulec_truth({value})"
        declared = self._fields.values_of(read.name)
        table = self._array("uint8_t", "digits", [f"{read.digit(each)}u" for each in declared])
        return f"rulec_value({value}, {table}, {len(declared)}u, {read.size}u)"

    def _value(self, name: str, arguments: Sequence[str], places: Places) -> str:
        return self._fields.expression(name, [places[variable] for variable in arguments])

    def _truth(self, formula: ltl.Formula, places: Places) -> str:
        def identity(same: ltl.Same) -> str:
            left, right = places[same.left], places[same.right]
            if left == right:
                return "RULEC_YES"
            return f"(({left} == {right}) ? RULEC_YES : RULEC_NO)"

        return fold(
            formula,
            Algebra(
                proposition=lambda proposition: self._proposition(proposition, places),
                constant=lambda value: "RULEC_YES" if value else "RULEC_NO",
                identity=identity,
                negation="rulec_not({})".format,
                conjunction="rulec_and({}, {})".format,
                disjunction="rulec_or({}, {})".format,
                equivalence="rulec_same({}, {})".format,
            ),
        )

    def _proposition(self, proposition: ltl.Proposition, places: Places) -> str:
        if isinstance(proposition, ltl.Atom):
            value = self._value(proposition.name, proposition.arguments, places)
            if proposition.value is None:
                return f"rulec_is({value})"
            declared = self._fields.values_of(proposition.name)
            return f"rulec_has({value}, {declared.index(proposition.value)}u, {len(declared)}u)"
        reads = reads_of(proposition, self._fields.vocabulary)
        mask = letters_with(reads, [proposition])[proposition]
        return f"rulec_among({self.digits(reads[0], places)}, 0x{mask:x}u)"

    def _count(self, count: ltl.Count, places: Places) -> str:
        """Expression for how many objects count."""
        free = list(dict.fromkeys(variables_of(count)))
        inner = {variable: f"who{number}" for number, variable in enumerate(free)}
        alias = alias_of(count.variable, count.body)
        each = inner[count.variable] = "each" if alias is None else inner[alias]
        body = self._truth(count.body, inner)
        kind = self._fields.types.index(count.type)
        counts = f"rulec_counts(in, {each}, {kind}u, {body})"
        parameters = "".join(f", size_t {inner[variable]}" for variable in free)
        lines = [f"return {counts};"]
        if alias is None:
            lines = [
                "uint32_t found = 0u;",
                "size_t each;",
                "for (each = 0u; each < in->n_objects; each++) {",
                f"    found += {counts};",
                "}",
                "return found;",
            ]
        code = "\n    ".join(lines)
        name = self._function("uint32_t", "count", parameters, code)
        arguments = "".join(f", {places[variable]}" for variable in free)
        return f"{name}(in{arguments})"

    def _sum(self, read: NumberRead, places: Places) -> str:
        free = list(dict.fromkeys(name for _, term in read.terms for name in variables_of(term)))
        inner = {variable: f"who{number}" for number, variable in enumerate(free)}
        flags = {(side.limit, side.inclusive) for side in read.thresholds}
        lines = []
        match read.terms:
            case ((1, ltl.QuantityTerm() as first), (-1, ltl.QuantityTerm() as second)) if all(
                limit == 0 for limit, _ in flags
            ):
                # Which of two decimals is the greater their doubles say, too.
                sides = sum(1 if inclusive else 2 for _, inclusive in flags)
                pair = [self._value(one.name, one.arguments, inner) for one in (first, second)]
                lines.append(f"return rulec_order({pair[0]}, {pair[1]}, {sides}u);")
            case _:
                lines += self._weighed(read, inner)
        parameters = "".join(f", size_t {inner[variable]}" for variable in free)
        name = self._function("uint16_t", "sum", parameters, "\n    ".join(lines))
        arguments = "".join(f", {places[variable]}" for variable in free)
        return f"{name}(in{arguments})"

    def _weighed(self, read: NumberRead, places: Places) -> list[str]:
        size = len(read.terms)
        counting = any(isinstance(term, ltl.Count) for _, term in read.terms)
        high = "high" if counting else "low"
        lines = [f"double low[{size}u];", *[f"double high[{size}u];"] * counting]
        for number, (_, term) in enumerate(read.terms):
            match term:
                case ltl.QuantityTerm(name, arguments):
                    value = self._value(name, arguments, places)
                    lines.append(f"low[{number}u] = {value};")
                    lines += [f"high[{number}u] = low[{number}u];"] * counting
                case ltl.Count():
                    # After all declarations of the block
                    lines.insert(2, f"const uint32_t count{number} = {self._count(term, places)};")
                    lines += [
                        f"low[{number}u] = (double)(count{number} & 0xffffu);",
                        f"high[{number}u] = (double)(count{number} >> 16);",
                    ]
        return [*lines, f"return rulec_weigh(low, {high}, &{self._shape(read)});"]

    def _shape(self, read: NumberRead) -> str:
        """The factors and limits of a sum, also as whole numbers if they are small enough."""
        factors = [factor for factor, _ in read.terms]
        limits = [side.limit for side in read.thresholds]
        if len(factors) > MOST_DIGITS or not all(map(_is_double, [*factors, *limits])):
            raise too_large("a sum has too many terms, or too large ones")
        inclusive = [f"{int(side.inclusive)}u" for side in read.thresholds]
        common = lcm(*[number.denominator for number in (*factors, *limits)])
        whole = [int(factor * common) for factor in factors]
        bounds = [int(limit * common * 8) for limit in limits]
        fits = (
            len(factors) <= 32
            and max(map(abs, whole)) <= _LARGEST_FACTOR
            and max(map(abs, bounds)) <= _LARGEST_LIMIT
        )
        parts = [
            self._array("double", "factors", [float(factor).hex() for factor in factors]),
            self._array("double", "limits", [float(limit).hex() for limit in limits]),
            self._array("uint8_t", "inclusive", inclusive),
            self._array("int64_t", "whole", [f"INT64_C({n})" for n in whole]) if fits else "NULL",
            self._array("int64_t", "whole", [f"INT64_C({n})" for n in bounds]) if fits else "NULL",
            f"{len(factors)}u",
            f"{len(limits)}u",
        ]
        return self._defined(
            "shape", f"static const rulec_shape {{}} = {{{{{', '.join(parts)}}}}};"
        )

    def _array(self, kind: str, about: str, items: Sequence[str]) -> str:
        content = ", ".join(items)
        return self._defined(about, f"static const {kind} {{}}[{len(items)}u] = {{{{{content}}}}};")

    def _function(self, kind: str, about: str, parameters: str, code: str) -> str:
        return self._defined(
            about,
            f"static {kind} {{}}(const rulec_input *in{parameters})\n"
            f"{{{{\n    {code.replace('{', '{{').replace('}', '}}')}\n}}}}",
        )

    def _defined(self, about: str, pattern: str) -> str:
        """The name of what is defined by this; the same has been defined once."""
        if pattern not in self._named:
            name = self._named[pattern] = f"rulec_{about}_{len(self._named)}"
            self.definitions.append(pattern.format(name))
        return self._named[pattern]


def _is_double(number: Fraction) -> bool:
    try:
        return isfinite(float(number)) and abs(float(number)) < _FAR
    except OverflowError:
        return False
