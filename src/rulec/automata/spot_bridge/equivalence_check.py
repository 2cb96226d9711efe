"""Comparison of automata with the formulas that they came from."""

from __future__ import annotations

import os
import signal
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import spot

from rulec.automata.compiler_jobs import CheckError
from rulec.automata.spot_bridge.spot_formulas import F, SpotFormulas
from rulec.logic.formula import Formula
from rulec.logic.past_registers import Memory, definition


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
