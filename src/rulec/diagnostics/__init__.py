"""Mistakes as data: places in a text, codes, messages.

Nothing here prints; ``rulec.report`` turns diagnostics into text.
"""

from rulec.diagnostics.diagnostic import Diagnostic as Diagnostic
from rulec.diagnostics.diagnostic import Fix as Fix
from rulec.diagnostics.diagnostic import Label as Label
from rulec.diagnostics.diagnostic import Offer as Offer
from rulec.diagnostics.diagnostic import RulecError as RulecError
from rulec.diagnostics.diagnostic import Source as Source
from rulec.diagnostics.diagnostic import SourceLocation as SourceLocation
from rulec.diagnostics.diagnostic import Span as Span
from rulec.diagnostics.phrases import any_of as any_of
from rulec.diagnostics.phrases import did_you_mean as did_you_mean
from rulec.diagnostics.phrases import first_of as first_of
from rulec.diagnostics.phrases import named as named
from rulec.diagnostics.phrases import nearest_name as nearest_name
