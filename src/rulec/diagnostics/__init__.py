"""Mistakes as data: places in a text, codes, messages.

Nothing here prints; ``rulec.report`` turns diagnostics into text.
"""

from rulec.diagnostics.diagnostic import Diagnostic, Fix, Label, Offer, RulecError
from rulec.diagnostics.phrases import any_of, did_you_mean, first_of, named, nearest_name
from rulec.diagnostics.source_text import Source, SourceLocation, Span

__all__ = [
    "Diagnostic",
    "Fix",
    "Label",
    "Offer",
    "RulecError",
    "Source",
    "SourceLocation",
    "Span",
    "any_of",
    "did_you_mean",
    "first_of",
    "named",
    "nearest_name",
]
