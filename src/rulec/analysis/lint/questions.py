"""Independent questions about a rulebook's rules, and their answers.

They take nearly all of the time, so they may be answered in advance, in several processes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, NamedTuple, TypeAlias

from rulec.analysis.diff.rule_comparison import RuleComparison, compare
from rulec.analysis.lint.conflict_search import Conflict, conflict
from rulec.analysis.lint.redundancy import can_be_kept, can_be_violated, implied_by
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.witnesses.undecided import UndecidedError


class Question(NamedTuple):
    """A question about rules, by their names.

    ``kept``, ``violated``: is that possible? ``implied``: by which of the others? ``conflict``: is
    it impossible to keep them all? ``compared``: how does the rule relate to that of the same name
    in the base of that number?
    """

    kind: Literal["kept", "violated", "implied", "conflict", "compared"]
    names: tuple[str, ...]
    base: int = 0


@dataclass(frozen=True, slots=True)
class ComparedRules:
    """The rules of a rulebook and of those that it extends, by name, that questions are about."""

    own: Mapping[str, AnalyzedRule]
    of_bases: Sequence[Mapping[str, AnalyzedRule]] = ()


Spread: TypeAlias = Callable[
    [Callable[[Question], Iterator[Any]], Sequence[Question]], Iterator[tuple[Question, Any]]
]
"""Calls a function for each question, possibly in other processes; yields question and answer."""


def answers_to(rules: ComparedRules, question: Question) -> Iterator[object]:
    """The answer to a question; an undecided question yields its reason instead."""
    own = [rules.own[name] for name in question.names]
    try:
        match question.kind:
            case "kept":
                yield can_be_kept(*own)
            case "violated":
                yield can_be_violated(*own)
            case "implied":
                yield tuple(rule.rule.name for rule in implied_by(own[0], own[1:]))
            case "conflict":
                yield conflict(own)
            case "compared":
                yield compare(own[0], rules.of_bases[question.base][question.names[0]])
    except UndecidedError as problem:
        yield problem


class RuleAnswers:
    """Answers to questions about rules; each method raises UndecidedError.

    ``tell`` is called with the number of answers so far.
    """

    def __init__(
        self, rules: ComparedRules, tell: Callable[[float], object] = lambda _: None
    ) -> None:
        self._rules = rules
        self._tell = tell
        self._known: dict[Question, object] = {}

    def ask_ahead(self, use: Callable[[RuleAnswers], object], spread: Spread) -> None:
        """Compute the answers in advance that are used if nothing is found, as nearly always."""
        rehearsal = _Rehearsal(self._rules)
        use(rehearsal)
        answers = spread(partial(answers_to, self._rules), list(rehearsal.asked))
        for question, answer in answers:
            self._known[question] = answer
            self._tell(len(self._known))

    def can_be_kept(self, name: str) -> bool:
        """Whether some trace, with objects for the rule, keeps it."""
        return bool(self._to(Question("kept", (name,))))

    def can_be_violated(self, name: str) -> bool:
        """Whether some trace violates the rule."""
        return bool(self._to(Question("violated", (name,))))

    def implied_by(self, name: str, others: Sequence[str]) -> tuple[str, ...]:
        """One or a few of the others that together forbid all that the rule forbids, if any."""
        names: tuple[str, ...] = self._to(Question("implied", (name, *others)))
        return names

    def conflict(self, names: Sequence[str]) -> Conflict | None:
        """A shortest trace after which not all of these can be kept."""
        answer: Conflict | None = self._to(Question("conflict", tuple(names)))
        return answer

    def compared(self, name: str, base: int) -> RuleComparison:
        """The comparison of the rule with that of a base, given by its number."""
        comparison: RuleComparison = self._to(Question("compared", (name,), base))
        return comparison

    def _to(self, question: Question) -> Any:
        if question not in self._known:
            self._known[question] = next(answers_to(self._rules, question))
            self._tell(len(self._known))
        answer = self._known[question]
        if isinstance(answer, UndecidedError):
            raise answer
        return answer


class _Rehearsal(RuleAnswers):
    """Answers with which nothing is found, and the questions in their order."""

    def __init__(self, rules: ComparedRules) -> None:
        super().__init__(rules)
        self.asked: dict[Question, None] = {}

    def _to(self, question: Question) -> Any:
        self.asked[question] = None
        return _NOTHING_FOUND[question.kind]


_NOTHING_FOUND: Mapping[str, object] = {
    "kept": True,
    "violated": True,
    "implied": (),
    "conflict": None,
    "compared": RuleComparison("equal"),
}
