"""The registry of diagnostic codes, with what each kind of message is about.

The hundreds name the stage that speaks: 1 syntax, 2 names, 3 types and meaning, 4 compiling,
5 traces, 6 scenarios and graphs, 7 files, 8 analysis. A code is registered by explaining it, in
the file of its stage in ``explanations``; docs/codes.md is made from there.
"""

from __future__ import annotations

from rulec.diagnostics.explanations.analysis import ANALYSIS
from rulec.diagnostics.explanations.compiling import COMPILING
from rulec.diagnostics.explanations.explanation import Explanation
from rulec.diagnostics.explanations.files import FILES
from rulec.diagnostics.explanations.meaning import MEANING
from rulec.diagnostics.explanations.names import NAMES
from rulec.diagnostics.explanations.overlays import OVERLAY_MEANING, OVERLAY_NAMES
from rulec.diagnostics.explanations.scenarios import SCENARIOS
from rulec.diagnostics.explanations.syntax import SYNTAX
from rulec.diagnostics.explanations.traces import TRACES

STAGES: dict[str, dict[str, Explanation]] = {
    "Syntax": SYNTAX,
    "Names": {**NAMES, **OVERLAY_NAMES},
    "Types and meaning": {**MEANING, **OVERLAY_MEANING},
    "Compiling and examples": COMPILING,
    "Traces": TRACES,
    "Scenarios and graphs": SCENARIOS,
    "Files": FILES,
    "Analysis": ANALYSIS,
}
"""The stages by their names, with their codes."""

EXPLANATIONS = {code: one for codes in STAGES.values() for code, one in codes.items()}

CODES: dict[str, str] = {code: one.title for code, one in EXPLANATIONS.items()}
"""Code -> what it is about, in one line."""
