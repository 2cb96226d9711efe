"""A cache of answers that take long to compute, valid while all their sources are unchanged.

An answer is JSON, in one file per question, in the folder of the cache of checks. If anything is
wrong with a file, the answer is computed again.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import date
from hashlib import sha256
from pathlib import Path
from typing import Any

from rulec.cache.cache_folder import program_digest, usable_folder
from rulec.cache.kept_json import keep_json, recall_json
from rulec.diagnostics import RulecError
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.files.source_walk import rules_files
from rulec.version import __version__

MOST_ANSWERS = 200
"""How many answers are kept; the longest unused ones are removed first."""

_ENDING = ".answer"


@dataclass(frozen=True, slots=True)
class AnswerQuestion:
    """The key of an answer: the ``words`` of the question with its options, and the search path."""

    words: tuple[str, ...]
    search_path: tuple[Path, ...]

    def recall(self) -> Any:
        """The answer; None if it is not known."""
        path = self._path()
        kept: Any = None if path is None else recall_json(path)
        with suppress(OSError, ValueError, TypeError, LookupError, AttributeError):
            if kept["stamp"] == self._stamp(kept["sources"]):
                return kept["answer"]
        return None

    def answer(self, made: Callable[[], tuple[Any, Iterable[str]]]) -> Any:
        """The answer, recalled or ``made``, and kept if it comes from any sources."""
        answer = self.recall()
        if answer is None:
            answer, sources = made()
            if sources:
                self.remember(answer, sources)
        return answer

    def remember(self, answer: Any, sources: Iterable[str]) -> None:
        """Keep an answer that comes from these sources, if that is possible."""
        path = self._path()
        paths = sorted(set(sources))
        stamp = self._stamp(paths)
        if path is not None and stamp is not None:
            kept = {"sources": paths, "stamp": stamp, "answer": answer}
            keep_json(path, kept, MOST_ANSWERS)

    def _path(self) -> Path | None:
        folder = usable_folder()
        if folder is None:
            return None
        parts = (str(Path.cwd()), *map(str, self.search_path), "", *self.words)
        name = sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:40]
        return folder / f"{name}{_ENDING}"

    def _stamp(self, sources: Iterable[str]) -> str | None:
        """What has to be as it was: sources, what is beside them, the day, limits and rulec."""
        seen = sha256(f"{__version__}\0{program_digest()}\0".encode())
        seen.update(date.today().isoformat().encode())  # noqa: DTZ011 - the reader's own day
        for variable in ("RULEC_COMPILER", "RULEC_LIMITS"):
            seen.update(f"\0{os.environ.get(variable, '')}".encode("utf-8", "surrogatepass"))
        folders = dict.fromkeys(self.search_path)
        try:
            for source in map(Path, sources):
                seen.update(sha256(read_bytes(source)).digest())
                folders[source.parent] = None
        except RulecError:
            return None
        # A new file may take the place of one that is found last.
        for folder in folders:
            names = sorted(map(str, rules_files(folder)))
            seen.update("\0".join(names).encode("utf-8", "surrogatepass"))
        return seen.hexdigest()
