"""The cache of what reading a rulebook gave, valid while its files are unchanged.

Reading a rulebook means parsing and resolving it with everything that it builds upon; finding out
whether any of that has changed means only reading the files. Findings are kept by the place of a
source, so that a later reading replaces an earlier one.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from hashlib import sha256
from pathlib import Path

from rulec.cache.cache_folder import program_stamp
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects, ObjectCodec, kinds_of_fields
from rulec.diagnostics import Diagnostic, Fix, Label, Offer, RulecError, SourceLocation
from rulec.rulebook.files.search_path import Dependency, locate_base, locate_vocabulary, read_bytes

MOST_READINGS = 1000
"""Of how many sources the findings are kept; the longest unused ones are removed first."""


@dataclass(frozen=True, slots=True)
class BookQuestion:
    """What reading a source depends on, apart from other files.

    ``name`` is its path, or what messages call a text that has none; ``at`` and ``traffic`` as for
    ``read_rulebook``.
    """

    name: str
    data: bytes
    search_path: tuple[Path, ...] = ()
    at: str = ""
    traffic: str = ""
    has_path: bool = True

    def place(self) -> tuple[str, ...]:
        """The question without the content of the source."""
        # Messages show paths as they were given; relative ones lead elsewhere from elsewhere.
        parts = self.name, *map(str, self.search_path)
        here = "" if all(map(os.path.isabs, parts)) else str(Path.cwd())
        return here, "a file" if self.has_path else "a text", self.at, self.traffic, *parts


@dataclass(frozen=True, slots=True)
class Basis:
    """What a result was made from.

    ``stamp`` is a digest of the source and of rulec, ``dependencies`` are the other files; ``day``
    is the day whose law applies if that is today by default, and empty if somebody sets it.
    """

    stamp: str
    day: str
    dependencies: tuple[Dependency, ...]

    def texts(self, question: BookQuestion) -> dict[str, bytes] | None:
        """The source and its dependencies, by name; None if anything has changed."""
        if self.stamp != _stamp(question) or self.day not in ("", _today()):
            return None
        texts = {question.name: question.data}
        for dependency in self.dependencies:
            data = _unchanged(dependency, question.search_path)
            if data is None:
                return None
            texts[dependency.path] = data
        return texts


def basis_of(question: BookQuestion, dependencies: Sequence[Dependency], as_of: str) -> Basis:
    """What the result of reading a source now is made from; ``as_of`` is the day of its law."""
    day = "" if question.at or as_of else _today()
    return Basis(_stamp(question), day, tuple(dependencies))


def _stamp(question: BookQuestion) -> str:
    return sha256(program_stamp().encode("utf-8", "surrogatepass") + question.data).hexdigest()


def _today() -> str:
    return date.today().isoformat()  # noqa: DTZ011 - today in the user's time zone


def _unchanged(dependency: Dependency, search_path: Sequence[Path]) -> bytes | None:
    """The content of a file, if the same name still leads to the same content."""
    user = Path(dependency.user) if dependency.user else None
    locate = locate_base if dependency.kind == "base" else locate_vocabulary
    path = locate(dependency.name, user, search_path)
    if path is None or str(path) != dependency.path:
        return None
    try:
        data = read_bytes(path)
    except RulecError:
        return None
    return data if sha256(data).hexdigest() == dependency.sha256 else None


@dataclass(frozen=True, slots=True)
class Reading:
    """The findings about a source, and what they were made from."""

    basis: Basis
    findings: tuple[Diagnostic, ...]


FINDING_KINDS = kinds_of_fields((SourceLocation, Label, Fix, Offer, Diagnostic))
READING_KINDS = {**FINDING_KINDS, **kinds_of_fields((Basis, Dependency))}

_READINGS = KeptObjects(
    KeptBytes("reading", MOST_READINGS),
    ObjectCodec({**READING_KINDS, **kinds_of_fields((Reading,))}),
)


def recalled(question: BookQuestion) -> tuple[Reading | None, dict[str, bytes]]:
    """The cached reading of a source and the texts of its files; None and no text if unknown."""
    if not _READINGS.files.can_be:
        return None, {}
    reading = _READINGS.recall(_READINGS.files.key(*question.place()))
    texts = reading.basis.texts(question) if isinstance(reading, Reading) else None
    return (None, {}) if texts is None else (reading, texts)


def remember_findings(
    question: BookQuestion,
    findings: Sequence[Diagnostic],
    dependencies: Sequence[Dependency],
    as_of: str = "",
) -> Reading:
    """Cache the findings about a source, if possible; ``as_of`` is the day of its law."""
    reading = Reading(basis_of(question, dependencies, as_of), tuple(findings))
    _READINGS.keep({_READINGS.files.key(*question.place()): reading})
    return reading
