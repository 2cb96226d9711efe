"""A rulebook as meant: names resolved, types checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

from rulec.diagnostics import Span
from rulec.logic.formula import Formula
from rulec.value_display import Rows, short_repr
from rulec.vocabulary import Vocabulary

Strength = Literal["hard", "soft"]


@dataclass(frozen=True, slots=True)
class Variable:
    """``name: type`` in a rule's head."""

    name: str
    type: str


Semantics = Literal["stutter", "finite"]
"""How a finite trace ends: its last state goes on for ever, or nothing comes after it."""

Traffic = Literal["", "left", "right"]
"""The side on which traffic drives; empty if the rulebook does not say."""

Certainty = Literal["", "verified", "secondary", "unverified"]

ExampleState = Mapping[tuple[str, tuple[str, ...]], bool | str | float]
"""(declaration, variables) -> value: what one state of an example mentions."""


@dataclass(frozen=True, slots=True)
class Example:
    """Trace that its rule must accept or reject. Unmentioned values take their defaults."""

    __repr__ = short_repr

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    objects: tuple[Variable, ...] = ()
    """Objects that are there besides those that the rule's variables name."""
    span: Span | None = field(default=None, compare=False, repr=False)
    state_spans: tuple[Span, ...] = field(default=(), compare=False, repr=False)
    """Where each state is written; empty for an example that was not read from a text."""


ExemptionScope = Literal["initially", "at start", "throughout", "at some point", "at end"]


@dataclass(frozen=True, slots=True)
class Exemption:
    """Exception to a rule where ``formula`` holds within ``scope``; see ``exemptions``."""

    formula: Formula
    scope: ExemptionScope


@dataclass(frozen=True, slots=True)
class RuleParts:
    """What a rule requires, where it is exempt from that, and the condition under which it counts.

    The rule's formula has all of them worked in.
    """

    required: Formula
    exemptions: tuple[Exemption, ...] = ()
    condition: Formula | None = None


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. Without variables it speaks of ego and the world alone.

    ``formula`` is all of it, exceptions included; its bounds may be in seconds. ``level`` is its
    place in the rulebook's priorities, empty if it has none. ``book`` is the rulebook that it is
    written in. The states of its examples are ``step_s`` seconds apart. ``required`` is the formula
    without its exemptions and the condition (``when``) under which it is in force; None where there
    are none. ``inherited_from`` is the rulebook whose law it is, which last gave it a provision, if
    the rulebook at hand has not confirmed that it is its own law, too; else empty.
    """

    __repr__ = short_repr

    name: str
    strength: Strength
    variables: tuple[Variable, ...]
    formula: Formula
    cite: str = ""
    says: str = ""
    examples: tuple[Example, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)
    level: str = ""
    weight: Fraction = Fraction(1)
    source: str = ""
    certainty: Certainty = ""
    in_force_from: str = ""
    in_force_until: str = ""
    book: str = ""
    step_s: Fraction = Fraction(1)
    required: Formula | None = None
    exemptions: tuple[Exemption, ...] = ()
    condition: Formula | None = None
    inherited_from: str = ""
    topics: tuple[str, ...] = ()


def parts_of(rule: Rule) -> RuleParts | None:
    """The parts of a rule; None if it is nothing but what it requires."""
    if rule.required is None:
        return None
    return RuleParts(rule.required, rule.exemptions, rule.condition)


def cited_law(cite: str, inherited_from: str) -> str:
    """A rule's provision; whose it is where the rulebook has not confirmed the rule."""
    return f"inherited, not confirmed: {inherited_from} {cite}".rstrip() if inherited_from else cite


def provision_note(rule: str, cite: str) -> str:
    """What is said below a finding within a rule: which provision that is."""
    return f"rule `{rule}` is {cite}"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """Source file of a rulebook: base name and SHA-256 of content."""

    name: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Axiom:
    """Axiom: a formula that holds in every state, for distinct objects."""

    variables: tuple[Variable, ...]
    formula: Formula
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Remark:
    """Remark, with its reason, on a changed rule or silent topic; ``book`` makes it."""

    name: str
    because: str
    kind: Literal["dropped", "silent", "softened"]
    book: str


@dataclass(frozen=True, slots=True)
class Topic:
    """What rules can be about, such as zebra crossings."""

    name: str
    title: str


Treatment = Literal["to do", "silent", "not machine-readable"]


@dataclass(frozen=True, slots=True)
class Provision:
    """An article of the rulebook's law, in the text of a day (ISO); ``link`` is its official page.

    ``number`` is how rules cite it. ``treatment`` is what becomes of it as long as no rule does,
    and ``because`` why; ``certainty`` is how sure number and heading are.
    """

    number: str
    heading: str
    link: str = ""
    as_of: str = ""
    treatment: Treatment = "to do"
    because: str = ""
    certainty: Certainty = ""


@dataclass(frozen=True)
class Rulebook(Rows):
    """A jurisdiction's rules over one vocabulary.

    ``priorities`` is a pre-order of levels: all pairs (higher, lower), transitive; levels that are
    equal stand in both orders. ``extends`` are the rulebooks that it builds upon, nearest first.
    ``at`` is the day (ISO) whose law it is: what was not in force then has been left out.
    ``topics`` are those of its chain, ``provisions`` the articles of its own law.
    """

    __repr__ = short_repr

    name: str
    vocabulary: Vocabulary
    rules: tuple[Rule, ...]
    title: str = ""
    law: str = ""
    as_of: str = ""
    sources: tuple[SourceFile, ...] = ()
    semantics: Semantics = "stutter"
    traffic: Traffic = ""
    extends: tuple[str, ...] = ()
    levels: tuple[str, ...] = ()
    priorities: frozenset[tuple[str, str]] = frozenset()
    remarks: tuple[Remark, ...] = ()
    at: str = ""
    axioms: tuple[Axiom, ...] = ()
    topics: tuple[Topic, ...] = ()
    provisions: tuple[Provision, ...] = ()

    def rows(self) -> list[dict[str, Any]]:
        """One row a rule."""
        return rule_rows(self.rules)


def rule_rows(rules: Iterable[Any]) -> list[dict[str, Any]]:
    """One row a rule, of a rulebook's rules or of compiled ones."""
    columns = ("strength", "level", "cite", "says", "book")
    return [{"rule": x.name, **{column: getattr(x, column) for column in columns}} for x in rules]
