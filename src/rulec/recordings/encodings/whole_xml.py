"""XML files that are small and as they should be, in a third of the time that `xml_tree` takes.

The standard library's builder makes them in one go. Whoever finds anything unusual in what is made
of it reads the file again with `xml_tree`, which has the line of every element.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError, ParserCreate

from rulec.recordings.encodings.safe_xml import blocks_of
from rulec.recordings.encodings.tree import LONGEST_TEXT, FileFormat, Tree
from rulec.recordings.encodings.xml_element import XmlFormat

LARGEST_BYTES = 4_000_000
"""Larger files are read one child of the root after the other, in little memory."""

MOST_TAGS = 600_000
"""Of elements that begin and end, together: some 60 MB of memory."""

DEEPEST = 20

_HEAD_BYTES = 4096


def whole_tree(path: Path, form: XmlFormat, raw: Mapping[str, str]) -> Tree | None:
    """The root of an XML file with all in it, without lines; None if it takes a closer look.

    ``raw``: of elements with these names the children with that one are left as the library has
    them. Raises RulecError R0610 for what is packed and damaged, R0701 for a file that cannot be
    read.
    """
    data = bytearray()
    for block in blocks_of(path, form):
        data += block
        if len(data) > LARGEST_BYTES:
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
    """An element that was left raw as a tree. Raises ValueError if it is too deep."""
    return _tree(element, path, form, {})


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
