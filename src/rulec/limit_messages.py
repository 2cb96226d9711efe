"""Messages about limits on the cost of a question."""

from __future__ import annotations

from rulec.diagnostics.code import Code

OVER_LIMIT = Code(
    "R0718",
    title="a computation exceeds its limit",
    why="Computations whose time or memory grows with a number in the input, rather than with its "
    "size, are limited, because a small file could otherwise use up all memory, or take days. The "
    "message says how much was requested, what the limit is, and how to raise it: by `rulec "
    "--limit NAME=NUMBER VERB ...`, or, also for programs, by `NAME=NUMBER` in the environment "
    "variable `RULEC_LIMITS`. docs/limits.md lists all limits.",
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
    title="a limit is unknown",
    why="A limit is set by its name and a whole number, as in `choices=5000000`; in "
    "`RULEC_LIMITS` several are separated by spaces. docs/limits.md lists all names.",
    bad="rulec --limit choices=many list",
    good="rulec --limit choices=5000000 list",
    kind="command",
)
