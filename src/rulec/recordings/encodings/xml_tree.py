"""XML files as trees.

Small ones that are as they should be are made in one go by the standard library's builder, which
takes a third of the time. Of others the root's children come one after the other, with the line of
every element; only one of them is in memory at a time, so a file may be larger than that.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError, ParserCreate

from rulec.recordings.encodings.safe_xml import blocks_of, scan_names
from rulec.recordings.encodings.tree import LONGEST_TEXT, MOST_ELEMENTS, FileFormat, Tree
from rulec.recordings.encodings.xml_element import XmlFormat, short

LARGEST_BYTES = 4_000_000
"""Larger files are read one child of the root after the other, in little memory."""

MOST_TAGS = 600_000
"""Of elements that begin and end, together: some 60 MB of memory."""

DEEPEST = 20

_HEAD_BYTES = 4096


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


def whole_tree(path: Path, form: XmlFormat, raw: Mapping[str, str]) -> Tree | None:
    """The root of an XML file with all in it, without lines; None if it takes a closer look.

    ``raw``: of elements with these names the children with that one are left as the library has
    them. Raises RulecError R0610 for what is packed and damaged, R0701 for a file that cannot be
    read.
    """
    data = bytearray()
    for block in blocks_of(path):
        data += block
        if len(data) > min(LARGEST_BYTES, form.largest_bytes):
            return None
    is_plain = b"\0" not in data and b"xmlns" not in data and data.count(b"<") <= MOST_TAGS
    if not is_plain or not _begins_well(bytes(data[:_HEAD_BYTES]), form):
        return None
    try:
        # The prolog, in which alone entities can be defined, has been looked at.
        return _tree(ElementTree.fromstring(bytes(data)), path, form, raw)
    except (ElementTree.ParseError, LookupError, ValueError):
        return None


def tree_of(element: ElementTree.Element, path: Path, form: FileFormat) -> Tree:
    """An element that was left raw as a tree. Raises RulecError R0610 if it is too deep."""
    try:
        return _tree(element, path, form, {})
    except ValueError:
        raise form.refused(path, f"an element `{short(element.tag)}` is too deep") from None


def _begins_well(head: bytes, form: XmlFormat) -> bool:
    """True if the root begins in the first bytes of a file, with nothing defined before."""
    parser = ParserCreate()
    seen: list[str] = []

    def root(name: str, _: object) -> None:
        seen.append(name)
        parser.StartElementHandler = None

    parser.StartElementHandler = root
    parser.StartDoctypeDeclHandler = lambda *_: seen.append("")
    try:
        parser.Parse(head, False)
    except (ExpatError, LookupError, ValueError):
        return False
    return seen[:1] == [form.root]


@contextmanager
def no_collection() -> Iterator[None]:
    """Let no garbage be looked for while a tree is made and read.

    It has hundreds of thousands of elements; none is garbage, which takes long to find out.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _tree(
    element: ElementTree.Element,
    path: Path,
    form: FileFormat,
    raw: Mapping[str, str],
    depth: int = 0,
) -> Tree:
    if depth > DEEPEST:
        raise ValueError
    text = element.text
    tree = Tree(element.tag, element.attrib, 0, path, form)
    alike = raw.get(element.tag)
    left: list[ElementTree.Element] = []
    for child in element:
        if child.tag == alike:
            left.append(child)
        else:
            tree.children.append(_tree(child, path, form, raw, depth + 1))
        if child.tail is not None and not child.tail.isspace():
            text = (text or "") + child.tail
    tree.raw = left or ()
    if text is not None and not text.isspace():
        tree.text = text[:LONGEST_TEXT]
    return tree
