"""Reads rulebooks, from the cache where nothing has changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rulec.garbage_collection import no_garbage_collection
from rulec.rulebook.files.search_path import find_rulebook, read_bytes
from rulec.rulebook.reading.reading_cache import BookQuestion
from rulec.rulebook.reading.rulebook_cache import recalled_rulebook, remember_rulebook
from rulec.rulebook.rulebook_model import Loaded, Rulebook, Traffic


def load_rulebook(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> Rulebook:
    """A resolved rulebook: ``read_rulebook`` without its warnings."""
    return read_rulebook(reference, search_path, at).rulebook


@no_garbage_collection()
def read_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    traffic: Traffic = "",
) -> Loaded:
    """Load a rulebook, with its warnings.

    Args:
        reference: a name, looked for as NAME.rules and NAME/NAME.rules in the folders of
            ``search_path`` and then among the rulebooks that ship with rulec; or a path, which
            contains a ``/`` or ends in ``.rules``.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law it is; if empty, that of its law or else today.
        traffic: read it as one for this side, whatever it says itself.

    Raises RulecError: with every mistake in the rulebook, in those that it extends, and in the
    vocabularies that they use.
    """
    question = question_of(reference, search_path, at, traffic)
    known = recalled_rulebook(question)
    if known is not None:
        return known
    from rulec.rulebook import loader  # the parser takes 60 ms, and what is known needs none

    file = loader.file_of(Path(question.name), question.data, question.search_path)
    trees = loader.parse_all(file, keeps=False)
    loaded = loader.resolve_trees(trees, at, traffic)
    if trees.dependencies is not None:
        remember_rulebook(question, loaded, trees.dependencies)
    return loaded


def question_of(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    traffic: Traffic = "",
) -> BookQuestion:
    """The question for a rulebook, by name or path; arguments and errors as ``read_rulebook``."""
    folders = tuple(map(Path, search_path))
    path = find_rulebook(reference, folders)
    return BookQuestion(str(path), read_bytes(path), folders, at, traffic)
