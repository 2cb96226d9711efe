"""A compiled rulebook as a text with its tables as rows of integers beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import msgspec

from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.bundle.bundle_check import rulebook_of
from rulec.automata.bundle.bundle_file import entry_of
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.bundle.mapped_tables import MappedTables, RowPlace, TableWriter
from rulec.automata.bundle.stored_prefixes import StoredPrefixes
from rulec.diagnostics import SourceLocation


class TablePlaces(msgspec.Struct):
    """Where the rows of a machine are: one a state, of ``width`` letter classes."""

    letters: RowPlace
    width: int
    successors: RowPlace
    outputs: RowPlace


class MappedRulebook(msgspec.Struct):
    """The text of a compiled rulebook whose tables are beside it.

    ``rulebook`` is as in its file, but for empty tables; ``machines`` and ``cut`` have theirs, a
    rule each, ``orders`` those of the latter's states, by rule. ``places`` say where the axioms are
    written.
    """

    rulebook: schema.BundleFile
    machines: list[TablePlaces]
    cut: list[TablePlaces | None]
    orders: dict[str, RowPlace]
    places: list[SourceLocation | None]


def placed(rulebook: CompiledRulebook, tables: TableWriter) -> MappedRulebook:
    """The text of a rulebook whose tables have been written."""
    entry = entry_of(rulebook)
    machines: list[TablePlaces] = []
    cut: list[TablePlaces | None] = []
    for rule in entry.rules:
        machines.append(_placed(rule.machine, tables))
        rule.machine.letters = rule.machine.successors = rule.machine.outputs = ()
        cut.append(None)
        if rule.cut:
            cut[-1] = _placed(rule.cut, tables)
            rule.cut.letters = rule.cut.successors = rule.cut.outputs = ()
    prefixes = rulebook.prefixes
    known = prefixes.orders if isinstance(prefixes, StoredPrefixes) else {}
    orders = {name: tables.place(order) for name, order in known.items()}
    return MappedRulebook(entry, machines, cut, orders, [axiom.place for axiom in rulebook.axioms])


def _placed(
    machine: schema.MachineEntry | schema.CutMachineEntry, tables: TableWriter
) -> TablePlaces:
    return TablePlaces(
        tables.place(machine.letters),
        len(machine.successors[0]),
        tables.place_rows(machine.successors),
        tables.place_rows(machine.outputs),
    )


def rulebook_from(text: MappedRulebook, tables: MappedTables) -> CompiledRulebook:
    """The compiled rulebook. Raises ValueError if its tables do not fit."""
    rows: Sequence[tuple[schema.BundleRule, TablePlaces, TablePlaces | None]]
    rows = list(zip(text.rulebook.rules, text.machines, text.cut, strict=True))
    for rule, places, cut in rows:
        machine = rule.machine
        machine.letters = tables.row(places.letters)
        machine.successors = tables.rows(places.successors, places.width)
        machine.outputs = tables.truths(places.outputs, places.width)
        if rule.cut and cut is not None:
            rule.cut.letters = tables.row(cut.letters)
            rule.cut.successors = tables.rows(cut.successors, cut.width)
            # Only 0, 1 and 2 have been written.
            rule.cut.outputs = tables.rows(cut.outputs, cut.width)  # type: ignore[assignment]
    compiled = rulebook_of(text.rulebook, own=True)
    axioms = [
        replace(axiom, place=place)
        for axiom, place in zip(compiled.axioms, text.places, strict=True)
    ]
    prefixes = compiled.prefixes
    if isinstance(prefixes, StoredPrefixes):
        orders = {name: bytes(tables.row(place)) for name, place in text.orders.items()}
        prefixes = replace(prefixes, orders=orders)
    return replace(compiled, axioms=tuple(axioms), prefixes=prefixes)
