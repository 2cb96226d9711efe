"""What went wrong, as data: places in a text, messages, and the registry of codes.

Nothing here prints. ``rulec.report`` turns diagnostics into text.
"""

from rulec.diagnostics.diagnostic import Diagnostic, Label, RulecError
from rulec.diagnostics.nearest import nearest_name
from rulec.diagnostics.phrases import any_of, did_you_mean, named
from rulec.diagnostics.source_text import Place, Source, Span

__all__ = [
    "Diagnostic",
    "Label",
    "Place",
    "RulecError",
    "Source",
    "Span",
    "any_of",
    "did_you_mean",
    "named",
    "nearest_name",
]
