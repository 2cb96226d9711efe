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

WRONG_KIND_OF_FILE = Code("R0206")

EXTENDS_CIRCLE = Code("R0213")

NAME_NOT_FOUND = Code("R0703")


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
