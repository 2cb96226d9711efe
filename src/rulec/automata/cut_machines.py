"""The machine of a rule for words whose past and continuation are unobserved, of two others.

One judges what continues, the other the word alone. Both read, as their last read, whether the word
has begun, if the rule looks back (``prefix_machines``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, Read
from rulec.automata.outcome_machine import OutcomeMachine, of_prefixes
from rulec.automata.tables import SizeError
from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, operations_of

BEGUN = ltl.Atom("word has begun")
"""No name in a rulebook contains a space."""


def goes_on_from_before(rule: CompiledRule) -> bool:
    """Whether a rule, kept before a cut word began, may have a sequence under way there.

    Exceptions and a condition do not change that, though the whole formula may have no `then`.
    """
    formula = rule.formula if rule.parts is None else rule.parts.required
    always = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
    if not isinstance(formula, ltl.Unary) or formula.operator not in always or rule.variables:
        return False
    then = ltl.BinaryOperator.THEN
    return formula.bound is None and any(x.operator is then for x in operations_of(formula))


def looks_back(rule: CompiledRule) -> bool:
    """Whether a rule's machine for what continues reads whether the word has begun."""
    return any(operation.operator in PAST for operation in operations_of(rule.formula))


@dataclass(frozen=True, slots=True)
class TimedCut:
    """What the machine of a rule for cut words is made of at any step.

    ``own`` judges what continues, None if the rule's own machine does; ``alone`` judges the word
    alone, None if that is the same one.
    """

    own: TimedMachine | None
    alone: TimedMachine | None

    def at(self, rule: CompiledRule) -> OutcomeMachine:
        """The machine at the rule's step. Raises SizeError."""
        own = rule.machine if self.own is None else self.own.at(rule.step_s)
        alone = own if self.alone is None else self.alone.at(rule.step_s)
        return cut_machine(own, alone, goes_on=goes_on_from_before(rule))

    def if_small(self, rule: CompiledRule) -> OutcomeMachine | None:
        """The machine at the rule's step; None if it gets too large."""
        try:
            return self.at(rule)
        except SizeError:
            return None


def cut_machine(own: MealyMonitor, alone: MealyMonitor, *, goes_on: bool) -> OutcomeMachine:
    """The machine for cut words; ``goes_on`` if a rule that was kept may have a sequence under way.

    A run may begin in any state that earlier letters can lead to.
    """
    looks_back = own.reads[-1:] == (Read(BEGUN.name, ()),)
    half = len(own.letters) // 2 if looks_back else 0
    before, begun = (
        dict.fromkeys(
            pair
            for pair in zip(own.letters[letters], alone.letters[letters], strict=True)
            if IMPOSSIBLE not in pair
        )
        for letters in (slice(half), slice(half, None))
    )
    starts = {(0, 0): None}
    for symbols in (before, begun) if goes_on else (before,):
        for state, other in (waiting := list(starts)):
            for symbol, alone_symbol in symbols:
                pair = own.successors[state][symbol], alone.successors[other][alone_symbol]
                lost = pair[0] == own.rejecting_sink and not own.outputs[state][symbol]
                if pair not in starts and not (lost and symbols is begun):
                    starts[pair] = None
                    waiting.append(pair)
    if looks_back:
        own, alone = (
            replace(machine, reads=machine.reads[:-1], letters=machine.letters[half:])
            for machine in (own, alone)
        )
    return of_prefixes(own, alone, starts)
