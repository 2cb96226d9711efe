"""XML files as trees.

Small, regular files are built in one go by the standard library, which takes a third of the time;
runs of uniform elements are taken out before. In other files the root's children are read one after
the other, with the line of every element; only one of them is in memory at a time, so the file may
be larger than memory.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from xml.etree import ElementTree

from rulec.recordings.encodings.file_format import FileFormat, XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.safe_xml import blocks_of, scan
from rulec.recordings.encodings.tree import LONGEST_TEXT, MOST_ELEMENTS, AlikeElements, Tree

LARGEST_BYTES = 4_000_000
"""Files of more bytes are read one child of the root at a time, with little memory."""

MOST_TAGS = 600_000
"""Limit on start and end tags together: about 60 MB of memory."""

DEEPEST = 20

_ATTRIBUTE = "rulec-alike"
_MARK = b"rulec-alike="
_NOT_PLAIN = (b"\0", b"xmlns", b"<!DOCTYPE", _MARK)
"""What namespaces, definitions of entities, and letters of several bytes cannot do without.

No encoding that the parser takes has another byte for a letter of ASCII.
"""
_MOST_TAGS_ALIKE, _MOST_SHAPES = 60, 8
_TAG = re.compile(rb"<(/?)([A-Za-z]+)>([^<]*)")


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


Way = tuple[str, ...]
"""A path of element names, each within the one before."""


@dataclass(frozen=True, slots=True)
class Alike:
    """Elements ``child``, of which each ``parent`` has very many.

    ``wanted``: maps the path of names to each text in a child to whether that text is wanted; None
    if such elements must be read one by one.
    """

    parent: str
    child: str
    wanted: Callable[[Sequence[Way]], Sequence[int] | None]


def whole_tree(path: Path, form: XmlFormat, alike: Sequence[Alike]) -> Tree | None:
    """The root of an XML file with all its content, without lines; None if it needs ``scan_trees``.

    No trees are made of elements that are ``alike``. Raises RulecError R0610 if a packed file is
    damaged, R0701 if it cannot be read.
    """
    data = bytearray()
    for block in blocks_of(path):
        data += block
        if len(data) > min(LARGEST_BYTES, form.largest_bytes):
            return None
    if any(sign in data for sign in _NOT_PLAIN) or data.count(b"<") > MOST_TAGS:
        return None
    rest, runs = without_alike(bytes(data), alike)
    try:
        root = ElementTree.fromstring(rest)
        return _tree(root, path, form, runs) if root.tag == form.root else None
    except (ElementTree.ParseError, LookupError, ValueError):
        return None


def without_alike(data: bytes, alike: Sequence[Alike]) -> tuple[bytes, list[AlikeElements]]:
    """A document without runs of uniform elements, and these runs.

    An attribute of the parent holds the number of the run removed from it. Only elements without
    attributes, blanks, and texts without markup are removed, so a document that is not well-formed
    stays so.
    """
    parts: list[bytes] = []
    runs: list[AlikeElements] = []
    at = 0
    for begin, first, last, elements in sorted(
        (cut for shape in alike for cut in _cuts(data, shape)), key=itemgetter(0)
    ):
        # Removed runs are not searched again
        if begin > at:
            parts += (data[at : begin - 1], b' %s"%d">' % (_MARK, len(runs)), data[begin:first])
            runs.append(elements)
            at = last
    return b"".join((*parts, data[at:])), runs


_Cut = tuple[int, int, int, AlikeElements]
"""Where the parent's tag ends, where its children begin and end, and their contents."""


def _cuts(data: bytes, alike: Alike) -> Iterator[_Cut]:
    opening, closing = b"<%s>" % alike.parent.encode(), b"</%s>" % alike.parent.encode()
    child, end_of_child = b"<%s>" % alike.child.encode(), b"</%s>" % alike.child.encode()
    shapes: list[_Shape] = []
    at = data.find(opening)
    while at >= 0 and (end := data.find(closing, at)) >= 0:
        begin = at + len(opening)
        first = data.find(child, begin, end)
        last = data.rfind(end_of_child, begin, end) + len(end_of_child)
        if begin <= first < last and not data[begin:first].strip():
            run = data[first:last]
            elements = _elements(run, shapes)
            if elements is None and len(shapes) < _MOST_SHAPES:
                shapes += [shape for shape in (_shape(run, end_of_child, alike),) if shape]
                elements = _elements(run, shapes[-1:])
            if elements is not None:
                yield begin, first, last, elements
        at = data.find(opening, end)


@dataclass(frozen=True, slots=True)
class _Shape:
    """A pattern that matches elements with the same child elements, and the tags that each has.

    ``order``: the positions of the wanted texts among those matched.
    """

    pattern: re.Pattern[bytes]
    tags: int
    order: tuple[int, ...]


def _elements(run: bytes, shapes: Sequence[_Shape]) -> AlikeElements | None:
    """The elements of a run, if each matches one of the shapes and there is no other tag."""
    tags = run.count(b"<")
    for shape in shapes:
        matches = shape.pattern.findall(run)
        if len(matches) * shape.tags == tags:
            columns = tuple(zip(*matches, strict=True))
            return AlikeElements(len(matches), tuple(columns[place] for place in shape.order))
    return None


def _shape(run: bytes, end_of_child: bytes, alike: Alike) -> _Shape | None:
    """The shape of the first element of a run; None if it must be read by itself."""
    whole = run[: run.find(end_of_child) + len(end_of_child)]
    tags = _TAG.findall(whole)
    if len(tags) > _MOST_TAGS_ALIKE or b"".join(b"<%s%s>%s" % tag for tag in tags) != whole:
        return None
    ways: list[Way] = []
    leaves: list[int] = []
    here: list[str] = []
    for place, (closes, name, _) in enumerate(tags):
        if not closes:
            here.append(name.decode())
            if place + 1 < len(tags) and tags[place + 1][:2] == (b"/", name):
                leaves.append(place)
                ways.append(tuple(here[1:]))
        elif not here or here.pop().encode() != name:
            return None
    wanted = None if here else alike.wanted(ways)
    if wanted is None:
        return None
    groups = {leaves[number]: number for number in wanted}
    pattern = [
        b"<%s%s>" % (closes, name)
        + (b"([^<]*)" if place in groups else b"[^<]*" if place in leaves else rb"\s*")
        for place, (closes, name, _) in enumerate(tags)
    ]
    order = sorted(wanted)
    return _Shape(
        re.compile(b"".join(pattern)), len(tags), tuple(order.index(number) for number in wanted)
    )


def _tree(
    element: ElementTree.Element,
    path: Path,
    form: FileFormat,
    alike: Sequence[AlikeElements],
    depth: int = 0,
) -> Tree:
    if depth > DEEPEST:
        raise ValueError
    text = element.text
    tree = Tree(element.tag, element.attrib, 0, path, form)
    number = element.attrib.pop(_ATTRIBUTE, None)
    if number is not None:
        tree.alike = alike[int(number)]
    for child in element:
        tree.children.append(_tree(child, path, form, alike, depth + 1))
        if child.tail is not None and not child.tail.isspace():
            text = (text or "") + child.tail
    if text is not None and not text.isspace():
        tree.text = text[:LONGEST_TEXT]
    return tree
