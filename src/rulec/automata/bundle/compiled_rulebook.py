"""A compiled rulebook: all that running needs, and where it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.diagnostics import SourceLocation
from rulec.logic.formula import Formula
from rulec.rulebook.model import Certainty, Semantics, SourceFile, Strength, Traffic, Variable
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class CompiledRule:
    """A rule with its machine; ``hoa`` is its automaton in HOA v1.

    ``step_s`` is the step of the traces that the machine can judge; None if it can judge any,
    because the formula has no bounds in seconds.
    """

    name: str
    strength: Strength
    variables: tuple[Variable, ...]
    cite: str
    says: str
    formula: Formula
    machine: MealyMonitor
    hoa: str
    step_s: Fraction | None = None
    level: str = ""
    weight: Fraction = Fraction(1)
    source: str = ""
    certainty: Certainty = ""
    book: str = ""


@dataclass(frozen=True, slots=True)
class CompiledAxiom:
    """What holds in every state, and where it is written."""

    variables: tuple[Variable, ...]
    formula: Formula
    place: SourceLocation | None = field(default=None, compare=False)


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
    semantics: Semantics = "stutter"
    levels: tuple[str, ...] = ()
    priorities: frozenset[tuple[str, str]] = frozenset()
    extends: tuple[str, ...] = ()
    at: str = ""
    axioms: tuple[CompiledAxiom, ...] = ()
    traffic: Traffic = ""
