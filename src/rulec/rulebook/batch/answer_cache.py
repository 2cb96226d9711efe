"""A cache of answers that take long to compute, valid while all their sources are unchanged."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from datetime import date
from hashlib import sha256
from pathlib import Path
from typing import Any

from rulec.cache.cache_folder import program_stamp
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects, ObjectCodec, kinds_of_fields
from rulec.diagnostics import RulecError
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.files.source_walk import rules_files
from rulec.rulebook.reading.reading_cache import FINDING_KINDS

MOST_ANSWERS = 200
"""How many answers are kept; the longest unused ones are removed first."""


@dataclass(frozen=True, slots=True)
class KeptAnswer:
    """An answer, its sources, and a digest of everything that it depends on."""

    answer: Any
    sources: tuple[str, ...]
    stamp: str


_ANSWERS = KeptObjects(
    KeptBytes("answer", MOST_ANSWERS),
    ObjectCodec({**FINDING_KINDS, **kinds_of_fields((KeptAnswer,))}),
)


@dataclass(frozen=True, slots=True)
class AnswerQuestion:
    """The key of an answer: the ``words`` of the question with its options, and the search path.

    Answers are texts, numbers, findings, and tuples of them.
    """

    words: tuple[str, ...]
    search_path: tuple[Path, ...]

    def recall(self) -> Any:
        """The answer; None if it is not known."""
        kept = _ANSWERS.recall(self._key())
        is_known = isinstance(kept, KeptAnswer) and kept.stamp == self._stamp(kept.sources)
        return kept.answer if is_known else None

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
        paths = tuple(sorted(set(sources)))
        stamp = self._stamp(paths)
        if stamp is not None:
            _ANSWERS.keep({self._key(): KeptAnswer(answer, paths, stamp)})

    def _key(self) -> str:
        return _ANSWERS.files.key(str(Path.cwd()), *map(str, self.search_path), "", *self.words)

    def _stamp(self, sources: Iterable[str]) -> str | None:
        """What has to be as it was: sources, what is beside them, the day, limits and rulec."""
        seen = sha256(program_stamp().encode("utf-8", "surrogatepass"))
        seen.update(date.today().isoformat().encode())  # noqa: DTZ011 - the reader's own day
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
