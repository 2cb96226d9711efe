"""Messages about rulebooks and vocabularies that a name refers to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import line_left_out, line_of, offering, write

if TYPE_CHECKING:  # a check that is recalled does not load the parser
    from rulec.syntax import tree

WRONG_KIND_OF_FILE = Code(
    "R0206",
    title="a file has another kind or name than expected",
    why="A rulebook has rules and can be compiled; a vocabulary has declarations and can be used. "
    "A vocabulary `NAME` is found in a file `NAME.rules` that begins with `vocabulary NAME`.",
    bad="echo 'vocabulary town { signal fog }' > town.rules\nrulec compile ./town.rules -o build",
    good="echo 'vocabulary town { signal fog }' > town.rules\n"
    "echo 'rulebook city use town hard rule r { require never fog }' > city.rules\n"
    "rulec compile ./city.rules -o build",
    kind="command",
)

EXTENDS_CIRCLE = Code(
    "R0213",
    title="rulebooks extend each other in a circle",
    why="Each rulebook builds upon a more general one, up to one that extends no other. A cycle "
    "is not possible.",
    bad="printf 'rulebook a\\nextends b\\n' > a.rules\n"
    "printf 'rulebook b\\⟪nextends a|nsignal p\\nhard rule r { require always p }⟫\\n' "
    "> b.rules\nrulec check a.rules\n",
    kind="command",
)

NAME_NOT_FOUND = Code(
    "R0703",
    title="a name was not found on the search path",
    why="There is no rulebook or vocabulary of this name beside the file that refers to it or "
    "among those that ship with rulec (`rulec list`). A rulebook in a folder of its own name, such "
    "as `mine/mine.rules`, may also extend those beside that folder. To refer to a file, give its "
    "path, such as `./mine.rules`.",
    bad="rulebook example\nuse ⟪papr|paper⟫\nhard rule r { require never CONGESTED }\n",
)


def extends_circle(line: tree.ExtendsLine, way: Sequence[tree.File]) -> Diagnostic:
    names = [f"`{file.name.text}`" if file.name else "a rulebook" for file in way]
    chain = " extends ".join([*names, f"`{line.name.text}`"])
    before = [file.extends for file in way if file.extends is not None and file.extends != line]
    return EXTENDS_CIRCLE.at(
        line.name.span,
        f"the rulebooks go round in a circle: {chain}",
        expected="this closes the circle",
        help=offering(
            "the most general of them extends no other: leave its `extends` line out",
            *line_left_out(line.name.span, "extends"),
        ),
        labels=tuple(
            Label(extends.span.place, f"`{extends.name.text}` is extended here")
            for extends in before
        ),
    )


def not_the_vocabulary(use: tree.UseLine, file: tree.File, path: Path) -> Diagnostic:
    assert file.name is not None, "only files with a name have another one"
    if file.kind == "rulebook":
        message = f"`{path.name}` is a rulebook, not a vocabulary"
    else:
        message = f"`{path.name}` holds another vocabulary, `{file.name.text}`"
    return WRONG_KIND_OF_FILE.at(
        use.name.span,
        message,
        expected="expected the name of a vocabulary",
        help=f"give the vocabulary a file of its own that begins with `vocabulary {use.name.text}`",
    )


def vocabulary_for_rulebook(name: tree.Name, *, expected: str) -> Diagnostic:
    use = f"use {name.text}"
    used = (write(f"{use}\n", line) for line in line_of(name.span, "extends"))
    return WRONG_KIND_OF_FILE.at(
        name.span,
        f"`{name.text}` is a vocabulary, not a rulebook",
        expected=expected,
        help=offering(f"a rulebook takes its words from it by `{use}`", *used),
    )
