"""A cache of syntax trees by their text; those of shipped texts are shipped, too.

If anything is wrong with a cache file, the text is parsed again.
"""

from __future__ import annotations

import json
from contextlib import suppress

from rulec.cache.keeping import knows_shipped
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.shipped_bytes import shipped, shipped_key
from rulec.diagnostics import Diagnostic, Source
from rulec.garbage_collection import no_garbage_collection
from rulec.syntax import tree
from rulec.syntax.caching.tree_codec import decoded, encoded
from rulec.syntax.parser import parse

MOST_TREES = 200
"""How many trees are kept; the longest unused ones are removed first."""

SHIPPED = "tree"
MAKERS = (
    *("grammar", "syntax/building", "syntax/caching", "syntax/formatting"),
    *(f"syntax/{name}.py" for name in ("assembly", "file_pieces", "grammar", "item_boundaries")),
    *(f"syntax/{name}.py" for name in ("keywords", "parse_nodes", "parser", "parser_tables")),
    *(f"syntax/{name}.py" for name in ("scanner", "split_file", "split_rule", "tree")),
)
"""The kind of the shipped cache, and the code on which it depends; all its texts are formatted."""


def parsed(source: Source) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """The result of ``parse`` for a text, from the cache if possible; otherwise it is added."""
    if not knows_shipped():
        return parse(source)
    known = _recalled(shipped(SHIPPED, MAKERS).recall(shipped_key(source.text)), source)
    if known is not None:
        return known, ()
    kept = KeptBytes("tree", MOST_TREES)
    if not kept.can_be:
        return parse(source)
    key = kept.key(source.text)
    known = _recalled(kept.recall(key), source)
    if known is not None:
        return known, ()
    file, mistakes = parse(source)
    if not mistakes:
        with suppress(ValueError, TypeError, RecursionError):
            kept.keep({key: as_bytes(file, source)})
    return file, mistakes


def ships_in_form(text: str) -> bool:
    """Whether a text is a shipped one, and therefore formatted."""
    return knows_shipped() and shipped_key(text) in shipped(SHIPPED, MAKERS).keys


def as_bytes(file: tree.File, source: Source) -> bytes:
    """A tree as it is stored. Raises TypeError, ValueError or RecursionError if it cannot be."""
    return json.dumps(encoded(file, source), separators=(",", ":")).encode()


def _recalled(data: bytes | None, source: Source) -> tree.File | None:
    if data is not None:
        with suppress(ValueError, TypeError, LookupError, RecursionError), no_garbage_collection():
            return decoded(json.loads(data), source)
    return None
