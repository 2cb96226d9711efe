"""The children of an XML file's root as trees, one after the other.

Only one of them is in memory at a time, so a file may be larger than that.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rulec.recordings.encodings.safe_xml import scan_names
from rulec.recordings.encodings.tree import LONGEST_TEXT, MOST_ELEMENTS, Tree
from rulec.recordings.encodings.xml_element import XmlFormat, short


def scan_trees(
    path: Path,
    form: XmlFormat,
    root: Callable[[Tree], None],
    child: Callable[[Tree], None],
) -> None:
    """Scan an XML file once; callbacks get the root, without children, and each of its children.

    Raises RulecError R0610 for a file that is none, R0701 for one that cannot be read.
    """
    # The elements that have begun
    open_trees: list[Tree] = []
    count = 0

    def begin(name: str, attributes: dict[str, str], line: int) -> None:
        nonlocal count
        tree = Tree(name, attributes, line, path, form)
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

    scan_names(path, form, begin, end=end, text=text)
