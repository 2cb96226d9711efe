"""The vocabularies that rulebooks use, read from their files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError
from rulec.rulebook.files.extends import source_file
from rulec.rulebook.files.reference_messages import not_the_vocabulary
from rulec.rulebook.files.search_path import Dependency, find_vocabulary, is_same_file, read_bytes
from rulec.rulebook.rulebook_model import SourceFile
from rulec.syntax import decode, parse, tree


@dataclass(slots=True)
class Vocabularies:
    """Reads the vocabularies that rulebooks use, each once; collects records and mistakes.

    ``failed``: one of them could not be read.
    """

    search_path: tuple[Path, ...]
    sources: list[SourceFile] = field(default_factory=list)
    mistakes: list[Diagnostic] = field(default_factory=list)
    failed: bool = False
    dependencies: list[Dependency] = field(default_factory=list)
    read_already: list[Path] = field(default_factory=list)

    def read(self, use: tree.UseLine, user: Path | None) -> tree.File | None:
        """Syntax tree of a vocabulary; None if unreadable or already read."""
        name = use.name
        try:
            path = find_vocabulary(name.text, name.span, user, self.search_path)
            data = read_bytes(path, name.span)
            record = source_file(path.name, data)
            self.dependencies.append(
                Dependency("vocabulary", name.text, str(user or ""), str(path), record.sha256)
            )
            if any(is_same_file(path, one) for one in self.read_already):
                return None
            source = decode(str(path), data)
        except RulecError as error:
            self.mistakes += error.diagnostics
            self.failed = True
            return None
        self.read_already.append(path)
        file, mistakes = parse(source)
        if file.name is not None and (file.kind, file.name.text) != ("vocabulary", name.text):
            self.mistakes.append(not_the_vocabulary(use, file, path))
            self.failed = True
            return None
        self.sources.append(record)
        self.mistakes += mistakes
        return file
