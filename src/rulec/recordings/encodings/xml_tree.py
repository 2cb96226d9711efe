"""XML files as trees.

The root's children are read one after the other, with the line of every element; only one of them
is in memory at a time, so the file may be larger than memory.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.safe_xml import scan
from rulec.recordings.encodings.tree import LONGEST_TEXT, MOST_ELEMENTS, Tree


def scan_trees(
    path: Path,
    form: XmlFormat,
    root: Callable[[Tree], None],
    child: Callable[[Tree], None],
) -> None:
    """Scan an XML file once.

    Callbacks get the root, without children, and then each of its children.

    Raises RulecError R0610 if it is not such a file, R0701 if it cannot be read.
    """
    # The open elements
    open_trees: list[Tree] = []
    count = 0

    def begin(element: Tree) -> None:
        nonlocal count
        tree = Tree(element.name, element.attributes, element.place, path, form)
        count += 1
        if len(open_trees) > 1:
            open_trees[-1].children.append(tree)
            if count > MOST_ELEMENTS:
                whole = open_trees[1]
                most = f"more than {MOST_ELEMENTS:,} others in it"
                raise whole.wrong(f"the element `{short(whole.name)}` has {most}")
        elif open_trees:
            count = 0
        else:
            root(tree)
        open_trees.append(tree)

    def end(_: str) -> None:
        tree = open_trees.pop()
        if len(open_trees) == 1:
            child(tree)

    def text(words: str) -> None:
        if words.isspace():
            return
        tree = open_trees[-1]
        if not tree.text and len(words) <= LONGEST_TEXT:
            tree.text = words
        elif len(tree.text) < LONGEST_TEXT:
            tree.text = (tree.text + words)[:LONGEST_TEXT]

    scan(path, form, begin, end=end, text=text)
