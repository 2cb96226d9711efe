"""Explanations of violations by traces in arrays: only the states shown are built."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import overload

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in, reads_in
from rulec.monitoring.bindings import Binding, binding_of
from rulec.monitoring.explain.column_truths import ColumnTruths
from rulec.monitoring.explain.explained_parts import Deciding
from rulec.monitoring.explain.explained_states import shown_states
from rulec.monitoring.explain.explanation import Explained, Explanation, explanation_of
from rulec.monitoring.explain.observed_states import ObservedStates
from rulec.monitoring.implied_values import with_implied_values
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.one_completion import (
    Supposed,
    completed,
    favourable,
    with_all_defaults,
)
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.monitoring.verdict import Violation
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Vocabulary


def explain_arrays(
    violation: Violation,
    arrays: TraceArrays,
    rulebook: CompiledRulebook,
    decided_by: Mapping[str, Deciding],
) -> Explanation | None:
    """The explanation by ``explain`` of a violation in a cut trace, without a repair.

    None if it needs all states: for very long traces, and for values that follow from others or
    from other states.
    """
    rule = next(rule for rule in rulebook.rules if rule.name == violation.rule)
    spans = zip(arrays.objects, arrays.spans.tolist(), strict=True)
    present = {item: (first, last) for item, (first, last) in spans}
    binding = binding_of(violation.binding, present, arrays.n_states)
    stretch = range(binding.first, binding.last + 1)
    words = _Vocabularies.of(rulebook, rule, arrays.told)
    truths = ColumnTruths(arrays, rulebook.vocabulary, binding, words.supposed, words.untold)
    is_long = len(stretch) > 2 * LIMITS.states_explained
    if is_long or arrays.ends != "cut" or not _is_plain(rule.formula, truths):
        return None
    decisive = binding.last if violation.step is None else violation.step
    shown = [number - binding.first for number in shown_states(stretch, decisive)]
    views = _Views(arrays, binding, rule.formula, words)
    observed = _ObservedColumns(
        views=views,
        bound=binding.objects,
        shown=shown,
        decisive=decisive - binding.first,
        given=views.given,
        find_truths=truths.of,
    )
    views.look_at({*observed.looked_up, 0})
    subject = Explained(violation, rule, words.completed, rulebook.semantics, arrays.step_s)
    return explanation_of(subject, observed, stretch, decided_by)


def _is_plain(formula: ltl.Formula, truths: ColumnTruths) -> bool:
    """Whether the values that a formula reads in a state depend on that state alone."""
    vocabulary = truths.vocabulary
    effects: set[str] = set()
    ahead = [name for name in vocabulary.implied if truths.says(name)]
    while ahead:
        implied = {*vocabulary.implied.get(ahead.pop(), ())} - effects
        effects |= implied
        ahead += implied
    return not any(
        (name in effects and not own.says_all(name, arguments))
        or (name in vocabulary.constants and not own.is_steady(name, arguments))
        for own, name, arguments in _read_by(formula, truths)
    )


def _read_by(
    formula: ltl.Formula, truths: ColumnTruths
) -> Iterator[tuple[ColumnTruths, str, tuple[str, ...]]]:
    """The names that a formula reads, with their variables and the truths for their objects."""
    for read in reads_in(formula):
        if isinstance(read, ltl.Count):
            for _, own in truths.of_counted(read):
                yield from _read_by(read.body, own)
        else:
            yield truths, read.name, read.arguments


@dataclass(frozen=True, slots=True)
class _Vocabularies:
    """A rulebook's words for one rule: as declared, as completed, and as they are given.

    In ``given``, names that are ``untold`` are unknown. In ``completed``, they have the values that
    are ``supposed`` for unknown ones.
    """

    declared: Vocabulary
    completed: Vocabulary
    given: Vocabulary
    supposed: Supposed
    untold: frozenset[str]

    @staticmethod
    def of(
        rulebook: CompiledRulebook, rule: CompiledRule, told: frozenset[str] | None
    ) -> _Vocabularies:
        """The vocabularies for traces from sources that provide the same names."""
        key = _Vocabularies, rule.name, told
        vocabularies: _Vocabularies | None = rulebook.prepared.get(key)
        if vocabularies is None:
            declared, untold = rulebook.vocabulary, untold_names(rulebook.vocabulary, told)
            facts = [axiom.formula for axiom in rulebook.axioms]
            supposed = favourable(rule.formula, declared, facts)
            vocabularies = _Vocabularies(
                declared,
                completed=with_all_defaults(declared, supposed, untold),
                given=with_untold(declared, untold),
                supposed=supposed,
                untold=untold,
            )
            rulebook.prepared[key] = vocabularies
        return vocabularies


@dataclass(frozen=True, slots=True, kw_only=True)
class _ObservedColumns(ObservedStates):
    """States whose truths are computed from columns."""

    find_truths: Callable[[ltl.Proposition], Flags]

    def truths(self, proposition: ltl.Proposition) -> list[bool]:
        """The truth of a proposition in each state."""
        truths: list[bool] = self.find_truths(proposition).tolist()
        return truths


class _Views(Sequence[StateView]):
    """Views of the states of a binding; those looked at together are built together."""

    def __init__(
        self, arrays: TraceArrays, binding: Binding, formula: ltl.Formula, words: _Vocabularies
    ) -> None:
        comparisons = [atom for atom in ltl.atoms_of(formula) if isinstance(atom, ltl.Comparison)]
        counts = any(isinstance(term, ltl.Count) for own in comparisons for _, term in own.terms)
        items = arrays.objects.keys() if counts else {*binding.objects.values()}
        self._arrays = arrays.part({*names_in(formula)}, items)
        self._binding, self._vocabularies = binding, words
        self._made: dict[int, tuple[StateView, StateView]] = {}

    def look_at(self, indices: Set[int]) -> None:
        """Build the views of some states."""
        chosen, words = sorted(indices), self._vocabularies
        part = self._arrays.at([self._binding.first + index for index in chosen])
        given = with_implied_values(part.trace(), words.declared)
        known = completed(given, words.declared, words.supposed)
        for number, index in enumerate(chosen):
            present = present_in(number, known.objects, known.present)
            self._made[index] = (
                StateView(known.states[number], present, words.completed),
                StateView(given.states[number], {}, words.given),
            )

    def given(self, index: int) -> StateView:
        """A state as it is given, possibly with unknown values."""
        return self._view_pair(index)[1]

    def _view_pair(self, index: int) -> tuple[StateView, StateView]:
        if index not in self._made:
            self.look_at({index})
        return self._made[index]

    def __len__(self) -> int:
        return self._binding.last - self._binding.first + 1

    @overload
    def __getitem__(self, index: int) -> StateView: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[StateView, ...]: ...

    def __getitem__(self, index: int | slice) -> StateView | tuple[StateView, ...]:
        if isinstance(index, slice):
            return tuple([self[k] for k in range(*index.indices(len(self)))])
        return self._view_pair(index)[0]
