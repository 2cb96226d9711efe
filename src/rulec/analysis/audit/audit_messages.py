"""Messages about saved audits, and texts of laws."""

from __future__ import annotations

from rulec.diagnostics.code import Code

NOT_AN_AUDIT = Code(
    "R0705",
    title="an older audit cannot be read",
    why="An audit can be compared with another rulebook, or with a JSON file written by `rulec "
    "audit`. This file is something else, or is incomplete.",
    bad="echo '{}' > old.json\nrulec audit esterle2019 --compare old.json",
    good="rulec show --audit esterle2019 --output-format json > old.json\n"
    "rulec show --audit esterle2019 --compare old.json",
    kind="command",
)

NO_ARTICLES = Code(
    "R0714",
    title="a law's text has no articles",
    why="Citations of rules are looked up in the text of their law, whose articles must begin on "
    "their own lines: with Markdown headings such as `### § 5 Overtaking`, or lines such as "
    "`Article 5`, each after an empty line.",
    bad="echo 'Drive with care.' > act.md\nrulec audit de --law act.md",
    good="printf '### § 5 Overtaking\\n\\n(1) Overtake on the left.\\n' > act.md\n"
    "rulec show --audit de --law act.md",
    kind="command",
)
