"""Messages about saved audits."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_AN_AUDIT = Code(
    "R0705",
    title="an older audit cannot be read",
    why="An audit can be compared with another rulebook, or with a file that `rulec audit` has "
    "written as JSON. This file is something else, or was cut off.",
    bad="echo '{}' > old.json\nrulec audit esterle2019 --compare old.json",
    good="rulec audit esterle2019 --output-format json > old.json\n"
    "rulec audit esterle2019 --compare old.json",
    kind="command",
)
