"""The verbs of a session with default settings, as functions of ``rulec``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.api.session import Session
from rulec.api.session_settings import ignore
from rulec.diagnostics import Diagnostic

if TYPE_CHECKING:
    from rulec.api.rulebook_compilation import Rules
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.rulebook.rulebook_model import Rulebook

_USUAL = Session()


def load_rulebook(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> Rulebook:
    """Read a rulebook: names resolved, types checked, not compiled.

    ``reference`` is a name, looked up as NAME.rules and NAME/NAME.rules in the folders of
    ``search_path`` and then among the rulebooks that ship with rulec; or a path, which contains a
    ``/`` or ends in ``.rules``. ``at`` is the day (ISO) whose law applies; if empty, that of its
    `law` line or else today. Raises RulecError with every mistake in it, in the rulebooks that it
    extends and in their vocabularies.
    """
    return Session(search_path, at).load_rulebook(reference)


def compile_rulebook(
    reference: Rules,
    search_path: Sequence[str | Path] = (),
    warn: Callable[[Sequence[Diagnostic]], object] = ignore,
    step_s: Fraction | float | None = None,
    at: str = "",
) -> CompiledRulebook:
    """Compile a rulebook: name, path of source or compiled file, or Rulebook.

    ``warn`` is called with warnings. The rest is as for ``load_rulebook`` and
    ``Session.compile_rulebook``.
    """
    return Session(search_path, at, warn).compile_rulebook(reference, step_s=step_s)


alternative_counts = _USUAL.alternative_counts
analyze = _USUAL.analyze
audit = _USUAL.audit
audit_source = _USUAL.audit_source
check = _USUAL.check
coverage = _USUAL.coverage
diff = _USUAL.diff
doc = _USUAL.doc
draw = _USUAL.draw
draw_drive = _USUAL.draw_drive
envelope = _USUAL.envelope
envelopes = _USUAL.envelopes
explain = _USUAL.explain
find = _USUAL.find
find_maneuvers = _USUAL.find_maneuvers
format = _USUAL.format
formats = _USUAL.formats
judge_recording = _USUAL.judge_recording
lineage = _USUAL.lineage
list = _USUAL.list
load_scenario = _USUAL.load_scenario
load_vocabulary = _USUAL.load_vocabulary
navigation_graph = _USUAL.navigation_graph
new_rulebook = _USUAL.new_rulebook
parse_rulebook = _USUAL.parse_rulebook
rates_of_findings = _USUAL.rates_of_findings
read_recording = _USUAL.read_recording
read_traces = _USUAL.read_traces
rule_probabilities = _USUAL.rule_probabilities
score = _USUAL.score
score_trajectories = _USUAL.score_trajectories
show = _USUAL.show
test = _USUAL.test
traces = _USUAL.traces
tree = _USUAL.tree
verify = _USUAL.verify
verify_cells = _USUAL.verify_cells
verify_columns = _USUAL.verify_columns
verify_compiled = _USUAL.verify_compiled
verify_many = _USUAL.verify_many
verify_recording = _USUAL.verify_recording
write_compiled = _USUAL.write_compiled
write_ltl = _USUAL.write_ltl
write_monitor = _USUAL.write_monitor
write_traces = _USUAL.write_traces
compile = compile_rulebook
