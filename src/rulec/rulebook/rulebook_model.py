"""A resolved rulebook: names resolved, types checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.logic.formula import Atom, Formula
from rulec.value_display import Rows, short_repr
from rulec.vocabulary import Vocabulary

Strength = Literal["hard", "soft"]


@dataclass(frozen=True, slots=True)
class Variable:
    """``name: type`` in a rule's head."""

    name: str
    type: str


Semantics = Literal["stutter", "finite"]
"""How a finite trace ends: its last state is repeated for ever, or nothing follows it."""

Traffic = Literal["", "left", "right"]
"""The side on which traffic drives; empty if the rulebook does not say."""

Certainty = Literal["", "verified", "secondary", "unverified"]

ExampleState = Mapping[tuple[str, tuple[str, ...]], bool | str | float]
"""(declaration, variables) -> value: what one state of an example mentions."""


@dataclass(frozen=True, slots=True)
class Example:
    """A trace that its rule must accept or reject. Unmentioned values have their defaults."""

    __repr__ = short_repr

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    objects: tuple[Variable, ...] = ()
    """The objects present in addition to those that the rule's variables name."""
    span: Span | None = field(default=None, compare=False, repr=False)
    state_spans: tuple[Span, ...] = field(default=(), compare=False, repr=False)
    """The place of each state; empty for an example that was not read from a text."""


ExemptionScope = Literal["initially", "at start", "throughout", "at some point", "at end"]


@dataclass(frozen=True, slots=True)
class Exemption:
    """Exception to a rule where ``formula`` holds within ``scope``; see ``exemptions``."""

    formula: Formula
    scope: ExemptionScope


@dataclass(frozen=True, slots=True)
class RuleParts:
    """What a rule requires, its exemptions, and the condition under which it applies.

    The rule's formula combines all of them.
    """

    required: Formula
    exemptions: tuple[Exemption, ...] = ()
    condition: Formula | None = None


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. Without variables it is only about ego and the world.

    ``formula`` is the whole rule, including exceptions; its bounds may be in seconds. ``level`` is
    its place in the rulebook's priorities, empty if it has none. ``book`` is the rulebook in which
    it is written. The states of its examples are ``step_s`` seconds apart. ``required`` is the
    formula without exemptions and the condition (``when``) under which it is in force; None if
    there are none. ``inherited_from`` is the rulebook whose law it is, which last gave it a
    provision, unless the rulebook at hand has confirmed it as its own law; else empty.
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
    defined: tuple[tuple[Atom, Formula], ...] = field(default=(), compare=False, repr=False)
    """The uses of definitions in its formulas, in the form of atoms, and what they mean."""


def parts_of(rule: Rule) -> RuleParts | None:
    """The parts of a rule; None if it consists only of its requirement."""
    if rule.required is None:
        return None
    return RuleParts(rule.required, rule.exemptions, rule.condition)


def cited_law(cite: str, inherited_from: str) -> str:
    """A rule's provision, with the law's name if the rulebook has not confirmed the rule."""
    return f"inherited, not confirmed: {inherited_from} {cite}".rstrip() if inherited_from else cite


def provision_note(rule: str, cite: str) -> str:
    """The note below a finding within a rule that names its provision."""
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
    """A remark, with its reason, on a changed rule or silent topic; ``book`` makes it."""

    name: str
    because: str
    kind: Literal["dropped", "silent", "softened"]
    book: str


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic that rules can have, such as zebra crossings."""

    name: str
    title: str


Treatment = Literal["to do", "silent", "not machine-readable"]


@dataclass(frozen=True, slots=True)
class Provision:
    """An article of the rulebook's law, in the text of a day (ISO); ``link`` is its official page.

    ``number`` is how rules cite it. ``treatment`` says what becomes of it while no rule cites it,
    and ``because`` why; ``certainty`` is that of its number and heading.
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

    ``priorities`` is a pre-order of levels: all pairs (higher, lower), transitive; equal levels are
    paired in both orders. ``extends`` are the rulebooks that it builds upon, nearest first. ``at``
    is the day (ISO) whose law it is; what was not in force then has been left out:
    ``not_in_force`` names the rules. ``topics`` are those of its chain, ``provisions`` the articles
    of its own law.
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
    not_in_force: tuple[str, ...] = ()

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule."""
        return rule_rows(self.rules)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A rulebook without errors, with its warnings, and the files that it was read from by name."""

    rulebook: Rulebook
    warnings: tuple[Diagnostic, ...] = ()
    sources: Mapping[str, Source] = field(default_factory=dict, compare=False, repr=False)


def rule_rows(rules: Iterable[Any]) -> list[dict[str, Any]]:
    """One row per rule, for a rulebook's rules or compiled ones."""
    columns = ("strength", "level", "cite", "says", "book")
    return [{"rule": x.name, **{column: getattr(x, column) for column in columns}} for x in rules]
