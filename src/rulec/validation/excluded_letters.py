"""The letters that are possible for a rule's variables, given a vocabulary's facts.

Every fact holds for all distinct objects of its types, and so for every fitting assignment of a
rule's variables. Facts with words in common are evaluated together over all their words, whether
the table reads them or not: a letter is possible if some values of all these words go with it.
Digits that the formula does not distinguish count as one, as in the compiler.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise, product
from math import prod
from typing import Any

from rulec.validation.formula_words import atoms_in, term_words
from rulec.validation.letter_sets import TRUE_FOR, DigitRead, Letters, subject
from rulec.validation.unprovable import UnprovableError, exact, require

MOST_CASES = 1 << 16
"""The greatest number of cases of facts examined for one table."""


def possible_letters(letters: Letters, book: Mapping[str, Any], rule: Mapping[str, Any]) -> int:
    """The letters in which every fact of a book, except those that count objects, holds."""
    vocabulary = {item["name"]: item for item in book["vocabulary"]["declarations"]}
    types = book["vocabulary"]["types"]
    instances = [
        instance
        for fact in book["facts"]
        if not _counts(fact["tree"])
        for instance in _instances(fact, rule["variables"], types)
    ]
    possible = letters.everything
    for group in _linked(instances):
        possible &= _of_group(letters, group, list(atoms_in(rule["tree"])), vocabulary)
    return possible


def _counts(tree: Any) -> bool:
    return any("count" in term for atom in atoms_in(tree) for _, term in atom.get("terms", ()))


def _instances(
    fact: Mapping[str, Any],
    variables: Sequence[Sequence[str]],
    types: Mapping[str, str | None],
) -> Iterator[Any]:
    fitting = [
        [name for name, own in variables if _is_below(own, wanted, types)]
        for _, wanted in fact["variables"]
    ]
    for chosen in product(*fitting):
        if len(set(chosen)) == len(chosen):
            names = dict(zip([name for name, _ in fact["variables"]], chosen, strict=True))
            yield _renamed(fact["tree"], names)


def _is_below(kind: str | None, wanted: str, types: Mapping[str, str | None]) -> bool:
    seen = set()
    while kind is not None and kind not in seen:
        if kind == wanted:
            return True
        seen.add(kind)
        kind = types[kind]
    return False


def _renamed(tree: Any, names: Mapping[str, str]) -> Any:
    if isinstance(tree, list):
        return [tree[0], *[_renamed(part, names) for part in tree[1:]]]
    if not isinstance(tree, dict):
        return tree
    if "terms" not in tree:
        return {**tree, "variables": [names[name] for name in tree["variables"]]}
    terms = [
        (exact(factor), {**term, "variables": [names[name] for name in term["variables"]]})
        for factor, term in tree["terms"]
    ]
    # New names may sort differently, and the first factor has to be 1.
    terms.sort(key=lambda pair: term_words(pair[1]))
    first = terms[0][0]
    relation = tree["relation"]
    if first < 0:
        relation = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}.get(relation, relation)
    normal = [[str(factor / first), term] for factor, term in terms]
    return {"terms": normal, "relation": relation, "limit": str(exact(tree["limit"]) / first)}


def _linked(instances: Sequence[Any]) -> list[list[Any]]:
    """The instances in groups that have no word in common."""
    groups: list[tuple[set[Any], list[Any]]] = []
    for instance in instances:
        about, members = {subject(atom) for atom in atoms_in(instance)}, [instance]
        for group in [group for group in groups if group[0] & about]:
            groups.remove(group)
            about, members = about | group[0], [*group[1], *members]
        groups.append((about, members))
    return [members for _, members in groups]


def _of_group(
    letters: Letters, group: Sequence[Any], told_atoms: Sequence[Any], vocabulary: Mapping[str, Any]
) -> int:
    """The letters that go with some values of all the words that a group of facts mentions."""
    atoms: dict[Any, list[Any]] = {}
    for instance in group:
        for atom in atoms_in(instance):
            atoms.setdefault(subject(atom), []).append(atom)
    reads = {read.about: read for read in letters.reads if read.about in atoms}
    if not reads:
        return letters.everything
    domains = [
        _values(own, reads[about].entry if about in reads else None, vocabulary)
        for about, own in atoms.items()
    ]
    require(
        prod(map(len, domains)) <= MOST_CASES,
        "its facts have more cases than this checker examines",
    )
    alike = {read.about: _alike(letters, read, told_atoms) for read in reads.values()}
    possible_sides: set[tuple[int, ...]] = set()
    for case in product(*domains):
        values = dict(zip(atoms, case, strict=True))
        sides = tuple(
            [alike[about][letters.digit(read, values[about])] for about, read in reads.items()]
        )
        if sides not in possible_sides and all(_holds(instance, values) for instance in group):
            possible_sides.add(sides)
    possible = 0
    for sides in possible_sides:
        here = letters.everything
        for read, side in zip(reads.values(), sides, strict=True):
            digits = [digit for digit, own in enumerate(alike[read.about]) if own == side]
            here &= letters.where(read, digits)
        possible |= here
    return possible


def _alike(letters: Letters, read: DigitRead, atoms: Sequence[Any]) -> list[int]:
    """For each digit of a read, the first digit that the formula does not distinguish from it."""
    own = [letters.of(atom) for atom in atoms if subject(atom) == read.about]
    truths = [
        tuple([true >> digit * read.stride & 1 for true in own]) for digit in range(read.size)
    ]
    return [truths.index(each) for each in truths]


def _values(atoms: Sequence[Any], read: Any, vocabulary: Mapping[str, Any]) -> list[Any]:
    """Values of one subject that cover everything that facts and a table distinguish."""
    if "terms" not in atoms[0]:
        declared = vocabulary[atoms[0]["name"]]
        return list(declared["values"]) if declared["kind"] == "enumeration" else [False, True]
    limits = {exact(atom["limit"]) for atom in atoms}
    limits |= {exact(item["limit"]) for item in (read["thresholds"] if read else ())}
    ordered = sorted(limits)
    between = [(first + second) / 2 for first, second in pairwise(ordered)]
    return [ordered[0] - 1, *ordered, *between, ordered[-1] + 1]


def _holds(tree: Any, values: Mapping[Any, Any]) -> bool:
    if isinstance(tree, bool):
        return tree
    if isinstance(tree, dict):
        value = values[subject(tree)]
        if "terms" in tree:
            return TRUE_FOR[tree["relation"]](value, exact(tree["limit"]))
        return bool(value == tree["value"]) if tree["value"] is not None else bool(value)
    operator, *operands = tree
    truths = [_holds(operand, values) for operand in operands]
    match operator, truths:
        case "not", [only]:
            return not only
        case "and", [left, right]:
            return left and right
        case "or", [left, right]:
            return left or right
        case "implies", [left, right]:
            return right or not left
        case "iff", [left, right]:
            return left == right
        case "xor", [left, right]:
            return left != right
    raise UnprovableError("a fact is about more than one state")
