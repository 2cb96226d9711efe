"""A shortest trace that one rule forbids and others allow.

A rule forbids a trace if it is violated for some objects. It is then also violated by the trace of
these objects alone, during the states in which all of them are present; so traces with only the
objects of one rule show whether another rule forbids everything that the first one does. The other
rule is evaluated for all choices of these objects that fit its variables. Objects have the declared
types of the variables, and where counts tell subtypes apart, also those (``object_typings``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import chain, product

from rulec.analysis.believable_states import (
    believed,
    declarations_read,
    limits_of,
    plausible_numbers,
)
from rulec.analysis.object_typings import answers_for_types
from rulec.analysis.possible_traces import approaching, is_possible, steadied
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.analysis.stated_axioms import said_as_usual, said_of_constant, said_within
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.rulebook.rulebook_model import Axiom
from rulec.trace import Trace
from rulec.vocabulary import Quantity
from rulec.witnesses.joint_alphabet import JointAlphabet, JointLetter
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import Itself, ObjectUniverse
from rulec.witnesses.shortest_words import shortest_word
from rulec.witnesses.trace_synthesis import synthesize_trace
from rulec.witnesses.undecided import ChangingConstantsError, UndecidedError


def counterexample(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom] = ()
) -> Trace | None:
    """A shortest trace that only this rule forbids, or None.

    ``given`` must hold in its states, in addition to the known facts. Raises UndecidedError.
    """
    found = shortest_contest(forbidding, allowing, given)
    return None if found is None else found[1]


def shortest_contest(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom] = ()
) -> tuple[Contest, Trace] | None:
    """The contest for those types of objects that have the shortest trace, and the trace.

    Raises UndecidedError.
    """
    universe = _universe(forbidding, allowing, given)
    contests: list[tuple[Contest, Trace]] = []

    def trace_for(objects: Mapping[str, str]) -> Trace | None:
        own = replace(universe, objects=objects)
        contest = Contest(forbidding, allowing, given, own)
        trace = contest.trace()
        if trace is not None:
            contests.append((contest, trace))
        return trace

    asked = answers_for_types(
        universe.objects, (forbidding, *allowing), universe.vocabulary, trace_for
    )
    problem: UndecidedError | None = None
    for _, answer in asked:
        if isinstance(answer, UndecidedError):
            problem = problem or answer
        elif answer is not None and len(answer.states) == 1:
            break  # none is shorter
    if contests:
        return min(contests, key=lambda pair: len(pair[1].states))
    if problem is not None:
        raise problem
    return None


def forbidding_all(analyzed: AnalyzedRule) -> AnalyzedRule:
    """A rule about the same objects that forbids every trace: what else allows one keeps theirs."""
    machine = analyzed.rule.machine
    never = tuple((False,) * len(row) for row in machine.outputs)
    refusing = replace(machine, outputs=never, rejecting_sink=None, accepting_sink=None)
    return replace(analyzed, rule=replace(analyzed.rule, machine=refusing))


class Contest:
    """A forbidding rule, allowing ones, and states where they may differ. Raises UndecidedError.

    The ``universe`` has the forbidding rule's objects, of the declared types unless it is given.
    Its traces keep the rules that are ``believed``, too, which read no words but those of the
    others; the search heeds those that are ``broken`` without that.
    """

    def __init__(
        self,
        forbidding: AnalyzedRule,
        allowing: Sequence[AnalyzedRule],
        given: Sequence[Axiom] = (),
        universe: ObjectUniverse | None = None,
        *,
        believed: Sequence[AnalyzedRule] = (),
        broken: Sequence[AnalyzedRule] = (),
    ) -> None:
        self.forbidding, self._allowing, self._given = forbidding, allowing, tuple(given)
        self._believed, self._broken = believed, broken
        self._rules = [analyzed.rule for analyzed in (forbidding, *allowing)]
        self.names = frozenset[str]().union(*map(declarations_read, self._rules))
        self._universe = universe or _universe(forbidding, allowing, given)
        self.vocabulary = self._universe.vocabulary
        own = {variable.name: variable.name for variable in forbidding.rule.variables}
        bound = [(forbidding.rule.machine, own, False)]
        bound += [
            (allowed.rule.machine, binding, True)
            for allowed in (*allowing, *broken)
            for binding in self._universe.bindings(allowed.rule.variables)
        ]
        self._monitors, bindings, self._verdicts = zip(*bound, strict=True)
        functions = list(map(monitor_function, self._monitors, bindings))
        self._alphabet = JointAlphabet(self._universe, functions)

    def trace(self) -> Trace | None:
        """A shortest trace that only the first rule forbids, or None. Raises UndecidedError."""
        trace = self._trace()
        broken = [] if trace is None else self._disbelieved(trace)
        if not broken:
            return trace
        return self._given_also((), broken=broken).trace()

    def _trace(self) -> Trace | None:
        alphabet, universe = self._alphabet, self._universe
        word = self._word()
        if word is None:
            return None

        step = common_step((self.forbidding, *self._allowing))
        possible = partial(is_possible, universe=universe)
        try:
            return synthesize_trace(alphabet.states_of(word), universe, step, self._shows, possible)
        except ChangingConstantsError as changing:
            reads = [alphabet.read_of(subject) for subject in changing.subjects]
            axioms = [said_of_constant(read, universe.vocabulary) for read in reads if read]
            # A constant that already has one value and still changes would recur for ever.
            if None in reads or not set(self._given).isdisjoint(chain.from_iterable(axioms)):
                raise
        # A trace has one value for each constant: take the shortest trace for any values.
        every = product(*axioms)
        traces = (self._given_also(x).trace() for x in every)
        counterexamples = [trace for trace in traces if trace is not None]
        return min(counterexamples, key=lambda trace: len(trace.states), default=None)

    def trace_as_usual(self, names: Set[str]) -> Trace | None:
        """Such a trace in which these declarations have their defaults. Raises UndecidedError."""
        declared = self.forbidding.rulebook.vocabulary.declarations
        axioms = [said_as_usual(name, Itself(declared[name])) for name in sorted(names)]
        return self._given_also(axioms).trace()

    def believable(self, first: Trace) -> tuple[Contest, Trace]:
        """The same contest for what is believed, and its shortest trace; these if there is none.

        If nobody could believe it, numbers are at least plausible if a trace as short as the
        ``first`` has them.
        """
        belief = believed(self.names, self.vocabulary)
        numbers = plausible_numbers(self._rules, self.vocabulary)
        facts, alone = (*belief.facts, *numbers), replace(self._universe, axioms=())
        untrue = [
            fact for fact in belief.facts if not is_possible(first, replace(alone, axioms=(fact,)))
        ]
        # What is only a wish, or only about numbers, is not worth a longer trace.
        attempts: list[tuple[Sequence[Axiom], Sequence[AnalyzedRule], bool]] = [
            ((*facts, *belief.wishes), belief.rules, False),
            (facts, belief.rules, True),
            *(([fact for fact in facts if fact is not one], belief.rules, True) for one in untrue),
            (facts, (), True),
        ]
        wished: list[tuple[Contest, Trace]] = []
        for axioms, kept, may_be_longer in (
            *(attempts if any(belief) else ()),
            (numbers, (), False),
        ):
            with suppress(UndecidedError):
                contest = self._given_also(axioms, believed=kept)
                trace = contest.trace()
                if trace and (may_be_longer or len(trace.states) == len(first.states)):
                    found = [*wished, (contest, trace)]
                    return min(found, key=lambda pair: len(pair[1].states))
                wished += [(contest, trace)] if trace else []
        return self, first

    def within_limits(self, trace: Trace) -> Iterator[Contest]:
        """The same contest without what is beyond a limit in a trace, for each number in turn.

        The number then stays on the default's side of the last limit that it has passed.
        """
        declared = self.vocabulary.declarations
        for name, limits in sorted(limits_of(self._rules).items()):
            item = declared[name]
            if not isinstance(item, Quantity) or item.default is None:
                continue
            usual = exact(float(item.default))
            numbers = set(map(exact, _numbers_in(trace, name)))
            for value in sorted(numbers, key=lambda number: abs(number - usual)):
                passed = [
                    limit for limit in limits if min(usual, value) <= limit <= max(usual, value)
                ]
                if not passed or value == usual:
                    continue
                last = min(passed, key=lambda limit: abs(value - limit))
                below: ltl.Relation = "<" if last == value else "<="
                above: ltl.Relation = ">" if last == value else ">="
                axiom = said_within(name, Itself(item), below if value > usual else above, last)
                yield self._given_also([axiom])
                break

    def _given_also(
        self,
        axioms: Sequence[Axiom],
        *,
        believed: Sequence[AnalyzedRule] = (),
        broken: Sequence[AnalyzedRule] = (),
    ) -> Contest:
        """The same contest, for objects of the same types, with further axioms and rules."""
        given = (*self._given, *axioms)
        universe = _universe(self.forbidding, self._allowing, given)
        return Contest(
            self.forbidding,
            self._allowing,
            given,
            replace(universe, objects=self._universe.objects),
            believed=(*self._believed, *believed),
            broken=(*self._broken, *broken),
        )

    def steadied(self, trace: Trace) -> Trace:
        """A trace of the contest with fewer changes of value from state to state."""

        def is_right(calmer: Trace) -> bool:
            possible = is_possible(calmer, self._universe)
            return possible and self._shows(calmer) and not self._disbelieved(calmer)

        words = self.vocabulary
        calm = steadied(trace, words, is_right)
        return approaching(calm, words, self.names, is_right)

    def _disbelieved(self, trace: Trace) -> list[AnalyzedRule]:
        """The rules believed that a trace violates."""
        words = self.vocabulary
        return [rule for rule in self._believed if rule.violations(trace, words)]

    def _shows(self, trace: Trace) -> bool:
        words = self.vocabulary
        return bool(self.forbidding.violations(trace, words)) and not any(
            allowed.violations(trace, words) for allowed in (*self._allowing, *self._broken)
        )

    def _word(self) -> tuple[JointLetter, ...] | None:
        alphabet, letters = self._alphabet, self._alphabet.candidates
        if alphabet.is_counting:
            # Usually no word is left even if all letters were possible.
            with suppress(UndecidedError):
                if shortest_word(self._monitors, self._verdicts, letters) is None:
                    return None
        word = shortest_word(self._monitors, self._verdicts, letters, alphabet.can_be_read)
        if word is None:
            alphabet.require_complete()
        return word


def _numbers_in(trace: Trace, name: str) -> Iterator[float]:
    """The numbers of one quantity in a trace, of all its objects."""
    values = (state[name] for state in trace.states if name in state)
    each = chain.from_iterable(
        value.values() if isinstance(value, Mapping) else (value,) for value in values
    )
    return (float(value) for value in each if isinstance(value, int | float))


def common_step(rules: Iterable[AnalyzedRule]) -> Fraction:
    """The step of traces for rules with one step, in seconds; 1 if no rule depends on the step."""
    return next((step for rule in rules if (step := rule.rule.step_s) is not None), Fraction(1))


def _universe(
    forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule], given: Sequence[Axiom]
) -> ObjectUniverse:
    rules = (forbidding, *allowing)
    read = {name for analyzed in rules for name in declarations_read(analyzed.rule)}
    axioms = tuple(dict.fromkeys((*(axiom for rule in rules for axiom in rule.axioms), *given)))
    names = read | {name for axiom in axioms for name in names_in(axiom.formula)}
    vocabulary, unsaid = forbidding.rulebook.vocabulary, frozenset[str]()
    for allowed in allowing:
        if allowed.rulebook.vocabulary == vocabulary:
            continue
        words = shared_vocabulary(vocabulary, allowed.rulebook.vocabulary)
        for name in sorted(words.unlike & names):
            raise UndecidedError(f"`{name}` is declared differently in the two")
        vocabulary, unsaid = words.vocabulary, unsaid | words.not_shared | words.unlike
    objects = {variable.name: variable.type for variable in forbidding.rule.variables}
    return ObjectUniverse(objects, vocabulary, axioms, unsaid - read)
