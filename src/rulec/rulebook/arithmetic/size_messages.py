"""Messages about formulas, orders and families that are too large."""

from __future__ import annotations

from rulec.diagnostics.code import Code

FORMULA_TOO_LARGE = Code(
    "R0323",
    title="a formula becomes too large when definitions and conditions are expanded",
    why="Each of them is expanded where it is used. Definitions that use others several times, and "
    "several conditional numbers, multiply the size.",
    bad="rulebook example\nsignal d0\n"
    + "".join(
        f"define d{n} = {' and '.join([f'd{n - 1}'] * 8)}\n"  # 8 times as large as the one before
        for n in range(1, 6)
    )
    + "hard rule r { require never d5 }\n",
    good="rulebook example\nsignal d0\ndefine d1 = d0\nhard rule r { require never d1 }\n",
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
    bad="echo 'rulebook b0 signal p hard rule r { require never p }' > b0.rules\nn=0\n"
    "while [ $n -le 50 ]; do\n"
    '  echo "rulebook b$((n + 1)) extends ⟪b$n|b0⟫" > b$((n + 1)).rules\n  n=$((n + 1))\ndone\n'
    "rulec check b51.rules",
    kind="command",
)
