"""Messages about a whole file and the order of its parts."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code

EXPECTED_BEGINNING = "expected `rulebook NAME`"
HOW_TO_BEGIN = "a rulebook begins with `rulebook NAME`, a vocabulary with `vocabulary NAME { … }`"

EMPTY_FILE = Code(
    "R0103",
    title="a file is empty",
    why="There is nothing in the file but blank space and comments. A rulebook begins with "
    "`rulebook NAME`, a vocabulary with `vocabulary NAME {`.",
    bad="# nothing yet\n",
    good="# as short as can be\nrulebook shortest\nsignal p\nhard rule keep_it { require p }\n",
)

MISSING_PART = Code(
    "R0114",
    title="something that must be there is missing",
    why="A file says first what it is; a rulebook has a rule, or extends another; every rule has "
    "one `require`, but for those that override another and leave it as it is.",
    bad='rulebook example\nhard rule r { says "Drive with care." }\n',
    good="rulebook example\nsignal careful\n"
    'hard rule r { says "Drive with care." require always careful }\n',
)

MISPLACED_LINE = Code(
    "R0115",
    title="a line stands in the wrong part of a file",
    why="Header lines (`title`, `law`, `use`, `extends`, `traffic`, `semantics`, `step`, "
    "`priority`) stand between `rulebook NAME` and the first item; a vocabulary holds "
    "declarations only; a file holds one rulebook or one vocabulary.",
    bad="vocabulary town {\n  signal fog\n  hard rule r { require not fog }\n}\n",
    good="rulebook town\nsignal fog\nhard rule r { require not fog }\n",
)

GIVEN_TWICE = Code(
    "R0116",
    title="something is given twice",
    why="A rulebook has one title, one law, and extends one other; a rule has one `require`, "
    "`cite`, `says` and `when`, and as many `unless` and examples as it needs. Two demands are "
    "joined by `and`, or stand in two rules.",
    bad="rulebook example\nsignal p, q\nhard rule r { require p require q }\n",
    good="rulebook example\nsignal p, q\nhard rule r { require p and q }\n",
)

NOT_A_RULEBOOK = Code(
    "R0117",
    title="a file is no rulebook",
    why="Hardly anything in the file can be read as a rulebook or a vocabulary, so it is probably "
    "another file than was meant.",
    bad="Dear all,\nplease find the rules attached.\n",
    good="rulebook attached\nsignal p\nhard rule r { require p }\n",
)


def given_twice(what: str, again: Span, first: Span) -> Diagnostic:
    return GIVEN_TWICE.at(
        again,
        f"{what} is given twice",
        expected="given again here",
        help="keep one of them",
        labels=(Label(first.place, "first given here"),),
    )


def not_a_rulebook(first: Span) -> Diagnostic:
    return NOT_A_RULEBOOK.at(
        first,
        "the file is no rulebook",
        expected=EXPECTED_BEGINNING,
        help=HOW_TO_BEGIN,
    )
