"""Verification of a single trace by a compiled rulebook."""

from __future__ import annotations

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.by_states import by_each_rounding, judged_by_states
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace


def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Verify a trace against every rule, for every binding of its variables.

    Raises RulecError R0501 to R0506 if it is no trace or does not fit the rulebook's vocabulary,
    R0507 if a rule was compiled for traces with another step, R0508 if a state contradicts an axiom
    on which a rule depends; errors have the trace's own place.
    """
    return by_each_rounding(trace, rulebook, _verified)


def _verified(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    try:
        # Loads NumPy, 100 ms, which a browser does not have.
        from rulec.monitoring.batch.verify_joined import verdict_in_arrays
    except ModuleNotFoundError as missing:
        if missing.name != "numpy":
            raise
        return judged_by_states(trace, rulebook)
    return verdict_in_arrays(trace, rulebook) or judged_by_states(trace, rulebook)
