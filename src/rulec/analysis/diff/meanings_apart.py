"""Words that two rulebooks define differently, as two words, one of which may imply the other.

The same expression with another parameter is ordered by it, if no number in it is negative.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import TypeAlias

from rulec.logic import formula as ltl
from rulec.logic.formula import operands_of, with_parts
from rulec.logic.free_names import names_of, rename_variables
from rulec.rulebook.rulebook_model import Axiom, Rulebook, Variable
from rulec.vocabulary import Signal
from rulec.vocabulary.vocabulary_model import Meaning

Implied: TypeAlias = set[tuple[str, str]]
"""Words, and words that hold whenever these do."""


def words_apart(first: Rulebook, second: Rulebook) -> frozenset[str]:
    """The words that two rulebooks define differently, or by words that they do."""
    own, theirs = first.vocabulary, second.vocabulary
    apart: set[str] = set()
    for name, meaning in own.meanings.items():
        other, declared = theirs.meanings.get(name), own.declarations[name]
        if other is None or declared != theirs.declarations.get(name):
            continue
        is_other = _of_places(meaning) != _of_places(other)
        if isinstance(declared, Signal) and (is_other or not apart.isdisjoint(meaning.reads)):
            apart.add(name)
    return frozenset(apart)


def with_words_apart(first: Rulebook, second: Rulebook) -> tuple[Rulebook, Rulebook]:
    """The rulebooks, in which words with two meanings are two words with what is known of both."""
    different = words_apart(first, second)
    apart: dict[str, tuple[str, str]] = {}
    axioms: list[Axiom] = []
    implied: set[tuple[str, str]] = set()
    # In this order a word comes after those that it is defined by
    for name in (name for name in first.vocabulary.meanings if name in different):
        meanings = [book.vocabulary.meanings[name] for book in (first, second)]
        names = [_named(name, book) for book in (first, second)]
        own, theirs = (
            _with_names(_of_places(each), {word: both[side] for word, both in apart.items()})
            for side, each in enumerate(meanings)
        )
        apart[name] = names[0], names[1]
        kinds = first.vocabulary.declarations[name].parameters
        variables = [Variable(f"x{place}", kind) for place, kind in enumerate(kinds, 1)]
        words = [ltl.Atom(word, tuple([each.name for each in variables])) for word in names]
        for cause, effect in _implications((own, theirs), words, implied):
            implied.add((cause.name, effect.name))
            follows = ltl.Binary(ltl.BinaryOperator.IMPLIES, cause, effect)
            axioms.append(Axiom(tuple(variables), follows))
    if not apart:
        return first, second
    first, second = (
        _with_words(book, {name: own[which] for name, own in apart.items()}, apart, axioms)
        for which, book in enumerate((first, second))
    )
    return first, second


def _named(name: str, book: Rulebook) -> str:
    n_objects = len(book.vocabulary.declarations[name].parameters)
    places = ", ".join(f"x{place}" for place in range(1, n_objects + 1))
    return f"{name}({places}) in {book.name}" if places else f"{name} in {book.name}"


def _of_places(meaning: Meaning) -> ltl.Formula:
    names = {name: f"x{place}" for place, name in enumerate(meaning.variables, 1)}
    formula: ltl.Formula = rename_variables(meaning.formula, names)
    return formula


def _with_words(
    book: Rulebook,
    own: dict[str, str],
    apart: dict[str, tuple[str, str]],
    axioms: list[Axiom],
) -> Rulebook:
    """The rulebook with its ``own`` words in place of those that mean two things."""
    declared = dict(book.vocabulary.declarations)
    for name, both in apart.items():
        declared |= {word: replace(declared[name], name=word) for word in both}
    rules = tuple([replace(rule, formula=_with_names(rule.formula, own)) for rule in book.rules])
    known = [replace(axiom, formula=_with_names(axiom.formula, own)) for axiom in book.axioms]
    vocabulary = replace(book.vocabulary, declarations=declared)
    return replace(book, vocabulary=vocabulary, rules=rules, axioms=(*known, *axioms))


def _with_names(formula: ltl.Formula, names: dict[str, str]) -> ltl.Formula:
    match formula:
        case ltl.Calculated(name=name) if name in names:
            return ltl.Atom(names[name], formula.arguments)
        case ltl.Calculated() if read := names_of(formula) & names.keys():
            # Not looked into: another word for each choice of what it counts by
            spelled = f"{formula.name} by {', '.join(names[word] for word in sorted(read))}"
            return ltl.Atom(spelled, formula.arguments)
        case ltl.Atom(name=name) if name in names:
            return replace(formula, name=names[name])
    return with_parts(formula, lambda part: _with_names(part, names))


def _implications(
    formulas: tuple[ltl.Formula, ltl.Formula], words: list[ltl.Atom], known: Implied
) -> Iterator[tuple[ltl.Atom, ltl.Atom]]:
    own, theirs = formulas
    for cause, effect, pair in ((own, theirs, words), (theirs, own, words[::-1])):
        if _implies(cause, effect, known):
            yield pair[0], pair[1]


def _implies(cause: ltl.Formula, effect: ltl.Formula, known: Implied) -> bool:
    """Whether a formula surely implies one of the same form; False where the form tells nothing."""
    if cause == effect:
        return True
    match cause, effect:
        case (
            ltl.Comparison(((_, ltl.Count() as own),), relation),
            ltl.Comparison(((_, ltl.Count() as other),)),
        ) if cause == replace(effect, terms=cause.terms) and relation not in ("=", "!="):
            # The more objects count, the sooner there are enough
            bodies = (own, other) if relation[0] == ">" else (other, own)
            return replace(own, body=other.body) == other and _implies(
                bodies[0].body, bodies[1].body, known
            )
        case ((ltl.Comparison() | ltl.Calculated()), (ltl.Comparison() | ltl.Calculated())):
            less = _ends(_compared(effect), _compared(cause))
            return less is not None and _is_within(cause.relation, effect.relation, less)
        case ltl.Atom(), ltl.Atom() if cause.arguments == effect.arguments:
            return (cause.name, effect.name) in known
        case ltl.Unary(), ltl.Unary() if cause.operator is effect.operator:
            return _in_order(cause, effect, known)
        case ltl.Binary(), ltl.Binary() if cause.operator is effect.operator:
            return _in_order(cause, effect, known)
    return False


_GROWS: dict[ltl.UnaryOperator | ltl.BinaryOperator, tuple[bool, ...]] = {
    ltl.UnaryOperator.NOT: (False,),
    ltl.UnaryOperator.ONCE: (True,),
    ltl.UnaryOperator.HISTORICALLY: (True,),
    ltl.UnaryOperator.PREVIOUSLY: (True,),
    ltl.UnaryOperator.WEAK_PREVIOUSLY: (True,),
    ltl.BinaryOperator.AND: (True, True),
    ltl.BinaryOperator.OR: (True, True),
    ltl.BinaryOperator.IMPLIES: (False, True),
    ltl.BinaryOperator.SINCE: (True, True),
}
"""Whether an operation can only become true when its operand does; else only when it does not."""


def _in_order(
    cause: ltl.Unary | ltl.Binary, effect: ltl.Unary | ltl.Binary, known: Implied
) -> bool:
    grows = _GROWS.get(cause.operator)
    if grows is None:
        return False
    operands = zip(grows, operands_of(cause), operands_of(effect), strict=True)
    return all(_implies(*((x, y) if up else (y, x)), known) for up, x, y in operands) and (
        cause.bound == effect.bound or _is_looser(cause, effect)
    )


def _is_looser(cause: ltl.Unary | ltl.Binary, effect: ltl.Unary | ltl.Binary) -> bool:
    """Whether another bound makes the effect no harder: `once` may look at more states."""
    own, other = cause.bound, effect.bound
    if own is None or other is None or own.unit != other.unit:
        return False
    if cause.operator is ltl.UnaryOperator.HISTORICALLY:
        own, other = other, own
    elif cause.operator not in (ltl.UnaryOperator.ONCE, ltl.BinaryOperator.SINCE):
        return False
    highs = [inf if bound.high is None else bound.high for bound in (own, other)]
    return other.low <= own.low and highs[0] <= highs[1]


def _is_within(first: ltl.Relation, second: ltl.Relation, room: Fraction) -> bool:
    """Whether a number in the first relation to a limit is in the second to one ``room`` higher."""
    if first[0] != second[0] or first in ("=", "!="):
        return False
    room = room if first[0] == "<" else -room
    return room > 0 or (room == 0 and (first == second or len(first) == 1))


def _compared(comparison: ltl.Comparison | ltl.Calculated) -> ltl.NumberSum:
    """The number that is compared with 0."""
    if isinstance(comparison, ltl.Calculated):
        return comparison.number
    return ltl.NumberSum(comparison.terms, -comparison.limit)


def _ends(number: ltl.NumberSum, other: ltl.NumberSum) -> Fraction | None:
    """A number that has the sign of ``other - number`` if no quantity is negative; else None."""
    parts: dict[ltl.Term | ltl.Operation, Fraction] = {}
    for sign, own in ((1, other), (-1, number)):
        for factor, part in own.parts:
            share, rest = _factored(part)
            parts[rest] = parts.get(rest, Fraction(0)) + sign * factor * share
    differing = {part: factor for part, factor in parts.items() if factor}
    if not all(map(_is_nonnegative, differing)):
        return None
    signs = {-1 if factor < 0 else 1 for factor in differing.values()}
    constant = other.constant - number.constant
    signs |= {-1 if constant < 0 else 1} if constant else set()
    return Fraction(signs.pop() if signs else 0) if len(signs) < 2 else None


def _is_nonnegative(part: ltl.Term | ltl.Operation) -> bool:
    """Whether a part cannot be negative if no quantity is: no difference is a factor of it."""
    if not isinstance(part, ltl.Operation) or (part.operator == "*" and part.left == part.right):
        return True
    return all(
        side.constant >= 0
        and all(factor >= 0 and _is_nonnegative(each) for factor, each in side.parts)
        for side in (part.left, part.right)
    )


def _factored(part: ltl.Term | ltl.Operation) -> tuple[Fraction, ltl.Term | ltl.Operation]:
    """A product of multiples as a multiple of a product."""
    if not isinstance(part, ltl.Operation):
        return Fraction(1), part
    share = Fraction(1)
    sides: list[ltl.NumberSum] = []
    for side in (part.left, part.right):
        lead = side.parts[0][0] if side.parts else side.constant or Fraction(1)
        share = share * lead if part.operator == "*" or not sides else share / lead
        own = tuple([(factor / lead, each) for factor, each in side.parts])
        sides.append(ltl.NumberSum(own, side.constant / lead))
    return share, ltl.Operation(part.operator, sides[0], sides[1])
