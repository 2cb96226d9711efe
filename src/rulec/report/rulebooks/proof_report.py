"""Proofs of compiled rulebooks as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec

from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text.terminal_text import visible
from rulec.validation.file_proof import RuleProof


class ProofLine(msgspec.Struct, frozen=True):
    """A rule of a file: ``because`` says why it is not proved, null if it is.

    ``step_s`` is the step of its tables, as the file spells it, null for any. ``states`` are a
    shortest trace on which tables and formula differ, if that is the reason. ``compilers_agree``:
    two compilers have produced its table, according to the file.
    """

    rule: str
    step_s: str | None
    proved: bool
    because: str | None
    states: Sequence[Mapping[str, str]]
    compilers_agree: bool


class FileProofs(msgspec.Struct, frozen=True):
    """The rules of a file."""

    file: str
    rules: Sequence[ProofLine]


class ProofsDocument(JsonDocument, frozen=True, kw_only=True):
    """The result for each rule of each file."""

    files: Sequence[FileProofs]


def render(proofs: Sequence[tuple[str, Sequence[RuleProof]]], output_format: str) -> str:
    """The results for each file, as ``text`` or ``json``."""
    if output_format == "json":
        files = [FileProofs(name, [_line(proof) for proof in own]) for name, own in proofs]
        return as_indented(ProofsDocument(files=files))
    return "\n".join(_text(proofs))


def _line(proof: RuleProof) -> ProofLine:
    because = proof.because or None
    return ProofLine(
        proof.rule, proof.step_s, because is None, because, proof.word, compilers_agree=proof.agreed
    )


def _text(proofs: Sequence[tuple[str, Sequence[RuleProof]]]) -> Iterator[str]:
    for name, own in proofs:
        for proof in own:
            at = "" if proof.step_s is None else f" at steps of {proof.step_s} s"
            result = f"not proved, because {proof.because}" if proof.because else "proved"
            result += ", two compilers agree" if proof.agreed else ""
            yield visible(f"{name}: rule {proof.rule}{at}: {result}")
            for number, state in enumerate(proof.word):
                read = ", ".join(f"{subject}: {value}" for subject, value in state.items())
                yield visible(f"  state {number}: {read}")
    rules = [proof for _, own in proofs for proof in own]
    proved = sum(not proof.because for proof in rules)
    count = "1 rule" if len(rules) == 1 else f"{len(rules)} rules"
    yield f"{count}: {proved} proved, {len(rules) - proved} not proved"
