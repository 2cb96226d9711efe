"""Messages about formulas, orders and families that are too large."""

from __future__ import annotations

from rulec.diagnostics.code import Code

FORMULA_TOO_LARGE = Code(
    "R0323",
    title="a formula becomes too large when definitions, conditions and exceptions are expanded",
    why="Each of them is expanded where it is used. Definitions that use others twice, several "
    "conditional numbers, and exceptions that hold throughout multiply the size.",
    bad="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a throughout unless b throughout unless c throughout\n"
    "  unless d throughout unless e throughout\n}\n",
    good="rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
    "not wet)\n"
    "  unless a or b or c or d or e throughout\n}\n",
)

TOO_LONG = Code(
    "R0327",
    title="a chain of rulebooks, or an order of levels, is too long",
    why="A rulebook may build upon 50 others, one upon another, and have 100 levels of priority: "
    "far more than any family of laws has, and more than anyone can keep in mind. Where a chain "
    "comes from a program, or from one rulebook for each amendment, let a rulebook extend a more "
    "general one directly, and state itself what the rulebooks between them change; for "
    "amendments, `in force from` gives the values of several days in one rulebook. Instead of so "
    "many levels, give rules of one level weights.",
    bad="""echo 'rulebook b0 signal p hard rule r { require never p }' > b0.rules
n=0
while [ $n -le 50 ]; do
  echo "rulebook b$((n + 1)) extends b$n" > b$((n + 1)).rules
  n=$((n + 1))
done
rulec check b51.rules""",
    good="""echo 'rulebook b0 signal p hard rule r { require never p }' > b0.rules
n=0
while [ $n -le 50 ]; do
  echo "rulebook b$((n + 1)) extends b0" > b$((n + 1)).rules
  n=$((n + 1))
done
rulec check b51.rules""",
    kind="command",
)
