"""From a formula to its deterministic automaton."""

from __future__ import annotations

import os
import signal
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import spot

from rulec.automata.alphabet import fresh_name, knowledge, names_of, propositions_of
from rulec.automata.compiler_jobs import CheckError
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.spot_bridge.progression import Progression
from rulec.automata.spot_bridge.registers import with_registers
from rulec.automata.spot_bridge.spot_formulas import F, SpotFormulas
from rulec.logic import formula as ltl
from rulec.logic.bounds import total_bound
from rulec.logic.formula import Formula
from rulec.logic.past_registers import Memory, definition, eliminate_past
from rulec.logic.semantics import Semantics

_SHAPE = ("parity", "det", "complete")
_NOT, _AND, _OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR

_SMALL = 6
"""The greatest total of bounds in steps for which Spot can translate a formula as a whole."""

_CHECK_CPU_S = 0.1
_TRY_CPU_S = 0.4


@dataclass(frozen=True, slots=True)
class Translation:
    """A formula's automaton, a ``twa_graph``: deterministic, complete, with parity acceptance.

    ``names`` maps propositions to names. ``alive`` is None if it reads infinite words, else the
    proposition that is true while a finite word lasts. ``is_checked``: Spot has compared it with
    the formula in both directions. With long bounds ``compare`` does so, and may find no answer in
    time.
    """

    automaton: Any
    names: dict[ltl.Proposition, str]
    alive: str | None
    is_checked: bool
    compare: Callable[[], None] | None


def translate(
    formula: ltl.Formula,
    reads: Sequence[Read | NumberRead],
    semantics: Semantics = "stutter",
    axioms: Sequence[ltl.Formula] = (),
) -> Translation:
    """The automaton of ``formula``, with bounds in steps, over its possible letters.

    Its language is the formula's, with ``knowledge(reads)`` and ``axioms`` true at every instant;
    it has the formula's propositions, and the axioms must contain no others. Raises CheckError if
    Spot or rulec made a mistake.
    """
    propositions = propositions_of(formula)
    past = eliminate_past(formula)
    fresh = [register.atom for register in past.registers]
    names = names_of([*propositions, *fresh, *(memory.atom for memory in past.memories)])
    alive = fresh_name("alive", set(names.values())) if semantics == "finite" else None
    spot_formulas = SpotFormulas(names, alive)
    known = knowledge(reads, propositions)
    for fact in axioms:
        known = fact if known == ltl.Constant(True) else ltl.Binary(_AND, known, fact)
    whole = past.present
    if known != ltl.Constant(True):
        whole = ltl.Binary(_AND, whole, ltl.Unary(ltl.UnaryOperator.ALWAYS, known))
    if past.memories:
        automaton = _guessed(whole, past.memories, spot_formulas)
    else:
        automaton = _combined(whole, True, spot_formulas)
    is_small = total_bound(whole) <= _SMALL or bool(past.memories)
    cpu_s = None if is_small else _CHECK_CPU_S
    compare = partial(check, automaton, whole, spot_formulas, past.memories, cpu_s=cpu_s)
    if past.registers:
        automaton = _shaped(with_registers(automaton, past.registers, spot_formulas))
    return Translation(
        automaton,
        {proposition: names[proposition] for proposition in propositions},
        alive,
        is_checked=is_small and not past.registers,
        compare=compare,
    )


def _shaped(automaton: Any) -> Any:
    """An automaton of the same language, smaller if possible, with parity acceptance."""
    if spot.is_deterministic(automaton) and spot.is_weak_automaton(automaton):
        automaton = spot.minimize_wdba(automaton)
    return spot.postprocess(automaton, *_SHAPE)


def _guessed(formula: ltl.Formula, memories: Sequence[Memory], spot_formulas: SpotFormulas) -> Any:
    """The automaton of a formula whose memories depend on the future.

    The values of the memories are guessed and projected away, which needs a determinisation.
    """
    defined = [spot_formulas.formula_of(definition(memory)) for memory in memories]
    guessing = spot_formulas.translate(
        spot_formulas.language([spot_formulas.formula_of(formula), *defined]), "small"
    )
    projection = spot.remove_ap()
    for memory in memories:
        projection.add_ap(spot_formulas.formula_of(memory.atom).ap_name())
    return spot.postprocess(projection.strip(guessing), *_SHAPE)


def _combined(formula: ltl.Formula, polarity: bool, spot_formulas: SpotFormulas) -> Any:
    """The automaton of a formula or its negation; bounded ones are translated in parts."""
    if total_bound(formula) == 0 and spot_formulas.alive is None:
        return spot_formulas.translate(_language(formula, polarity, spot_formulas), *_SHAPE)
    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return _combined(operand, not polarity, spot_formulas)
        case ltl.Binary(ltl.BinaryOperator.AND | ltl.BinaryOperator.OR as operator, left, right):
            join = spot.product if (operator is _AND) is polarity else spot.product_or
            parts = [_combined(part, polarity, spot_formulas) for part in (left, right)]
            return _shaped(join(*parts))
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right):
            return _combined(ltl.Binary(_OR, ltl.Unary(_NOT, left), right), polarity, spot_formulas)
        case ltl.Binary(ltl.BinaryOperator.IFF | ltl.BinaryOperator.XOR as operator, left, right):
            whole = _by_progression(formula, polarity, spot_formulas)
            if whole is not None:
                return whole
            same = (operator is ltl.BinaryOperator.IFF) is polarity
            other = right if same else ltl.Unary(_NOT, right)
            yes = ltl.Binary(_AND, left, other)
            no = ltl.Binary(_AND, ltl.Unary(_NOT, left), ltl.Unary(_NOT, other))
            return _combined(ltl.Binary(_OR, yes, no), True, spot_formulas)
    whole = _by_progression(formula, polarity, spot_formulas)
    if whole is not None:
        return whole
    return _by_trial(_language(formula, polarity, spot_formulas), spot_formulas)


def _by_progression(
    formula: ltl.Formula, polarity: bool, spot_formulas: SpotFormulas
) -> Any | None:
    """The automaton by formula progression; None if prefixes do not decide the formula."""
    progression = Progression(formula if polarity else ltl.Unary(_NOT, formula), spot_formulas)
    if spot_formulas.alive is not None:
        return _shaped(progression.finite(spot_formulas.alive))
    if progression.is_decided:
        return _shaped(progression.infinite())
    return None


def _language(formula: ltl.Formula, polarity: bool, spot_formulas: SpotFormulas) -> Any:
    spot_formula = spot_formulas.formula_of(formula)
    return spot_formulas.language([spot_formula if polarity else F.Not(spot_formula)])


def _by_trial(language: Any, spot_formulas: SpotFormulas) -> Any:
    """The automaton of a language by the first method that is quick enough.

    Spot sees bounds as nested nexts. Of the non-deterministic automata of the language and of its
    complement, one is often far smaller.
    """

    def plain() -> Any:
        return spot_formulas.translate(language, *_SHAPE)

    def itself() -> Any:
        return spot.postprocess(_determinised(language, spot_formulas), *_SHAPE)

    def complement() -> Any:
        return spot.postprocess(
            spot.dualize(_determinised(F.Not(language), spot_formulas)), *_SHAPE
        )

    ways: tuple[Callable[[], Any], ...] = (plain, itself, complement)
    for way in ways:
        if tried(way, _TRY_CPU_S) is not None:
            return way()
    return plain()


def _determinised(language: Any, spot_formulas: SpotFormulas) -> Any:
    guessing = spot_formulas.translate(language, "BA", "low")
    # Not pretty; with components, simulation, and without stutter invariance.
    return spot.tgba_determinize(guessing, False, True, True, False)


def check(
    automaton: Any,
    formula: Formula,
    spot_formulas: SpotFormulas,
    memories: Sequence[Memory] = (),
    cpu_s: float | None = None,
) -> None:
    """Check that an automaton accepts exactly the formula's language.

    ``formula`` may contain ``memories``, the automaton must not. Each word determines the values of
    the memories by their definitions; it belongs to the language if ``formula`` holds with these
    values. With ``cpu_s``, each direction may take that much processor time and is skipped if it
    takes more. Raises CheckError if the languages differ, or if the automaton is not deterministic
    and complete.
    """
    fresh = {spot_formulas.formula_of(memory.atom).ap_name() for memory in memories}
    if (
        not spot.is_deterministic(automaton)
        or not spot.is_complete(automaton)
        or not fresh.isdisjoint(ap.ap_name() for ap in automaton.ap())
    ):
        raise CheckError
    spot_formula = spot_formulas.formula_of(formula)
    defined = [spot_formulas.formula_of(definition(memory)) for memory in memories]
    no_word = F.Not(spot_formulas.language([]))
    outside = F.Or([no_word, spot_formulas.language([F.Not(spot_formula), *defined])])
    inside = spot_formulas.language([spot_formula, *defined])

    def meets_outside() -> bool:
        return bool(automaton.intersects(spot_formulas.translate(outside, "BA", "low")))

    def misses_inside() -> bool:
        return bool(
            spot.dualize(automaton).intersects(spot_formulas.translate(inside, "BA", "low"))
        )

    for is_wrong in (meets_outside, misses_inside):
        if is_wrong() if cpu_s is None else tried(is_wrong, cpu_s):
            raise CheckError


def tried(question: Callable[[], object], cpu_s: float) -> bool | None:
    """The answer to a question; None if it exceeds the limits on time or memory.

    It is computed in a forked process, since Spot cannot be interrupted.
    """
    with warnings.catch_warnings():
        # Python 3.12 warns about other threads, but the forked process does not use them.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        status = 2
        try:
            signal.signal(signal.SIGPROF, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_PROF, cpu_s)
            status = int(bool(question()))
        finally:
            os._exit(status)
    _, ended = os.waitpid(child, 0)
    status = os.waitstatus_to_exitcode(ended)
    return bool(status) if status in (0, 1) else None
