"""Conditions of an automaton's edges as short text, and states as in examples."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.guards import Cube
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.diagnostics.phrases import any_of
from rulec.logic.formula import Atom, Comparison, Count, QuantityTerm, Relation, atoms_of
from rulec.logic.linear_comparison import DENIED
from rulec.logic.sentences.wording import comparison_text, number_text, terms_text
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity

_OF_WHOLE_NUMBERS: dict[Relation, tuple[Relation, int]] = {
    "<": ("<=", -1),
    "<=": ("<", 1),
    ">": (">=", 1),
    ">=": (">", -1),
}
"""For whole numbers `< 2` is the same as `<= 1`."""

_SIGN = re.compile(r"<=|>=|!=|<|>|=")


class GuardWording:
    """The texts for what a rule reads and for its comparisons."""

    def __init__(self, rule: CompiledRule, vocabulary: Vocabulary) -> None:
        self._reads = rule.machine.reads
        self._vocabulary = vocabulary
        self._said: dict[tuple[object, ...], str] = {}
        for atom in atoms_of(rule.formula):
            if isinstance(atom, Comparison):
                text = comparison_text(atom)
                for relation, limit in _alike(atom):
                    self._said[atom.terms, relation, limit] = text
                    self._said.setdefault((atom.terms, DENIED[relation], limit), _denied(text))

    def condition(self, cubes: Sequence[Cube]) -> str:
        """A condition that holds exactly for the letters of these cubes; ``true`` for all."""
        texts = []
        for cube in cubes:
            literals = [
                self._literal(read, allowed)
                for read, allowed in zip(self._reads, cube, strict=True)
                if len(allowed) < read.size
            ]
            simple = [
                f"({literal})" if loose and len(literals) > 1 else literal
                for literal, loose in literals
            ]
            text = " and ".join(simple) or "true"
            loose = len(literals) > 1 or any(is_loose for _, is_loose in literals)
            texts.append(f"({text})" if loose and len(cubes) > 1 else text)
        return " or ".join(texts) or "false"

    def _literal(self, read: Read | NumberRead, allowed: frozenset[int]) -> tuple[str, bool]:
        if isinstance(read, NumberRead):
            return self._number(read, allowed)
        subject = Atom(read.name, read.variables)
        if not read.values:
            return f"{'' if 1 in allowed else 'not '}{subject}", False
        declaration = self._vocabulary.declarations[read.name]
        assert isinstance(declaration, Enumeration), "only an enumeration has values"
        inside = [value for value in declaration.values if read.digit(value) in allowed]
        outside = [value for value in declaration.values if read.digit(value) not in allowed]
        if len(inside) == 1:
            return str(Atom(read.name, read.variables, inside[0])), False
        if len(outside) == 1:
            return f"not {Atom(read.name, read.variables, outside[0])}", False
        if len(inside) <= len(outside):
            return f"{subject} is {any_of(inside)}", True
        if len(outside) == 2:
            return f"{subject} is neither {outside[0]} nor {outside[1]}", True
        return f"{subject} is none of {', '.join(outside)}", True

    def _number(self, read: NumberRead, allowed: frozenset[int]) -> tuple[str, bool]:
        left_out = [digit for digit in range(read.size) if digit not in allowed]
        if len(left_out) == 1 and 0 < left_out[0] < read.size - 1:
            lower, upper = read.thresholds[left_out[0] - 1], read.thresholds[left_out[0]]
            if lower.limit == upper.limit:
                return self._compared(read, "!=", lower.limit), False
        texts = [self._run(read, run) for run in runs(sorted(allowed))]
        return " or ".join(texts), len(texts) > 1 or " and " in texts[0]

    def _run(self, read: NumberRead, run: range) -> str:
        lower = read.thresholds[run[0] - 1] if run[0] else None
        upper = read.thresholds[run[-1]] if run[-1] < len(read.thresholds) else None
        if lower and upper and lower.limit == upper.limit:
            return self._compared(read, "=", lower.limit)
        bounds = []
        if lower:
            bounds.append(self._compared(read, ">=" if lower.inclusive else ">", lower.limit))
        if upper:
            bounds.append(self._compared(read, "<" if upper.inclusive else "<=", upper.limit))
        return " and ".join(bounds)

    def _compared(self, read: NumberRead, relation: Relation, limit: Fraction) -> str:
        wording = self._said.get((read.terms, relation, limit))
        if wording is not None:
            return wording
        return f"{terms_text(read.terms)} {relation} {number_text(limit)}{self._unit(read)}"

    def _unit(self, read: NumberRead) -> str:
        match read.terms:
            case ((_, QuantityTerm(name)),):
                declaration = self._vocabulary.declarations[name]
                return f" {declaration.unit}" if isinstance(declaration, DeclaredQuantity) else ""
        return ""


def _alike(comparison: Comparison) -> Iterator[tuple[Relation, Fraction]]:
    """The comparison, and the equivalent one for counts, which are whole numbers."""
    yield comparison.relation, comparison.limit
    match comparison.terms:
        case ((_, Count()),) if (
            comparison.limit.denominator == 1 and comparison.relation in _OF_WHOLE_NUMBERS
        ):
            relation, step = _OF_WHOLE_NUMBERS[comparison.relation]
            yield relation, comparison.limit + step


def runs(numbers: Sequence[int]) -> list[range]:
    """Ascending numbers as ranges of consecutive ones."""
    starts = [n for n, number in enumerate(numbers) if not n or number > numbers[n - 1] + 1]
    ends = [*starts[1:], len(numbers)]
    return [range(numbers[a], numbers[b - 1] + 1) for a, b in zip(starts, ends, strict=False)]


def _denied(text: str) -> str:
    signs = _SIGN.findall(text)
    if len(signs) != 1:
        return f"not ({text})"
    return text.replace(signs[0], DENIED[signs[0]])
