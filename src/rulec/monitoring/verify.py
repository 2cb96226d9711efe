"""Verification of a single trace by a compiled rulebook."""

from __future__ import annotations

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.by_states import judged_by_states, rulebook_for_trace
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace


def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Verify a trace against every rule, for every binding of its variables.

    Raises RulecError R0501 to R0506 if it is no trace or does not fit the rulebook's vocabulary,
    R0507 if a rule was compiled for traces with another step, R0508 if a state contradicts an axiom
    on which a rule depends; errors have the trace's own place.
    """
    check_trace(trace)
    rulebook = rulebook_for_trace(trace, rulebook)
    try:
        # Loads NumPy, 100 ms, which a browser does not have.
        from rulec.monitoring.batch.verify_joined import verdict_in_arrays
    except ModuleNotFoundError as missing:
        if missing.name != "numpy":
            raise
        return judged_by_states(trace, rulebook)
    return verdict_in_arrays(trace, rulebook) or judged_by_states(trace, rulebook)
