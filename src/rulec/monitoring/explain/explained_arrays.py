"""Explanations of violations by traces in arrays: only the states shown are built."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import overload

import numpy as np

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in, reads_in
from rulec.monitoring.bindings import Binding, binding_of
from rulec.monitoring.explain.completed_tables import CompletedTables
from rulec.monitoring.explain.explained_parts import Deciding
from rulec.monitoring.explain.explained_states import shown_states
from rulec.monitoring.explain.explanation import Explained, Explanation, explanation_of
from rulec.monitoring.explain.observed_states import ObservedStates
from rulec.monitoring.implied_values import with_implied_values
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.moments.array_tables import ArrayTables
from rulec.monitoring.moments.row_evaluation import RowEvaluation
from rulec.monitoring.moments.temporal_operators import RowStretches
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
    is_long = len(stretch) > 2 * LIMITS.states_explained
    if (
        is_long
        or arrays.ends != "cut"
        or not _is_plain(rule.formula, arrays, rulebook.vocabulary, binding)
    ):
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
        find_truths=_truths_of(arrays, words, binding),
    )
    views.look_at({*observed.looked_up, 0})
    subject = Explained(violation, rule, words.completed, rulebook.semantics, arrays.step_s)
    return explanation_of(subject, observed, stretch, decided_by)


def _truths_of(
    arrays: TraceArrays, words: _Vocabularies, binding: Binding
) -> Callable[[ltl.Proposition], Flags]:
    """The truth of propositions in each state of a binding."""
    tables = CompletedTables(ArrayTables(arrays, words.given), words.declared, words.supposed)
    states = np.arange(binding.first, binding.last + 1)
    stretches = RowStretches(np.array([[0]]), np.array([[len(states) - 1]]), "over")
    evaluation = RowEvaluation(tables, tables.spans, stretches, states, {})
    numbers = {item: np.array([number]) for number, item in enumerate(arrays.objects)}
    bound = {variable: numbers[item] for variable, item in binding.objects.items()}

    def truths(proposition: ltl.Proposition) -> Flags:
        found: Flags = evaluation.of(proposition, bound).spread((1, len(states))).sure[0]
        return found

    return truths


def _is_plain(
    formula: ltl.Formula, arrays: TraceArrays, vocabulary: Vocabulary, binding: Binding
) -> bool:
    """Whether the values that a formula reads in a state depend on that state alone."""
    effects: set[str] = set()
    ahead = [name for name in vocabulary.implied if name in arrays.world or name in arrays.about]
    while ahead:
        implied = {*vocabulary.implied.get(ahead.pop(), ())} - effects
        effects |= implied
        ahead += implied
    return not any(
        (name in effects and not _is_said(arrays, name, cells))
        or (name in vocabulary.constants and not _is_steady(arrays, name, cells))
        for name, cells in _read_by(formula, arrays, vocabulary, binding)
    )


def _read_by(
    formula: ltl.Formula, arrays: TraceArrays, vocabulary: Vocabulary, binding: Binding
) -> Iterator[tuple[str, slice | None]]:
    """The names that a formula reads, with the cells of their values; None if there are none."""
    for read in reads_in(formula):
        if not isinstance(read, ltl.Count):
            yield read.name, _cells(arrays, read.name, read.arguments, binding)
            continue
        for (item, kind), span in zip(arrays.objects.items(), arrays.spans.tolist(), strict=True):
            first, last = max(binding.first, span[0]), min(binding.last, span[1])
            if first <= last and vocabulary.is_subtype(kind, read.type):
                inner = Binding({**binding.objects, read.variable: item}, first, last)
                yield from _read_by(read.body, arrays, vocabulary, inner)


def _cells(
    arrays: TraceArrays, name: str, arguments: Sequence[str], binding: Binding
) -> slice | None:
    if name in arrays.world:
        return slice(binding.first, binding.last + 1)
    if name not in arrays.about or len(arguments) != 1:
        return None
    number = [*arrays.objects].index(binding.objects[arguments[0]])
    if not arrays.only.get(name, np.ones(number + 1, dtype=bool))[number]:
        return None
    begins = int(arrays.starts[number] - arrays.spans[number, 0])
    return slice(begins + binding.first, begins + binding.last + 1)


def _is_said(arrays: TraceArrays, name: str, cells: slice | None) -> bool:
    """Whether a name is given in all of the cells, even as unknown."""
    if cells is None:
        return False
    return name not in arrays.absent or not arrays.absent[name][cells].any()


def _is_steady(arrays: TraceArrays, name: str, cells: slice | None) -> bool:
    """Whether a name has the same value in all of the cells."""
    if cells is None:
        return True
    values = (arrays.world if name in arrays.world else arrays.about)[name]
    columns = [values, *arrays.bounds.get(name, ())]
    columns += [own[name] for own in (arrays.unknown, arrays.absent) if name in own]
    return all(bool((column[cells] == column[cells][0]).all()) for column in columns)


@dataclass(frozen=True, slots=True)
class _Vocabularies:
    """A rulebook's words for one rule: as declared, as completed, and as they are given.

    In ``given``, names that the source does not tell are unknown. In ``completed``, they have the
    values that are ``supposed`` for unknown ones.
    """

    declared: Vocabulary
    completed: Vocabulary
    given: Vocabulary
    supposed: Supposed

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
