"""A cache of syntax trees by their text.

If anything is wrong with a cache file, the text is parsed again.
"""

from __future__ import annotations

import json
from contextlib import suppress

from rulec.cache.kept_bytes import KeptBytes
from rulec.diagnostics import Diagnostic, Source
from rulec.garbage_collection import no_garbage_collection
from rulec.syntax import tree
from rulec.syntax.caching.tree_codec import decoded, encoded
from rulec.syntax.parser import parse

MOST_TREES = 200
"""How many trees are kept; the longest unused ones are removed first."""


def parsed(source: Source) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """The result of ``parse`` for a text, from the cache if possible; otherwise it is added."""
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
            text = json.dumps(encoded(file, source), separators=(",", ":"))
            kept.keep({key: text.encode()})
    return file, mistakes


def _recalled(data: bytes | None, source: Source) -> tree.File | None:
    if data is not None:
        with suppress(ValueError, TypeError, LookupError, RecursionError), no_garbage_collection():
            return decoded(json.loads(data), source)
    return None
