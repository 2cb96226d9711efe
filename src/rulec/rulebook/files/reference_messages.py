"""Messages about rulebooks and vocabularies that a name refers to."""

from __future__ import annotations

from rulec.diagnostics.code import Code

WRONG_KIND_OF_FILE = Code(
    "R0206",
    title="a file is of another kind or name than expected",
    why="A rulebook has rules and can be compiled; a vocabulary has declarations and can be used. "
    "A vocabulary `NAME` is found in a file `NAME.rules` that begins with `vocabulary NAME`.",
    bad="echo 'vocabulary town { signal fog }' > town.rules\nrulec compile ./town.rules -o build",
    good="echo 'vocabulary town { signal fog }' > town.rules\n"
    "echo 'rulebook city use town hard rule r { require not fog }' > city.rules\n"
    "rulec compile ./city.rules -o build",
    kind="command",
)

EXTENDS_CIRCLE = Code(
    "R0213",
    title="rulebooks extend each other in a circle",
    why="Each rulebook builds upon a more general one, up to one that extends no other.",
    bad="printf 'rulebook a\\nextends b\\n' > a.rules\n"
    "printf 'rulebook b\\nextends a\\n' > b.rules\nrulec check a.rules\n",
    good="printf 'rulebook a\\nextends b\\n' > a.rules\n"
    "printf 'rulebook b\\nsignal p\\nhard rule r { require p }\\n' > b.rules\n"
    "rulec check a.rules\n",
    kind="command",
)

NAME_NOT_FOUND = Code(
    "R0703",
    title="a name was not found on the search path",
    why="A rulebook or a vocabulary with this name is neither beside the file that asks for it "
    "nor among those that ship with rulec (`rulec list`). A file is given by its path, such "
    "as `./mine.rules`.",
    bad="rulebook example\nuse papr\nhard rule r { require not CONGESTED }\n",
    good="rulebook example\nuse paper\nhard rule r { require not CONGESTED }\n",
)
