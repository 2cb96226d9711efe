"""Proofs of a compiled rulebook's file by the independent checker."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path

from rulec.automata.bundle.bundle_file import from_json, read_signed, refusal
from rulec.automata.bundle.bundle_schema import FORMAT
from rulec.diagnostics import RulecError, SourceLocation
from rulec.files.file_messages import NOTHING_LEFT
from rulec.files.read_files import opened
from rulec.files.work_trees import is_ordinary, leads_out, tree_of
from rulec.validation.file_proof import RuleProof, UnreadableError, proofs_of

_HEAD_BYTES = 1024
_SEAL = re.compile(rb'\{\s*"sha256"')
"""Their first line."""

_ENDINGS = ".json", ".json.gz"


@dataclass(frozen=True, slots=True)
class CompiledFiles:
    """The files that are to be proved, each once, and other JSON files found beside them."""

    paths: tuple[str, ...]
    others: tuple[str, ...] = ()


def compiled_files(references: Sequence[str]) -> CompiledFiles:
    """The compiled rulebooks given by paths, folders and patterns.

    A folder stands for the files in and below it, by name; hidden folders and links are skipped,
    and so are JSON files that are something else. One that cannot be read, or is no whole JSON, may
    be what is left of a compiled rulebook, and is included. If no file has the given name, ``*``,
    ``?`` and ``[…]`` are wildcards, and ``**`` is any number of folders. Raises RulecError R0733
    for a folder or pattern that yields no file.
    """
    paths: dict[str, None] = {}
    others: dict[str, None] = {}
    for reference in references:
        is_pattern = has_magic(reference) and not os.path.lexists(reference)
        places = sorted(glob(reference, recursive=True)) if is_pattern else [reference]  # noqa: PTH207
        for place in places:
            if os.path.isdir(place):  # noqa: PTH112 - Path raises on a null character
                below = list(map(str, _below(place)))
                files = [path for path in below if _may_be_compiled(Path(path))]
                if not files and not is_pattern:
                    raise _nothing(reference, "there is no compiled rulebook in this folder")
                paths |= dict.fromkeys(files)
                others |= dict.fromkeys(path for path in below if path not in files)
            elif not is_pattern or _may_be_compiled(Path(place)):
                paths[place] = None
            else:
                others[place] = None
        if is_pattern and not places:
            raise _nothing(reference, "no file matches this pattern")
    return CompiledFiles(tuple(paths), tuple(others))


def _nothing(reference: str, why: str) -> RulecError:
    way_out = "`rulec compile R -o DIR` writes them, as DIR/R.json"
    return NOTHING_LEFT.error(SourceLocation(reference), why, help=way_out)


def _below(folder: str) -> Iterator[Path]:
    """The JSON files in and below a folder, also compressed ones."""
    tree = tree_of(Path(folder))
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(here, name) for name in sorted(names) if name.endswith(_ENDINGS)):
            if is_ordinary(path) and not leads_out(path, tree):
                yield path


def _may_be_compiled(path: Path) -> bool:
    """Whether a file is a compiled rulebook, or might have been one before it was damaged."""
    try:
        with opened(path) as stream:
            head = stream.read(_HEAD_BYTES)
            if f'"{FORMAT}"'.encode() in head or _SEAL.match(head):
                return True
            json.loads(head + stream.read())
    except (RulecError, ValueError, RecursionError):
        return True
    return False


def proofs_of_file(path: Path) -> list[RuleProof]:
    """The proof result for each rule of a file; see docs/compiled.md.

    Raises RulecError: R0701; as ``from_json`` for an invalid file; as ``check_signed``.
    """
    data = read_signed(path)
    try:
        proofs = proofs_of(data)
    except UnreadableError as problem:
        raise refusal(data, str(path), str(problem)) from None
    if not any(proof.because for proof in proofs):
        # What is no part of a proof, such as levels and weights, must be sound, too
        from_json(data, str(path))
    return proofs
