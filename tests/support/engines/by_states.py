"""The answer to a trace that is judged state by state, without arrays."""

from rulec.monitoring.verify import verify_by_states, verify_or_reason


def by_states(item, rulebook):
    """``verify_or_reason``, by the engine for what arrays do not tell."""
    return verify_or_reason(item, rulebook, verify_by_states)
