"""Rulebooks that ship, read and compiled once in each process, though many tests ask for the same.

Texts that tests write are read each time; so are those that ship where a command keeps a cache of
its own, and compiled while machines are not remembered. Who asks the cache of the run for a
rulebook gets the one that it gave before, with all that engines have made ready for it; a test with
a cache of its own gets what stands there.
"""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rulec import pipeline
from rulec.automata import compiled_cache, compiler
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.worker import compiler_choice
from rulec.cache.keeping import is_keeping, keeping
from rulec.diagnostics import Diagnostic, Source
from rulec.resources import rulebooks_folder
from rulec.rulebook import loader
from rulec.rulebook.files import referenced_files
from rulec.rulebook.reading.reading_cache import BookQuestion
from rulec.syntax import tree

_PARSED, _COMPILED, _RECALLED = loader.parsed, pipeline.compile_source, compiled_cache.recalled

Recalled = tuple[CompiledRulebook, tuple[Diagnostic, ...]]


def remember_books() -> None:
    """Put what remembers in the places of the parser, the compiler and the cache for what ships."""
    shipped, cache = str(rulebooks_folder()), os.environ["RULEC_CACHE_DIR"]
    trees: dict[tuple[str, str], tuple[tree.File, tuple[Diagnostic, ...]]] = {}
    books: dict[tuple[object, ...], tuple[CompiledRulebook, Sequence[Diagnostic]]] = {}
    recalls: dict[BookQuestion, Recalled] = {}
    machines_are_remembered = compiler.answers_to

    def parsed(source: Source, *, keeps: bool = True) -> tuple[tree.File, tuple[Diagnostic, ...]]:
        if is_keeping() or not source.name.startswith(shipped):
            return _PARSED(source, keeps=keeps)
        key = source.name, source.text
        if key not in trees:
            with keeping():
                trees[key] = _PARSED(source)
        return trees[key]

    def compile_source(
        reference: str | Path,
        search_path: Sequence[str | Path] = (),
        *place: Any,
        on_warning: Callable[[Sequence[Diagnostic]], object],
        question: BookQuestion | None = None,
        **options: bool,
    ) -> CompiledRulebook:
        file = loader.find(reference, search_path)
        is_usual = (
            question is None
            and not search_path
            and file.source.name.startswith(shipped)
            and compiler.answers_to is machines_are_remembered
        )
        choice = os.environ.get(compiler_choice.VARIABLE)
        key = file.source, place, tuple(options.items()), choice
        if is_usual and key in books:
            compiled, warnings = books[key]
            on_warning(warnings)
            return compiled
        heard: list[Diagnostic] = []

        def hear(warnings: Sequence[Diagnostic]) -> object:
            heard.extend(warnings)
            return on_warning(warnings)

        asked: Any = {"on_warning": hear, "question": question, **options}
        compiled = _COMPILED(reference, search_path, *place, **asked)
        if is_usual:
            books[key] = compiled, heard
        return compiled

    def recalled(question: BookQuestion) -> Recalled | None:
        is_usual = question.name.startswith(shipped) and os.environ.get("RULEC_CACHE_DIR") == cache
        if not is_usual or question.search_path:
            return _RECALLED(question)
        if question not in recalls:
            found = _RECALLED(question)
            if found is None:
                return None
            recalls[question] = found
        return recalls[question]

    loader.parsed = referenced_files.parsed = parsed
    pipeline.compile_source = compile_source
    compiled_cache.recalled = recalled
