"""A cache of a check's findings, valid while its files are unchanged.

Checking a rulebook means parsing it and everything that it builds upon; finding out whether any of
that has changed means only reading the files. The findings are kept in one small file per rulebook,
in the user's cache folder. The check is done again if anything is wrong with that file: if it was
changed, or if another user has written it or could have.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from rulec.cache.cache_folder import program_digest, usable_folder
from rulec.cache.kept_json import keep_json, recall_json
from rulec.diagnostics import Diagnostic, Fix, Label, Offer, RulecError, SourceLocation
from rulec.rulebook.files.search_path import Dependency, locate_base, locate_vocabulary, read_bytes
from rulec.version import __version__

MOST_FILES = 1000
"""For how many rulebooks the findings are kept; the longest unused ones are removed first."""

MOST_CHARACTERS = 1_000_000
"""Findings that would take more are not kept: each of them includes the line that it is about."""

_WORDS = 200
"""The approximate number of characters of a finding itself."""


@dataclass(frozen=True, slots=True)
class CheckQuestion:
    """The key of a check: its inputs except for other files.

    ``path`` is empty for standard input; ``day`` is the default day whose law is applied.
    """

    name: str
    path: str
    data: bytes
    search_path: tuple[str, ...]
    at: str
    day: str

    def place(self) -> str:
        """The name of the cache file, independent of the files' contents."""
        parts = (self.name, self.path, str(Path.cwd()), self.at, *self.search_path)
        return sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:40]

    def stamp(self) -> list[str]:
        """The content that must be unchanged."""
        return [sha256(self.data).hexdigest(), self.day, __version__, program_digest()]


def recall(question: CheckQuestion) -> tuple[Diagnostic, ...] | None:
    """The cached findings of an equal check; None if unknown."""
    folder = usable_folder()
    if folder is None:
        return None
    data = recall_json(folder / f"{question.place()}.json")
    with suppress(OSError, ValueError, TypeError, LookupError):
        if data["stamp"] != question.stamp():
            return None
        dependencies = [Dependency(**dependency) for dependency in data["dependencies"]]
        folders = [Path(folder) for folder in question.search_path]
        if all(is_as_it_was(dependency, folders) for dependency in dependencies):
            return tuple(map(diagnostic_of, data["findings"]))
    return None


def remember(
    question: CheckQuestion, findings: Sequence[Diagnostic], dependencies: Sequence[Dependency]
) -> None:
    """Cache the findings of a check, if that is possible."""
    folder = usable_folder()
    if folder is None or _size(findings) > MOST_CHARACTERS:
        return
    data = {
        "stamp": question.stamp(),
        "dependencies": [asdict(dependency) for dependency in dependencies],
        "findings": [asdict(finding) for finding in findings],
    }
    keep_json(folder / f"{question.place()}.json", data, MOST_FILES)


def _size(findings: Sequence[Diagnostic]) -> int:
    places = [finding.place for finding in findings if finding.place is not None]
    places += [label.place for finding in findings for label in finding.labels]
    offers = [offer for finding in findings for offer in finding.offers]
    places += [fix.place for offer in offers for fix in offer.fixes]
    return sum(_WORDS + len(place.excerpt) for place in places)


def is_as_it_was(dependency: Dependency, search_path: Sequence[Path]) -> bool:
    """Whether the same name still leads to the same content."""
    user = Path(dependency.user) if dependency.user else None
    locate = locate_base if dependency.kind == "base" else locate_vocabulary
    path = locate(dependency.name, user, search_path)
    if path is None or str(path) != dependency.path:
        return False
    try:
        return sha256(read_bytes(path)).hexdigest() == dependency.sha256
    except RulecError:
        return False


def diagnostic_of(data: dict[str, Any]) -> Diagnostic:
    """The diagnostic from which ``asdict`` made the data. Raises TypeError or LookupError."""
    place = None if data["place"] is None else SourceLocation(**data["place"])
    labels = [Label(SourceLocation(**label["place"]), label["message"]) for label in data["labels"]]
    fix = None if data["fix"] is None else _fix_of(data["fix"])
    offers = [Offer(one["title"], tuple(map(_fix_of, one["fixes"]))) for one in data["offers"]]
    parts = {"place": place, "labels": tuple(labels), "notes": tuple(data["notes"]), "fix": fix}
    parts["offers"] = tuple(offers)
    return Diagnostic(**{**data, **parts})


def _fix_of(data: dict[str, Any]) -> Fix:
    return Fix(SourceLocation(**data["place"]), data["text"])
