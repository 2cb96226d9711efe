"""Messages about limits on what a question may cost."""

from __future__ import annotations

from rulec.diagnostics.code import Code

OVER_LIMIT = Code(
    "R0718",
    title="a question is larger than its limit",
    why="What costs time or memory that grows with a number in the input, not with its size, has a "
    "limit: a small file could otherwise take all memory of the machine, or days. The message says "
    "how much was asked for, what the limit is, and how to lift it, by `rulec --limit NAME=NUMBER "
    "VERB ...`, or by `NAME=NUMBER` in the environment variable `RULEC_LIMITS` for programs, too. "
    "docs/limits.md lists all limits.",
    bad="""cat > close.rules <<.
rulebook close
type car
signal near(a: car, b: car) default false
hard rule gap (a: car, b: car) { require always not near(a, b) }
.
echo '{"objects": {"v": "car", "w": "car"}, "states": [{}]}' > t.jsonl
rulec --limit choices=1 verify t.jsonl -r close.rules""",
    good="""cat > close.rules <<.
rulebook close
type car
signal near(a: car, b: car) default false
hard rule gap (a: car, b: car) { require always not near(a, b) }
.
echo '{"objects": {"v": "car", "w": "car"}, "states": [{}]}' > t.jsonl
rulec --limit choices=2 verify t.jsonl -r close.rules""",
    kind="command",
)

NO_LIMIT = Code(
    "R0719",
    title="a limit is set that there is not",
    why="A limit is set by its name and a whole number, as in `choices=5000000`; several in "
    "`RULEC_LIMITS` have spaces between them. docs/limits.md lists all names.",
    bad="rulec --limit choices=many list",
    good="rulec --limit choices=5000000 list",
    kind="command",
)
