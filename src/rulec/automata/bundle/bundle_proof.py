"""What the independent checker finds of a compiled rulebook's file."""

from __future__ import annotations

from pathlib import Path

from rulec.automata.bundle.bundle_file import read_signed, refusal
from rulec.validation.file_proof import RuleProof, UnreadableError, proofs_of


def proofs_of_file(path: Path) -> list[RuleProof]:
    """What has been found of each rule of a file; see docs/compiled.md.

    Raises RulecError: R0701; as ``from_json`` for a file that is none; as ``check_signed``.
    """
    data = read_signed(path)
    try:
        return proofs_of(data)
    except UnreadableError as problem:
        raise refusal(data, str(path), str(problem)) from None
