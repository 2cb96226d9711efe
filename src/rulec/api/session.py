"""A session: all verbs, with a shared search path, day and warning listener."""

from __future__ import annotations

from rulec.api.rulebook_questions import RulebookQuestions
from rulec.api.scenario_verbs import ScenarioVerbs
from rulec.api.trace_verbs import TraceVerbs


class Session(RulebookQuestions, TraceVerbs, ScenarioVerbs):
    """Every verb of rulec, for one search path and one day.

    ``Session(search_path=(), at="", on_warning=...)``. The functions of the package ``rulec`` are
    those of a session with the default settings.
    """
