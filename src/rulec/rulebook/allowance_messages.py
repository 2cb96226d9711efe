"""Messages about invalid comments that allow warnings."""

from __future__ import annotations

from rulec.diagnostics.code import Code

UNFIT_ALLOWANCE = Code(
    "R0219",
    title="a comment allows nothing, or gives no reason",
    why="The comment `# rulec: allow CODE because REASON`, at the end of the line of a warning, "
    "suppresses that warning. Errors cannot be suppressed. Comments that suppress nothing are "
    "reported, so that they do not outlive their reason.",
    bad="rulebook example\nsignal p, q\nhard rule r { require always p }  "
    "# rulec: allow R0208 because q comes later\n",
    good="rulebook example\nsignal p\nparam pace = 7 km/h  # rulec: allow R0208 because a later "
    "rule reads it\nhard rule r { require always p }\n",
)
