"""Automata compared with the formulas that they came from."""

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
    """Check that an automaton accepts the formula's language and nothing else.

    ``formula`` may speak of ``memories``, the automaton must not. Every word has one way to choose
    them as they are defined: it is inside if so completed ``formula`` holds for it, else outside.
    With ``cpu_s``, each direction may take so much processor time and is left out if it takes more.
    Raises CheckError if they differ, or if the automaton is not deterministic and complete.
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
    """Answer of a question; None beyond the limits on time or memory.

    It is asked in a copy of this process, for Spot cannot be stopped.
    """
    with warnings.catch_warnings():
        # Other threads, which Python 3.12 warns of, have no part in what the copy does.
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
