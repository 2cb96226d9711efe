"""The compiled rulebook as a JSON file, described in docs/compiled.md."""

from __future__ import annotations

import re
import shlex
from codecs import BOM_UTF8
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec

from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.bundle.bundle_check import rulebook_of
from rulec.automata.bundle.bundle_messages import (
    CHANGED_BUNDLE,
    DAMAGED_BUNDLE,
    NO_DIGEST,
    other_day,
)
from rulec.automata.bundle.clocked_entries import clocked_entry
from rulec.automata.bundle.compiled_rulebook import (
    CompiledAxiom,
    CompiledRule,
    CompiledRulebook,
    alike,
)
from rulec.automata.bundle.cut_machines import StoredPrefixes, TimedCut, stored
from rulec.automata.bundle.required_signature import check_signed
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.phrases import json_words
from rulec.files.file_sets import write_together
from rulec.files.read_files import MAX_SAVED_BYTES, opened, read_whole
from rulec.files.written_files import make_folder
from rulec.logic.codec import terms_to_data, to_data
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Rule, Rulebook, RuleParts, Variable


def to_json(rulebook: CompiledRulebook) -> str:
    """The text of a compiled rulebook's file, one row of numbers per line."""
    data = msgspec.to_builtins(entry_of(rulebook))
    del data["sha256"]
    text = msgspec.json.format(msgspec.json.encode(data), indent=1).decode()
    return with_digest(_STRING_OR_ROW.sub(_on_one_line, text) + "\n")


def entry_of(rulebook: CompiledRulebook) -> schema.BundleFile:
    """The content of a compiled rulebook's file.

    Machines for cut traces are included if the rulebook has them stored.
    """
    prefixes = rulebook.prefixes if isinstance(rulebook.prefixes, StoredPrefixes) else None
    vocabulary = rulebook.vocabulary
    return schema.BundleFile(
        **alike(Rulebook, rulebook),
        rulec=rulebook.rulec,
        spot=rulebook.spot,
        sources=[schema.SourceEntry(source.name, source.sha256) for source in rulebook.sources],
        priorities=sorted(rulebook.priorities),
        vocabulary=schema.VocabularyEntry(
            vocabulary.name,
            {item.name: item.parent for item in vocabulary.types.values()},
            [schema.entry_of(item) for item in vocabulary.declarations.values()],
            {
                name: schema.MeaningEntry(
                    own.variables, formula_text(own.formula), to_data(own.formula)
                )
                for name, own in vocabulary.meanings.items()
            },
            {name: str(value) for name, value in vocabulary.parameters.items()},
        ),
        facts=[_axiom(axiom) for axiom in rulebook.axioms],
        rules=[_rule(rule, prefixes) for rule in rulebook.rules],
    )


_STRING_OR_ROW = re.compile(r'"(?:[^"\\]|\\.)*"|\[\s[^\[\]{}"]*\]')
"""A string, or a list without lists, objects or strings that spans several lines."""


def _on_one_line(match_: re.Match[str]) -> str:
    return match_[0] if match_[0].startswith('"') else re.sub(r"\s+", " ", match_[0])


def _axiom(axiom: CompiledAxiom) -> schema.AxiomEntry:
    place = axiom.place
    return schema.AxiomEntry(
        _variables(axiom.variables),
        formula_text(axiom.formula),
        to_data(axiom.formula),
        # Its path on this machine does not concern other users.
        file="" if place is None else Path(place.file).name,
        line=None if place is None else place.line,
    )


def _variables(variables: Iterable[Variable]) -> list[tuple[str, str]]:
    return [(variable.name, variable.type) for variable in variables]


def _rule(rule: CompiledRule, prefixes: StoredPrefixes | None) -> schema.BundleRule:
    machine = rule.machine
    is_timed = rule.step_s is not None
    cut_clocked = prefixes.timed.get(rule.name) if prefixes is not None and is_timed else None
    return schema.BundleRule(
        **alike(Rule, rule),
        hoa=rule.hoa,
        cut=msgspec.UNSET if prefixes is None else _cut(prefixes.entries.get(rule.name)),
        clocked=clocked_entry(rule.timed if is_timed else None),
        cut_clocked=None if cut_clocked is None else _cut_clocked(cut_clocked),
        weight=str(rule.weight),
        variables=_variables(rule.variables),
        step_s=None if rule.step_s is None else str(rule.step_s),
        formula=formula_text(rule.formula),
        tree=to_data(rule.formula),
        parts=None if rule.parts is None else _parts(rule.parts),
        certificate=rule.certificate,
        machine=schema.MachineEntry(
            reads=[_read(read) for read in machine.reads],
            letters=machine.letters,
            successors=machine.successors,
            outputs=machine.outputs,
            rejecting_sink=machine.rejecting_sink,
            accepting_sink=machine.accepting_sink,
        ),
    )


def _cut_clocked(timed: TimedCut) -> schema.CutClockedEntry:
    return schema.CutClockedEntry(clocked_entry(timed.own), clocked_entry(timed.alone))


def _cut(machine: OutcomeMachine | None) -> schema.CutMachineEntry | None:
    if machine is None:
        return None
    # Outcomes are 0, 1 and 2, as the schema requires.
    successors: Any = machine.successors
    outputs: Any = machine.outputs
    starts = tuple(sorted(machine.starts))
    return schema.CutMachineEntry(machine.letters, successors, outputs, starts)


def _parts(parts: RuleParts) -> schema.PartsEntry:
    condition = None if parts.condition is None else to_data(parts.condition)
    exemptions = [(part.scope, to_data(part.formula)) for part in parts.exemptions]
    return schema.PartsEntry(to_data(parts.required), exemptions, condition)


def _read(read: Read | NumberRead) -> schema.ReadEntry | schema.NumberReadEntry:
    match read:
        case Read(name, variables, values, others):
            return schema.ReadEntry(name, variables, values, others)
        case NumberRead(terms, thresholds):
            limits = [schema.ThresholdEntry(str(item.limit), item.inclusive) for item in thresholds]
            return schema.NumberReadEntry(terms_to_data(terms), limits)


def read_to_data(read: Read | NumberRead) -> dict[str, Any]:
    """The JSON object for a read."""
    data: dict[str, Any] = msgspec.to_builtins(_read(read))
    return data


def from_json(data: bytes, file: str) -> CompiledRulebook:
    """Read a compiled rulebook and check everything that running it relies on.

    Raises RulecError R0404 if the file is damaged, not a compiled rulebook, or of a version that
    this rulec cannot read; R0410 if it has been changed, R0411 if it has no digest to check that.
    """
    if has_digest(data):
        check_digest(data, file)
    try:
        header = msgspec.json.decode(data.removeprefix(BOM_UTF8), type=schema.BundleHeader)
    except msgspec.MsgspecError as problem:
        raise _damaged(file, f"this is not a compiled rulebook: {json_words(problem)}") from None
    except (RecursionError, UnicodeDecodeError):
        raise _damaged(file, "this is not a compiled rulebook") from None
    if header.version in schema.WITHOUT_DIGEST:
        raise without_digest(file, header.version, header.steps)
    if header.version != schema.VERSION:
        raise _damaged(
            file,
            f"this compiled rulebook is of version {header.version}; this rulec reads version "
            f"{schema.VERSION}",
        )
    if not has_digest(data):
        message = "this compiled rulebook has been changed: its digest is not in its place"
        raise changed(file, message)
    try:
        return rulebook_of(msgspec.json.decode(data, type=schema.BundleFile))
    except (msgspec.MsgspecError, ValueError, RecursionError) as problem:
        raise _damaged(file, f"this compiled rulebook is damaged: {json_words(problem)}") from None


def refusal(data: bytes, file: str, why: str) -> RulecError:
    """The error for a refused file: that of ``from_json``, else R0404 with the reason ``why``."""
    try:
        from_json(data, file)
    except RulecError as error:
        return error
    return _damaged(file, f"this compiled rulebook is damaged: {why}")


def _damaged(file: str, message: str) -> RulecError:
    return DAMAGED_BUNDLE.error(
        SourceLocation(file),
        message,
        help=f"compile it first: `rulec compile {file} -o DIR` writes a compiled rulebook"
        if file.endswith(".rules")
        else "compile it again from its source with `rulec compile`",
    )


def read_compiled(path: Path, day: str = "") -> CompiledRulebook:
    """Read a compiled rulebook, and refuse one for the law of another ``day``, if one is given.

    Raises R0701, R0404, R0410, R0411, R0419, and as ``check_signed``.
    """
    compiled = from_json(read_signed(path), str(path))
    if day and compiled.at and day != compiled.at:
        raise other_day(str(path), compiled.at, day)
    return compiled


def read_signed(path: Path) -> bytes:
    """The bytes of a file. Raises RulecError: R0701, and as ``check_signed``."""
    with opened(path) as stream:
        data = read_whole(stream, path, MAX_SAVED_BYTES)
    check_signed(path, data)
    return data


def write_compiled(
    rulebook: CompiledRulebook,
    folder: Path,
    texts_of: CompiledRulebook | None = None,
    timed: Callable[[CompiledRulebook], Mapping[str, TimedCut]] = lambda _: {},
) -> list[Path]:
    """Write ``RULE.hoa`` for every rule and ``RULEBOOK.json`` to a folder.

    ``texts_of`` is the same rulebook with other automata as texts, which are written in place of
    its own; ``timed`` as for ``stored``. ``RULEBOOK.json`` contains machines for cut traces if they
    can be compiled. All files are written completely before the first one appears, so that they are
    consistent. Returns the files, the compiled rulebook last. Raises RulecError R0702, and R0403 if
    such machines need Spot and it is not installed.
    """
    rulebook = replace(rulebook, prefixes=stored(rulebook, timed))
    make_folder(folder)
    texts = {
        folder / f"{rule.name}.hoa": _with_sources(rule.hoa, rulebook)
        for rule in (texts_of or rulebook).rules
    }
    texts[folder / f"{rulebook.name}.json"] = to_json(rulebook)
    write_together(folder, {path.name: text.encode() for path, text in texts.items()})
    return list(texts)


def _with_sources(hoa: str, rulebook: CompiledRulebook) -> str:
    """The automaton with its sources as comments below its first line."""
    first, rest = hoa.split("\n", 1)
    sources = [f"/* sha256 {file.sha256} {_spelt(file.name)} */" for file in rulebook.sources]
    return "\n".join([first, *sources, rest])


def _spelt(name: str) -> str:
    """A file name without characters that could end a comment or a line."""
    return "".join(sign if sign.isalnum() or sign in "._-" else "_" for sign in name)


_BEFORE, _AFTER = b'{\n "sha256": "', b'",\n'
_DIGITS = 64


def with_digest(text: str) -> str:
    """The text of a file, an indented JSON object, with a digest added as its first field."""
    rest = text.removeprefix("{\n").encode()
    return b"".join((_BEFORE, _digest(rest), _AFTER, rest)).decode()


def _digest(rest: bytes | memoryview) -> bytes:
    return sha256(rest).hexdigest().encode()


def has_digest(data: bytes) -> bool:
    """Whether a file begins like one with a digest."""
    return data.startswith(_BEFORE)


def check_digest(data: bytes, file: str) -> None:
    """Raise R0410 if a file with a digest has been changed since it was written."""
    end = len(_BEFORE) + _DIGITS
    stated, rest = data[len(_BEFORE) : end], memoryview(data)[end + len(_AFTER) :]
    digest = _digest(rest)
    if stated == digest and data[end : end + len(_AFTER)] == _AFTER:
        return
    raise changed(
        file,
        f"this compiled rulebook has been changed: the SHA-256 of all that follows its second "
        f"line is {digest[:12].decode()}…, but that line has another one",
    )


def changed(file: str, message: str) -> RulecError:
    """R0410, with the command that writes the file again."""
    return CHANGED_BUNDLE.error(SourceLocation(file, 2), message, help=_way_out(file))


def without_digest(file: str, version: int, steps: Iterable[str]) -> RulecError:
    """R0411 for a file of an earlier version, with the command that writes it again."""
    return NO_DIGEST.error(
        SourceLocation(file),
        f"this compiled rulebook is of version {version}, which has no digest, so changes to it "
        "would go unnoticed",
        help=_way_out(file, steps),
    )


def _way_out(file: str, steps: Iterable[str] = ()) -> str:
    path = Path(file)
    # A damaged file does not say reliably which rulebook it was, and its own name may differ.
    words = ["rulec", "compile", "RULEBOOK", *(word for step in steps for word in ("--step", step))]
    command = shlex.join([*words, "-o", str(path.parent)])
    return f"compile it again from its source, a name or a path: `{command}`"
