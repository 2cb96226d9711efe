"""The rules of a compiled rulebook's file, each proved or not; nothing but the file is read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from hashlib import sha256
from typing import Any, Literal

from rulec.validation.clock_proof import proof_steps, prove_clocks
from rulec.validation.comparison_words import check_comparison
from rulec.validation.cut_proof import prove_cut_table
from rulec.validation.demands import Demands
from rulec.validation.excluded_letters import possible_letters
from rulec.validation.formula_progression import FormulaProgression
from rulec.validation.formula_words import comparisons_in, formula_words
from rulec.validation.hoa_proof import prove_hoa
from rulec.validation.letter_sets import Letters
from rulec.validation.parts_proof import prove_parts
from rulec.validation.table_proof import FormulaMachine, prove_table
from rulec.validation.unprovable import UnprovableError, exact, require

VERSION = 7


class UnreadableError(Exception):
    """A file that is not of version 7, or has been changed since it was written (``changed``)."""

    def __init__(self, why: Literal["changed", "unreadable"], message: str) -> None:
        super().__init__(message)
        self.why = why


@dataclass(frozen=True, slots=True)
class RuleProof:
    """The result for a rule; ``because`` is empty if its tables are proved.

    ``step_s`` is the time step that the rule is compiled for, as the file spells it. ``word`` holds
    the states of a shortest trace that is judged otherwise, if there is one. ``agreed``: according
    to the file, two compilers have produced this table.
    """

    rule: str
    step_s: str | None
    because: str
    word: tuple[Mapping[str, str], ...] = ()
    agreed: bool = False


def proofs_of(data: bytes) -> list[RuleProof]:
    """The result for each rule of a file. Raises UnreadableError."""
    book = _read(data)
    try:
        return [proof_of(rule, book) for rule in book["rules"]]
    except (KeyError, TypeError):
        raise UnreadableError("unreadable", "it has no rules") from None


def _read(data: bytes) -> Any:
    head, _, rest = data.partition(b"\n")
    second, _, body = rest.partition(b"\n")
    digest = b' "sha256": "%s",' % sha256(body).hexdigest().encode()
    try:
        book = json.loads(data, object_pairs_hook=_object, parse_constant=_no_number)
    except (ValueError, RecursionError):
        raise UnreadableError("unreadable", "it is not the JSON of a compiled rulebook") from None
    if not isinstance(book, dict) or book.get("format") != "rulec compiled rulebook":
        raise UnreadableError("unreadable", "it is not a compiled rulebook")
    if book.get("version") != VERSION:
        raise UnreadableError("unreadable", f"it is not of version {VERSION}")
    if (head, second) != (b"{", digest):
        raise UnreadableError("changed", "its digest does not match its content")
    return book


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object; ValueError for a repeated name, of which readers may take either value."""
    if len(dict(pairs)) < len(pairs):
        raise ValueError("a name is there twice")
    return dict(pairs)


def _no_number(text: str) -> float:
    raise ValueError(text)


def proof_of(rule: Any, book: Mapping[str, Any]) -> RuleProof:
    """The result for one rule's entry of a book that has been read."""
    name, step = str(rule["name"]), rule["step_s"]
    try:
        _prove(rule, book)
    except UnprovableError as problem:
        return RuleProof(name, step, problem.reason, problem.word)
    except RecursionError:
        return RuleProof(name, step, "its formula is nested too deep for this checker")
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as problem:
        kind = type(problem).__name__.removesuffix("Error").lower()
        return RuleProof(name, step, f"its entry does not follow the format ({kind} {problem})")
    return RuleProof(name, step, "", agreed=bool(rule.get("certificate")))


def _prove(rule: Mapping[str, Any], book: Mapping[str, Any]) -> None:
    """Raise UnprovableError unless all of a rule's tables do what its formula says."""
    declarations = book["vocabulary"]["declarations"]
    tree, machine = rule["tree"], rule["machine"]
    require(formula_words(tree) == rule["formula"], "its formula in words differs from its tree")
    units = {item["name"]: item["unit"] for item in declarations if item["kind"] == "quantity"}
    for comparison in comparisons_in(tree):
        check_comparison(comparison, units)
    letters = Letters(machine["reads"], {item["name"]: item for item in declarations})
    possible = possible_letters(letters, book, rule)
    require(possible != 0, "its facts exclude every letter")
    require(book["semantics"] in ("stutter", "finite"), "its semantics is not a known one")
    ends = book["semantics"] == "finite"

    def machine_at(step: Fraction | None) -> FormulaMachine:
        demands = Demands(possible)
        root = demands.read(tree, step, lambda atom: letters.of(atom) & possible)
        return FormulaMachine(FormulaProgression(demands, root), possible, ends=ends)

    formula = machine_at(None if rule["step_s"] is None else exact(rule["step_s"]))
    prove_table(formula, machine, letters)
    table = machine["letters"], machine["following"], machine["accepting"]
    same = rule.get("certificate", "") in ("", table_digest(*table))
    require(same, "its certificate belongs to another table")
    prove_parts(rule)
    if rule.get("cut") is not None:
        prove_cut_table(formula, rule["cut"], letters, goes_on=_goes_on(rule))
    if rule.get("clocked") is not None:
        for step in proof_steps(tree):
            prove_clocks(rule["clocked"], machine_at(step), step, ends=ends)
    prove_hoa(formula, rule["hoa"], tree, letters, ends=ends)


def _goes_on(rule: Mapping[str, Any]) -> bool:
    """Whether a cut trace may begin within a sequence of this rule, which was kept before.

    That is asked of what the rule requires: with exceptions or a condition, the phases of a
    sequence may be written by other operators in the tree.
    """
    parts = rule.get("parts")
    tree = rule["tree"] if parts is None else parts["required"]
    is_one = isinstance(tree, list) and tree[0] in ("always", "never") and len(tree) == 2
    return is_one and not rule["variables"] and "then" in _operators(tree)


def _operators(tree: Any) -> Iterator[str]:
    if isinstance(tree, list):
        yield tree[0]
        for part in tree[1:]:
            yield from _operators(part)


def table_digest(letters: Any, following: Any, accepting: Any) -> str:
    """The SHA-256 of a table as JSON without spaces: its letters, its successors, its verdicts."""
    table = json.dumps([letters, following, accepting], separators=(",", ":"))
    return sha256(table.encode()).hexdigest()
