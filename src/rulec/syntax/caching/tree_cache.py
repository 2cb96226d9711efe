"""Cache of syntax trees, by the text that they were read from.

Anything odd about a file of the cache, and the text is read anew.
"""

from __future__ import annotations

import gc
import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from rulec.cache.kept_bytes import KeptBytes
from rulec.diagnostics import Diagnostic, Source
from rulec.syntax import tree
from rulec.syntax.caching.tree_codec import decoded, encoded
from rulec.syntax.parser import parse

MOST_TREES = 200
"""So many are kept; those longest unused go first."""


def parsed(source: Source) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """What ``parse`` says of a text, from the cache if it is there, and kept there if not."""
    kept = KeptBytes("tree", MOST_TREES)
    if not kept.can_be:
        return parse(source)
    key = kept.key(source.text)
    data = kept.recall(key)
    if data is not None:
        with suppress(ValueError, TypeError, LookupError, RecursionError), _without_collection():
            return decoded(json.loads(data), source), ()
    file, mistakes = parse(source)
    if not mistakes:
        with suppress(ValueError, TypeError, RecursionError):
            kept.keep({key: json.dumps(encoded(file, source), separators=(",", ":")).encode()})
    return file, mistakes


@contextmanager
def _without_collection() -> Iterator[None]:
    """What is made in the block stays, so nothing of it has to be looked for as garbage."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
