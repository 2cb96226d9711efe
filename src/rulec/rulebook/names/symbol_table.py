"""The declarations of one or more files as one vocabulary."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from rulec.diagnostics import Diagnostic, Label, Offer, Source, Span
from rulec.diagnostics.ways_out import left_out, offering
from rulec.resource_limits import TYPE_DEPTH
from rulec.rulebook.names import declaration_messages as say
from rulec.rulebook.names.declaration_messages import TYPE_CIRCLE
from rulec.syntax import tree
from rulec.syntax.messages.lookalikes import looks_like, skeleton_of
from rulec.vocabulary import Declaration, Enumeration, ObjectType, Quantity, Signal, Vocabulary
from rulec.vocabulary.dimensions import Unit
from rulec.vocabulary.units import parse_unit


@dataclass(slots=True)
class SymbolTable:
    """The declarations of the files, with their places; filled by ``symbol_table``.

    ``suspects`` are names that an unreadable item may have declared. ``opaque``: any name may be
    missing because of a reported mistake; ``opaque_types``: any type may be. ``uncertain`` are
    types with unknown parents, and enumerations with unknown defaults, for such a reason.
    """

    types: dict[str, ObjectType] = field(default_factory=dict)
    items: dict[str, Declaration] = field(default_factory=dict)
    value_of: dict[str, Enumeration] = field(default_factory=dict)
    type_spans: dict[str, Span] = field(default_factory=dict)
    spans: dict[str, Span] = field(default_factory=dict)
    parameter_spans: dict[tuple[str, int], Span] = field(default_factory=dict)
    units: dict[str, Unit | None] = field(default_factory=dict)
    suspects: set[str] = field(default_factory=set)
    uncertain: set[str] = field(default_factory=set)
    of_vocabularies: set[Source] = field(default_factory=set)
    opaque: bool = False
    opaque_types: bool = False
    mistakes: list[Diagnostic] = field(default_factory=list)
    shared: dict[tuple[Source, Source], list[str]] = field(default_factory=dict)
    """Names declared by two vocabularies: the earlier one, the later one, and the names."""
    searched: set[str] = field(default_factory=set)
    """Unknown names for which known ones were looked for that may be meant."""

    def twice(self, kind: str, again: tree.Name, first: Span) -> None:
        """Note that something is declared twice."""
        files = first.source, again.span.source
        if files[0] != files[1] and set(files) <= self.of_vocabularies:
            self.shared.setdefault(files, []).append(again.text)
            self.uncertain.add(again.text)
        else:
            self.mistakes.append(say.twice(kind, again, first))

    def vocabulary(self, name: str) -> Vocabulary:
        """The declarations as data; valid only if there were no mistakes."""
        return Vocabulary(name, MappingProxyType(self.types), MappingProxyType(self.items))

    def unit(self, text: str) -> Unit | None:
        """The unit of a text, parsed once; None if it is invalid."""
        if text not in self.units:
            self.units[text] = parse_unit(text)
        return self.units[text]

    def unit_of(self, quantity: str) -> Unit | None:
        """The unit of a quantity; None if unknown, which has been reported."""
        item = self.items[quantity]
        return self.unit(item.unit) if isinstance(item, Quantity) else None

    def unit_text(self, name: str) -> str:
        """The unit of a quantity as written; empty for any other name."""
        item = self.items.get(name)
        return item.unit if isinstance(item, Quantity) else ""

    def unit_meant(self, name: str) -> str:
        """The unit of a quantity, also in its short form ``gap_v``; empty for any other name."""
        heads = (name[:at] for at, letter in enumerate(name) if letter == "_")
        return next(filter(None, map(self.unit_text, (name, *heads))), "")

    def atoms(self) -> list[str]:
        """The names of signals and of values."""
        signals = [name for name, item in self.items.items() if isinstance(item, Signal)]
        return [*signals, *self.value_of]

    def about_one(self) -> list[str]:
        """The atoms about one object."""
        items = ((name, self.behind_atom(name)) for name in self.atoms())
        return [name for name, item in items if item is not None and len(item.parameters) == 1]

    def behind_atom(self, name: str) -> Signal | Enumeration | None:
        """The signal of a name, or the enumeration with such a value."""
        signal = self.items.get(name)
        return signal if isinstance(signal, Signal) else self.value_of.get(name)

    def may_know(self, name: str) -> bool:
        """Whether unreadable text may declare a name, or ``b`` of a name ``b_v``."""
        heads = (name[:at] for at, letter in enumerate(name) if letter == "_")
        return self.opaque or not self.suspects.isdisjoint((name, *heads))

    def known_type(self, name: tree.Name, report: Callable[[Diagnostic], object]) -> str | None:
        """The type of a name; if unknown, None, reported unless unreadable text may declare it."""
        if name.text in self.types:
            return name.text
        if not self.opaque_types and not self.may_know(name.text):
            report(say.unknown_type(name, list(self.types)))
        return None

    def ancestors(self, type_name: str) -> list[str]:
        """The type and its supertypes; stops at a cycle."""
        names: dict[str, None] = {}
        current: str | None = type_name
        while current is not None and current in self.types and current not in names:
            names[current] = None
            current = self.types[current].parent
        return list(names)

    def fits(self, type_name: str, wanted: str) -> bool:
        """Whether a type may be a subtype of ``wanted``."""
        above = self.ancestors(type_name)
        unsure = wanted not in self.types or not self.uncertain.isdisjoint(above) or not above
        return unsure or wanted in above


def symbol_table(files: Sequence[tree.File], *, opaque: bool = False) -> SymbolTable:
    """The symbol table of the used vocabularies, then of the using file."""
    vocabularies = {file.span.source for file in files if file.name and file.kind == "vocabulary"}
    symbols = SymbolTable(
        of_vocabularies=vocabularies, opaque=opaque or not all(file.complete for file in files)
    )
    for file in files:
        for item in file.items:
            if isinstance(item, tree.BrokenItem):
                symbols.suspects |= item.names
                symbols.opaque |= item.nameless and item.word != "type"
                symbols.opaque_types |= item.nameless and item.word == "type"
        _declare_types(symbols, file)
    for file in files:
        for item in file.items:
            if isinstance(item, tree.EnumerationItem | tree.SignalItem | tree.QuantityItem):
                _declare_item(symbols, item, _roots(symbols, file))
    _note_clashes(symbols, files)
    _note_lookalikes(symbols)
    for (first, again), names in symbols.shared.items():
        uses = [_use_of(source, files) for source in (first, again)]
        symbols.mistakes.append(say.both_declare(names, *uses))
    return symbols


def _use_of(vocabulary: Source, files: Sequence[tree.File]) -> tree.UseLine:
    (name,) = (file.name.text for file in files if file.name and file.span.source == vocabulary)
    return [use for file in files for use in file.uses if use.name.text == name][-1]


def _note_lookalikes(symbols: SymbolTable) -> None:
    """Warn of a name that looks like one in another file; within a file the parser does."""
    spans = {**symbols.type_spans, **symbols.spans}
    if all(map(str.isascii, spans)):
        return
    seen: dict[str, Span] = {}
    for span in spans.values():
        other = seen.setdefault(skeleton_of(span.text), span)
        if other.text != span.text and other.source != span.source:
            symbols.mistakes.append(looks_like(span, other.text, other))


def _note_clashes(symbols: SymbolTable, files: Sequence[tree.File]) -> None:
    order = [file.span.source for file in files]
    for name in symbols.type_spans.keys() & symbols.spans.keys():
        spans = (symbols.type_spans[name], symbols.spans[name])
        first, again = sorted(spans, key=lambda span: (order.index(span.source), span.start))
        symbols.twice("name", tree.Name(name, span=again), first)


def _declare_types(symbols: SymbolTable, file: tree.File) -> None:
    fresh: list[tree.TypeItem] = []
    for item in file.items:
        if not isinstance(item, tree.TypeItem):
            continue
        name = item.name.text
        if name in symbols.types:
            symbols.twice("type", item.name, symbols.type_spans[name])
            continue
        symbols.types[name] = ObjectType(name, item.parent.text if item.parent else None)
        symbols.type_spans[name] = item.name.span
        fresh.append(item)
    for item in fresh:
        parent = item.parent
        if parent is not None and symbols.known_type(parent, symbols.mistakes.append) is None:
            symbols.types[item.name.text] = ObjectType(item.name.text)
            symbols.uncertain.add(item.name.text)
    _limit_depth(symbols, fresh)
    for item in fresh:
        _break_circle(symbols, item)


def _limit_depth(symbols: SymbolTable, fresh: Sequence[tree.TypeItem]) -> None:
    """Cut off chains of types that are too long for later stages."""
    most = TYPE_DEPTH.value()
    depths: dict[str, int] = {}
    for item in fresh:
        chain = []
        current: str | None = item.name.text
        while current is not None and current in symbols.types and current not in depths:
            depths[current] = 0  # where it closes a circle
            chain.append(current)
            current = symbols.types[current].parent
        depth = depths.get(current, 0) if current is not None else 0
        for name in reversed(chain):
            depth += 1
            if depth > most:
                span = symbols.type_spans[name]
                error = TYPE_DEPTH.exceeded(span.place, f"type `{name}`")
                symbols.mistakes += error.diagnostics
                symbols.types[name] = ObjectType(name)
                symbols.uncertain.add(name)
                depth = 1
            depths[name] = depth


def _break_circle(symbols: SymbolTable, item: tree.TypeItem) -> None:
    above = symbols.ancestors(item.name.text)
    top = symbols.types[above[-1]].parent
    if top != item.name.text or item.parent is None:
        return
    chain = " is ".join(f"`{name}`" for name in [*above, top])
    symbols.mistakes.append(
        TYPE_CIRCLE.at(
            item.parent.span,
            f"the types go round in a circle: {chain}",
            expected="this closes the circle"
            if len(above) > 1
            else "a type cannot be above itself",
            help=offering("leave out `is …` at the most general of them", _without_parent(item)),
            labels=tuple(
                Label(symbols.type_spans[name].place, f"`{name}` is declared here")
                for name in above[1:]
            ),
        )
    )
    for name in above:
        symbols.types[name] = ObjectType(name)
        symbols.uncertain.add(name)


def _without_parent(item: tree.TypeItem) -> Offer:
    assert item.parent is not None, "it is in a circle"
    parent, own = item.parent.span, item.name.span
    return left_out(Span(own.source, own.end, parent.end), f"Leave out `is {item.parent.text}`")


def _roots(symbols: SymbolTable, file: tree.File) -> list[str]:
    # A parameter defaults to one of a vocabulary's own types, in a rulebook to any.
    own = {item.name.text for item in file.items if isinstance(item, tree.TypeItem)}
    return [
        type_.name
        for type_ in symbols.types.values()
        if type_.parent is None and (file.kind == "rulebook" or type_.name in own)
    ]


def _declare_item(
    symbols: SymbolTable,
    item: tree.EnumerationItem | tree.SignalItem | tree.QuantityItem,
    roots: list[str],
) -> None:
    match item:
        case tree.SignalItem(signals, truth):
            for head in signals:
                types = _parameter_types(symbols, head.name, head.parameters, roots)
                _add(symbols, head.name, Signal(head.name.text, types, truth))
        case tree.QuantityItem(name, parameters, unit, number):
            types = _parameter_types(symbols, name, parameters, roots)
            if symbols.unit(unit) is None:
                symbols.mistakes.append(say.unknown_unit(item.unit, item.unit_span, name.text))
            _add(symbols, name, Quantity(name.text, types, unit, number))
        case tree.EnumerationItem(name, parameters, values, chosen):
            types = _parameter_types(symbols, name, parameters, roots)
            texts = tuple(dict.fromkeys(value.text for value in values))
            default = chosen.text if chosen is not None and chosen.text in texts else None
            if chosen is not None and default is None:
                symbols.mistakes.append(say.no_such_value(name, chosen, texts))
                symbols.uncertain.add(name.text)
            enumeration = Enumeration(name.text, types, texts, default)
            _add(symbols, name, enumeration)
            for value in values:
                if _is_new(symbols, value):
                    symbols.value_of[value.text] = enumeration


def _is_new(symbols: SymbolTable, name: tree.Name) -> bool:
    first = symbols.spans.setdefault(name.text, name.span)
    if first is not name.span:
        symbols.twice("name", name, first)
    return first is name.span


def _add(symbols: SymbolTable, name: tree.Name, item: Declaration) -> None:
    if _is_new(symbols, name):
        symbols.items[name.text] = item


def _parameter_types(
    symbols: SymbolTable, name: tree.Name, parameters: tuple[tree.Parameter, ...], roots: list[str]
) -> tuple[str, ...]:
    types: list[str] = []
    seen: dict[str, Span] = {}
    for position, parameter in enumerate(parameters):
        first = seen.setdefault(parameter.name.text, parameter.name.span)
        if first is not parameter.name.span:
            symbols.mistakes.append(say.twice("parameter", parameter.name, first))
        if name.text not in symbols.spans:
            symbols.parameter_spans[name.text, position] = parameter.span
        if parameter.type is not None:
            types.append(parameter.type.text)
            symbols.known_type(parameter.type, symbols.mistakes.append)
        elif len(roots) == 1:
            types.append(roots[0])
        else:
            types.append("")
            if not (symbols.opaque or symbols.opaque_types or symbols.suspects):
                symbols.mistakes.append(say.which_type(parameter, roots))
    return tuple(types)
