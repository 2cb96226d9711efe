"""XML as a stream, safe against malicious files, with little memory.

Documents that define entities are refused at the definition, before anything is expanded or
fetched. Packed files are unpacked while they are read (`read_files.opened`), up to the same limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate, XMLParserType, errors

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened
from rulec.recordings.encodings.file_format import FileFormat, XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import Tree
from rulec.trace.formats.stream_lines import packed

LONGEST_TAG = 1_000_000
"""Limit on the bytes of a tag: expat keeps a tag in memory until it ends."""

_BLOCK = 1 << 16
_SUFFIXES = (".xml", ".xml.gz")
_ENDS_EARLY = (
    errors.XML_ERROR_NO_ELEMENTS,
    errors.XML_ERROR_UNCLOSED_TOKEN,
    errors.XML_ERROR_UNCLOSED_CDATA_SECTION,
    errors.XML_ERROR_PARTIAL_CHAR,
)


def scan(
    path: Path,
    form: XmlFormat,
    begin: Callable[[Tree], None],
    *,
    end: Callable[[str], None] | None = None,
    comment: Callable[[str], None] | None = None,
    text: Callable[[str], None] | None = None,
) -> None:
    """Scan an XML file once, with callbacks for element starts and ends, comments, and text.

    ``begin`` gets the same object for every element, with no text, and must not keep it. Text comes
    in pieces of some kB. Raises RulecError R0610 if it is not such a file, R0701 if it cannot be
    read.
    """
    parser = ParserCreate()
    # One for all: a file has millions, and to make one takes as long as to read its attributes
    latest = Tree("", {}, 0, path, form)

    def element(name: str, attributes: dict[str, str]) -> None:
        latest.name, latest.attributes = name, attributes
        latest.place = parser.CurrentLineNumber
        begin(latest)

    def root(name: str, attributes: dict[str, str]) -> None:
        if name != form.root:
            why = f"it is XML, but of `{short(name)}`, not of `{form.root}`"
            raise form.refused(path, why, parser.CurrentLineNumber)
        parser.StartElementHandler = element
        element(name, attributes)

    def definition(*_: object) -> None:
        why = "it has a `DOCTYPE`, which this format has not, and which could define anything"
        way_out = "take the `<!DOCTYPE …>` out"
        raise form.refused(path, why, parser.CurrentLineNumber, help_text=way_out)

    parser.StartElementHandler = root
    parser.StartDoctypeDeclHandler = definition
    if end is not None:
        parser.EndElementHandler = end
    if comment is not None:
        parser.CommentHandler = comment
    if text is not None:
        parser.buffer_text = True
        parser.CharacterDataHandler = text
    size = 0
    try:
        for block in blocks_of(path):
            size += len(block)
            if size > form.largest_bytes:
                why = f"it is too large: at most {form.largest_bytes:,} bytes are read"
                raise form.refused(path, why)
            _parse(parser, block, path, form)
            if size - max(parser.CurrentByteIndex, 0) > LONGEST_TAG + _BLOCK:
                why = f"it has a tag of more than {LONGEST_TAG:,} bytes"
                raise form.refused(path, why, parser.CurrentLineNumber)
        if not size:
            raise form.refused(path, "it is empty")
        parser.Parse(b"", True)
    except ExpatError as problem:
        why = _mistake(problem)
        if errors.messages[problem.code] in _ENDS_EARLY:
            why = "it ends in the middle of an element: it has been cut short"
        raise form.refused(path, why, problem.lineno) from None
    finally:
        # Parser and handlers refer to each other, and so keep all content in memory
        parser.StartElementHandler = parser.EndElementHandler = None
        parser.CommentHandler = parser.CharacterDataHandler = None


def _mistake(problem: ExpatError) -> str:
    words = errors.messages[problem.code]
    return f"it is not well-formed XML: {words.removeprefix('not well-formed').strip(' ()')}"


def root_of(path: Path, form: FileFormat) -> str:
    """The name of a file's root element; error messages name ``form`` as the expected format.

    Raises RulecError R0610 if the file is not XML, R0701 if it cannot be read.
    """
    parser = ParserCreate()
    names: list[str] = []

    def root(name: str, _: object) -> None:
        names.append(name)
        parser.StartElementHandler = None

    parser.StartElementHandler = root
    size, first = 0, b""
    try:
        for block in blocks_of(path):
            size += len(block)
            first = first or block
            _parse(parser, block, path, form)
            if names:
                break
            if size > LONGEST_TAG:
                raise form.refused(path, f"nothing begins in its first {LONGEST_TAG:,} bytes")
        if not size:
            raise form.refused(path, "it is empty")
        if not names:
            parser.Parse(b"", True)
    except ExpatError as problem:
        if not names and (kind := packed(first)) is not None:
            raise form.refused(path, f"it is {kind.noun}", help_text=kind.help) from None
        if not names:
            why = _mistake(problem)
            raise form.refused(path, why, problem.lineno) from None
    return names[0]


def is_xml(path: Path) -> bool:
    """Whether a file's name or first bytes are those of XML, possibly packed."""
    if path.name.lower().endswith(_SUFFIXES):
        return True
    try:
        if not path.is_file():
            return False  # what comes through a pipe can be read only once
        with opened(path) as stream:
            start = stream.read(64)
    except (RulecError, OSError):
        return False  # a name that is too long, for one
    text = start.removeprefix(b"\xef\xbb\xbf").lstrip()
    return text.startswith((b"<", b"\xff\xfe<", b"\xfe\xff\0<"))


def blocks_of(path: Path) -> Iterator[bytes]:
    """The unpacked bytes of a file, in blocks. Raises RulecError R0701."""
    with opened(path) as stream:
        while block := stream.read(_BLOCK):
            yield block


def _parse(parser: XMLParserType, block: bytes, path: Path, form: FileFormat) -> None:
    try:
        parser.Parse(block, False)
    except (LookupError, ValueError):
        raise form.refused(path, "its encoding is none that is known here") from None
