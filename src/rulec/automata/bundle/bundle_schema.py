"""The fields of a compiled rulebook's file, version 7 (see docs/compiled.md)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec

from rulec.rulebook.rulebook_model import (
    Certainty,
    ExemptionScope,
    Semantics,
    Strength,
    Traffic,
)
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal

FORMAT = "rulec compiled rulebook"
VERSION = 7
WITHOUT_DIGEST = range(3, 6)
"""Versions that earlier releases wrote without a digest, so that changes to them go unnoticed."""


class _Strict(msgspec.Struct, forbid_unknown_fields=True):
    """An object of the file that has exactly these fields."""


class SourceEntry(_Strict):
    """A file that went into the rulebook."""

    name: str
    sha256: str


class EnumerationEntry(_Strict, tag="enumeration", tag_field="kind"):
    """A declaration of an enumeration: one of several values."""

    name: str
    parameters: tuple[str, ...]
    values: tuple[str, ...]
    default: str | None
    constant: bool = False
    presumed: bool = False


class SignalEntry(_Strict, tag="signal", tag_field="kind"):
    """A declaration of a signal: a Boolean."""

    name: str
    parameters: tuple[str, ...]
    default: bool | None
    constant: bool = False
    presumed: bool = False


class QuantityEntry(_Strict, tag="quantity", tag_field="kind"):
    """A declaration of a quantity: a number with a unit."""

    name: str
    parameters: tuple[str, ...]
    unit: str
    default: float | None
    constant: bool = False
    presumed: bool = False


ENTRY_OF: dict[type[Declaration], type[EnumerationEntry | SignalEntry | QuantityEntry]] = {
    Enumeration: EnumerationEntry,
    Signal: SignalEntry,
    Quantity: QuantityEntry,
}


def entry_of(declaration: Declaration) -> EnumerationEntry | SignalEntry | QuantityEntry:
    """A declaration as it stands in a file."""
    return msgspec.convert(declaration, ENTRY_OF[type(declaration)], from_attributes=True)


def as_builtins(declaration: Declaration) -> Any:
    """Its entry in values that JSON has."""
    return msgspec.to_builtins(entry_of(declaration))


class MeaningEntry(_Strict):
    """What a signal means for the objects of its variables; ``tree`` is a formula."""

    variables: tuple[str, ...]
    formula: str
    tree: Any


class VocabularyEntry(_Strict, omit_defaults=True):
    """Types, each with its parent, declarations, and the meanings of those that are defined.

    ``parameters`` are the numbers in base units, as fractions, that meanings depend on.
    """

    name: str
    types: dict[str, str | None]
    declarations: list[EnumerationEntry | SignalEntry | QuantityEntry]
    meanings: dict[str, MeaningEntry] = {}
    parameters: dict[str, str] = {}


class ReadEntry(_Strict, tag="state", tag_field="kind"):
    """An enumeration or a signal that a machine reads."""

    name: str
    variables: tuple[str, ...]
    values: tuple[str, ...]
    others: bool


class ThresholdEntry(_Strict):
    """A threshold on the number line; the limit is a fraction."""

    limit: str
    inclusive: bool


class NumberReadEntry(_Strict, tag="number", tag_field="kind"):
    """A number that a machine reads."""

    terms: Any
    thresholds: list[ThresholdEntry]


_WRITTEN_AS = {
    "successors": "following",
    "outputs": "accepting",
    "rejecting_sink": "dead",
    "accepting_sink": "safe",
}
"""The names in the file format of fields of a Mealy monitor."""


class MachineEntry(_Strict, rename=_WRITTEN_AS):
    """The Mealy monitor of a rule."""

    reads: list[ReadEntry | NumberReadEntry]
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[bool, ...], ...]
    rejecting_sink: int | None
    accepting_sink: int | None


class CutMachineEntry(_Strict, rename={"successors": "following", "outputs": "outcomes"}):
    """The machine of a rule for cut traces; its reads are those of the rule's Mealy monitor.

    ``outcomes`` are 0 (kept), 1 (pending) and 2 (violated); a run begins in any of the ``starts``.
    """

    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[Literal[0, 1, 2], ...], ...]
    starts: tuple[int, ...]


class ClockEntry(_Strict, omit_defaults=True, rename={"low": "from", "high": "to"}):
    """A clock: its bound, and for each letter of the table what its operands are there.

    That is 1 if the left one holds, plus 2 if the right one does.
    """

    low: str
    high: str | None
    unit: Literal["s", "steps"]
    operands: tuple[Literal[0, 1, 2, 3], ...]
    early: bool = False
    least: Literal[0, 1] = 0


class ClockedEntry(_Strict, rename=_WRITTEN_AS):
    """A machine for any step: a Mealy monitor that also reads clocks.

    ``groups`` has the group of each letter; a letter of the table is a group and the clocks'
    values, as bits: ``group + n_groups * values``.
    """

    groups: tuple[int, ...]
    clocks: list[ClockEntry]
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[bool, ...], ...]
    rejecting_sink: int | None
    accepting_sink: int | None


class CutClockedEntry(_Strict, omit_defaults=True):
    """The machines of which that for cut traces is made at any step (``cut_machines.TimedCut``)."""

    continuing: ClockedEntry | None = None
    alone: ClockedEntry | None = None


class PartsEntry(_Strict, omit_defaults=True):
    """What a rule requires, its exceptions with their scopes, and its condition, as trees."""

    required: Any
    exemptions: list[tuple[ExemptionScope, Any]] = []
    condition: Any = None


class BundleRule(_Strict, omit_defaults=True):
    """One rule; ``cut`` is null if that machine would be too large, and missing if none was made.

    Without ``parts`` the rule consists of its formula alone. ``certificate`` is the digest of the
    table if two compilers agree on it. A rule with bounds in seconds has ``clocked`` machines for
    any step, where clocks tell all of its bounds.
    """

    name: str
    strength: Strength
    level: str
    weight: str
    variables: list[tuple[str, str]]
    cite: str
    says: str
    source: str
    certainty: Certainty
    book: str
    step_s: str | None
    formula: str
    tree: Any
    machine: MachineEntry
    hoa: str
    cut: CutMachineEntry | msgspec.UnsetType | None = msgspec.UNSET
    clocked: ClockedEntry | None = None
    cut_clocked: CutClockedEntry | None = None
    parts: PartsEntry | None = None
    inherited_from: str = ""
    certificate: Annotated[str, msgspec.Meta(pattern="^([0-9a-f]{64})?$")] = ""


class AxiomEntry(_Strict):
    """An axiom, and where it is written: file name and line (from 1)."""

    variables: list[tuple[str, str]]
    formula: str
    tree: Any
    file: str
    line: Annotated[int, msgspec.Meta(ge=1)] | None


class BundleHeader(msgspec.Struct):
    """The fields that identify a compiled rulebook's format and version."""

    format: Literal["rulec compiled rulebook"]
    version: int
    steps: list[str] = []


class BundleFile(_Strict, kw_only=True):
    """The whole file.

    Its first line is ``{``; its second is ``sha256``, the digest of all bytes from the third line
    on, in hexadecimal (``bundle_digest``).
    """

    sha256: str = ""
    format: str = FORMAT
    version: int = VERSION
    rulec: str
    spot: str
    name: str
    title: str
    law: str
    as_of: str
    sources: list[SourceEntry]
    semantics: Semantics
    traffic: Traffic = ""
    levels: tuple[str, ...]
    priorities: list[tuple[str, str]]
    extends: tuple[str, ...]
    at: str
    vocabulary: VocabularyEntry
    facts: list[AxiomEntry]
    rules: list[BundleRule]
