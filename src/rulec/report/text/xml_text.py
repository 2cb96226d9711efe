"""XML elements that are written one after the other, with any text in them."""

from __future__ import annotations

import re
from xml.etree import ElementTree

_NOT_XML = re.compile("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 does not allow, not even escaped (section 2.2)."""

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


def xml_text(text: str) -> str:
    """A text allowed in XML; other characters are replaced by their codes."""
    return _NOT_XML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def element(
    parent: ElementTree.Element | None, tag: str, **attributes: object
) -> ElementTree.Element:
    """A new element, within another one unless None; attributes that are None are omitted."""
    given = {name: xml_text(str(value)) for name, value in attributes.items() if value is not None}
    if parent is None:
        return ElementTree.Element(tag, given)
    return ElementTree.SubElement(parent, tag, given)


def written(root: ElementTree.Element, level: int) -> bytes:
    """An element as bytes, indented for a nesting level."""
    ElementTree.indent(root, level=level)
    return f"{'  ' * level}{ElementTree.tostring(root, encoding='unicode')}\n".encode()
