"""A compiled rulebook: all that running needs, and where it came from."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.automata.machine import Machine
from rulec.logic.formula import Formula
from rulec.rulebook.model import SourceFile, Strength, Variable
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class CompiledRule:
    """A rule with its machine; ``hoa`` is its automaton in HOA v1."""

    name: str
    strength: Strength
    variables: tuple[Variable, ...]
    cite: str
    says: str
    formula: Formula
    machine: Machine
    hoa: str


@dataclass(frozen=True, slots=True)
class CompiledRulebook:
    """The rules of a rulebook as machines, with the vocabulary that their traces are written in.

    ``rulec`` and ``spot`` are the versions that compiled it.
    """

    name: str
    vocabulary: Vocabulary
    rules: tuple[CompiledRule, ...]
    title: str
    law: str
    as_of: str
    sources: tuple[SourceFile, ...]
    rulec: str
    spot: str
