"""Verdicts as data, and the carried state of running traces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple, TypeAlias

from rulec.diagnostics import RulecError
from rulec.monitoring.rulebook_edition import Edition
from rulec.rulebook.rulebook_model import Strength
from rulec.value_display import Rows, short_repr


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that a trace violates, for one binding of its variables.

    ``step`` is the first state (from 0) after which no continuation can satisfy the rule; None if
    only the trace's end decides.
    """

    __repr__ = short_repr

    rule: str
    strength: Strength
    binding: Mapping[str, str]
    step: int | None


OutcomeName: TypeAlias = Literal["kept", "violated", "open"]

Reason: TypeAlias = Literal["not told", "tolerance", "not over", "began before"]
"""Why a verdict is open.

Values are unknown; or are numbers whose bounds contain a limit; or a duty is pending; or the past
was not observed.
"""


@dataclass(frozen=True, slots=True)
class ConditionalOutcome:
    """The outcome if unknown names always have these values, and numbers are within the bounds."""

    when: Mapping[str, bool | str]
    outcome: OutcomeName


class OpenReasons(NamedTuple):
    """Why a verdict is open, and on what it depends: see ``OpenVerdict``."""

    because: tuple[Reason, ...]
    depends_on: tuple[str, ...] = ()
    outcomes: tuple[ConditionalOutcome, ...] = ()
    exact: bool = True


@dataclass(frozen=True)
class OpenVerdict:
    """A rule that some completions of a trace keep and others do not, or whose end is unobserved.

    ``depends_on`` is the smallest set of names that the rule reads such that completions that agree
    on them agree on the outcome; of equally small ones the first in the vocabulary's order. Names
    that the rule reads jointly, as in a sum, are listed together if they are unknown in some state,
    which may be more than necessary. ``exact`` is false if there were too many completions: then
    the verdict may really be known. All this takes longer than the verdict itself, so it is
    computed on demand.
    """

    __repr__ = short_repr

    rule: str
    strength: Strength
    binding: Mapping[str, str]
    because: tuple[Reason, ...]
    # Created by factories, so that the class itself has no such attributes.
    depends_on: tuple[str, ...] = field(default_factory=tuple)
    outcomes: tuple[ConditionalOutcome, ...] = field(default_factory=tuple)
    exact: bool = field(default_factory=lambda: True)

    @classmethod
    def explained_later(
        cls,
        rule: str,
        strength: Strength,
        binding: Mapping[str, str],
        reasons: Callable[[], OpenReasons],
        *,
        beyond: Callable[[Set[str]], frozenset[str]] | None = None,
    ) -> OpenVerdict:
        """An open verdict whose reasons are computed on demand.

        ``beyond`` gives the names on which it depends other than some, if that is faster.
        """
        result = cls.__new__(cls)
        own = result.__dict__
        own["rule"], own["strength"], own["binding"] = rule, strength, binding
        own["_reasons"], own["_beyond"] = reasons, beyond
        return result

    def depends_beyond(self, names: Set[str]) -> frozenset[str]:
        """The names in ``depends_on`` that are not among these, found without all reasons."""
        beyond: Callable[[Set[str]], frozenset[str]] | None = self.__dict__.get("_beyond")
        return frozenset(self.depends_on) - names if beyond is None else beyond(names)

    def __getattr__(self, name: str) -> Any:
        # Called only for missing attributes.
        reasons = self.__dict__.get("_reasons")
        if reasons is None or name not in OpenReasons._fields:
            raise AttributeError(name)
        self.__dict__.update(reasons()._asdict())
        for key in ("_reasons", "_beyond"):
            self.__dict__.pop(key, None)
        return self.__dict__[name]

    def __getstate__(self) -> dict[str, Any]:
        _ = self.because
        return dict(self.__dict__)


VerdictOutcome: TypeAlias = Literal[
    "satisfied", "violated", "only soft rules", "open", "nothing found"
]
"""The outcome of a verdict as a whole: see ``Verdict.outcome``."""


@dataclass(frozen=True, slots=True)
class RuleNotJudged:
    """A rule that no trace from this source can be known to violate, for lack of ``untold``.

    ``why`` is another reason, if there is one; ``by_fault``: it is a fault of rulec.
    """

    rule: str
    strength: Strength
    untold: tuple[str, ...]
    why: str = ""
    by_fault: bool = False


@dataclass(frozen=True, slots=True)
class Verdict(Rows):
    """The verdict of a rulebook: what a trace certainly violates, by rule and objects.

    ``open`` depends on something unknown, ``not_judged`` lists rules for which this source lacks
    values; for those ``kept_regardless`` it lacks values, too, but the trace keeps them whatever
    these are. ``presumed`` are names that have their default because no source provides them.
    ``law`` is the text that was judged by.
    ``faults`` are those of rulec that came meanwhile; the rules that they cost are among the
    ``not_judged``.
    """

    __repr__ = short_repr

    trace: str
    violations: tuple[Violation, ...]
    open: tuple[OpenVerdict, ...] = ()
    not_judged: tuple[RuleNotJudged, ...] = ()
    presumed: tuple[str, ...] = ()
    kept_regardless: tuple[str, ...] = ()
    law: Edition | None = field(default=None, compare=False, repr=False)
    faults: tuple[RulecError, ...] = field(default=(), compare=False, repr=False)

    @property
    def satisfied(self) -> bool | None:
        """Whether no hard rule is violated; None if one is open or not judged."""
        if any(violation.strength == "hard" for violation in self.violations):
            return False
        doubtful: tuple[OpenVerdict | RuleNotJudged, ...] = (*self.open, *self.not_judged)
        return None if any(rule.strength == "hard" for rule in doubtful) else True

    @property
    def outcome(self) -> VerdictOutcome:
        """What ``satisfied`` says; without an answer, what was found instead.

        That is a violation of soft rules only, an open hard rule, or nothing in the rules that
        could be judged.
        """
        if self.satisfied is not None:
            return "satisfied" if self.satisfied else "violated"
        if self.violations:
            return "only soft rules"
        return "open" if any(rule.strength == "hard" for rule in self.open) else "nothing found"

    def rows(self) -> list[dict[str, Any]]:
        """One row per violation."""
        return [
            {
                "trace": self.trace,
                "rule": violation.rule,
                "strength": violation.strength,
                "step": violation.step,
                "binding": dict(violation.binding),
            }
            for violation in self.violations
        ]


RuleFor: TypeAlias = tuple[str, tuple[str, ...]]
"""A rule's name, and the objects that its variables stand for."""


def rule_for(result: Violation | OpenVerdict) -> RuleFor:
    """The rule that is violated or open, and for which objects."""
    return result.rule, tuple(result.binding.values())


def _common(one: Verdict, other: Verdict, types: Sequence[str]) -> Verdict:
    """The common part of verdicts on two traces, of which one is the real one.

    Where they differ the verdict is open, and depends on the types that decide which it is.
    """
    violations = {rule_for(violation): violation for violation in one.violations}
    further = {rule_for(violation): violation for violation in other.violations}
    doubtful = {rule_for(result): result for result in one.open}
    further_open = {rule_for(result): result for result in other.open}
    for key in violations.keys() ^ further.keys():
        known = violations.get(key) or further[key]
        own = OpenVerdict(known.rule, known.strength, known.binding, ("not told",), tuple(types))
        doubtful.setdefault(key, own)
    for key in doubtful.keys() ^ further_open.keys():
        known_open = doubtful.get(key) or further_open[key]
        reasons = tuple(dict.fromkeys((*known_open.because, "not told")))
        names = tuple(dict.fromkeys((*known_open.depends_on, *types)))
        doubtful[key] = replace(known_open, because=reasons, depends_on=names, outcomes=())
    both = [
        replace(violation, step=_later(violation.step, further[key].step))
        for key, violation in violations.items()
        if key in further
    ]
    return replace(one, violations=tuple(both), open=tuple(doubtful.values()))


def agreed_by_type(known: Verdict, others: Sequence[tuple[Sequence[str], Verdict]]) -> Verdict:
    """The common part of a verdict and of those if participants had types that they may have.

    Where they differ the verdict is open, and depends on the types by which it does.
    """
    violations = {rule_for(violation): violation for violation in known.violations}
    doubtful = {rule_for(result): result for result in known.open}
    for types, other in others:
        pair = _common(known, other, types)
        # Each time a part of those before, and where they agree no earlier
        common = _common(replace(known, violations=tuple(violations.values())), other, types)
        violations = {rule_for(violation): violation for violation in common.violations}
        for result in pair.open:
            key = rule_for(result)
            doubtful[key] = _either(doubtful.get(key, result), result)
    unknown = {
        x.rule: x for verdict in (known, *[x for _, x in others]) for x in verdict.not_judged
    }
    return replace(
        known,
        violations=tuple(violations.values()),
        open=tuple(doubtful.values()),
        not_judged=tuple(unknown.values()),
        kept_regardless=tuple([rule for rule in known.kept_regardless if rule not in unknown]),
    )


def _either(one: OpenVerdict, other: OpenVerdict) -> OpenVerdict:
    if one is other:
        return one
    return replace(
        one,
        because=tuple(dict.fromkeys((*one.because, *other.because))),
        depends_on=tuple(dict.fromkeys((*one.depends_on, *other.depends_on))),
        outcomes=(),
    )


def _later(first: int | None, second: int | None) -> int | None:
    return None if first is None or second is None else max(first, second)


@dataclass(frozen=True, slots=True)
class NotJudged:
    """A trace without a verdict: its id, if known, and the error."""

    __repr__ = short_repr

    trace: str | None
    error: RulecError


def with_law(answer: Verdict | NotJudged, law: Edition) -> Verdict | NotJudged:
    """The answer, if it is a verdict with the text that was judged by."""
    return replace(answer, law=law) if isinstance(answer, Verdict) else answer


@dataclass(frozen=True, slots=True)
class CarriedState:
    """The machine states of objects that stay, and the permanent violations.

    ``settled`` are the rules among the ``violations``, for objects that stay. If the past was
    partly unknown, a machine may be in several ``possible`` states, and for ``perhaps_settled``
    rules it is unknown whether they have been violated. ``constants`` are the values of the world's
    constants that it has given.
    """

    states: Mapping[RuleFor, int] = field(default_factory=dict)
    settled: frozenset[RuleFor] = frozenset()
    violations: tuple[Violation, ...] = ()
    possible: Mapping[RuleFor, frozenset[int]] = field(default_factory=dict)
    perhaps_settled: frozenset[RuleFor] = frozenset()
    constants: Mapping[str, Any] = field(default_factory=dict)

    def starts(self, about: RuleFor) -> frozenset[int]:
        """The states in which a machine may be."""
        return self.possible.get(about) or frozenset({self.states.get(about, 0)})

    def begun(self, rule: str) -> set[tuple[str, ...]]:
        """The objects for which a rule's machine may have left its start state."""
        return {
            about[1]
            for about in (*self.states, *self.possible, *self.perhaps_settled)
            if about[0] == rule
            and (about in self.perhaps_settled or self.starts(about) != frozenset({0}))
        }

    @property
    def doubtful_rules(self) -> frozenset[str]:
        """The rules for which the past is partly unknown."""
        return frozenset(rule for rule, _ in (*self.possible, *self.perhaps_settled))


NO_PAST = CarriedState()
