"""A query: a formula whose moments in traces are searched for."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.rulebook.rulebook_model import Rule, Semantics, Traffic
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class FormulaQuery:
    """A formula with its variables, as a ``rule``, in the words of a vocabulary.

    ``semantics`` says how a trace ends, ``traffic`` the side on which traffic drives.
    """

    __repr__ = short_repr

    text: str
    rule: Rule
    vocabulary: Vocabulary
    semantics: Semantics
    traffic: Traffic
