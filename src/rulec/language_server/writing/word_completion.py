"""Completions at the cursor, determined by grammar and types."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from lsprotocol import types as lsp

from rulec.diagnostics import RulecError
from rulec.language_server.names.name_occurrences import DocumentNames, item_at
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.language_server.writing.piece_at_cursor import PieceAtCursor, piece_at
from rulec.rulebook.files.catalogue import list_vocabularies
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.rulebook.names.doc_comments import description
from rulec.settings import search_path
from rulec.syntax import tree
from rulec.syntax.keywords import CLAUSE_WORDS, DECLARATION_WORDS
from rulec.syntax.messages.parse_context import spelling
from rulec.syntax.tree_printer import print_parameter
from rulec.vocabulary import Quantity
from rulec.vocabulary.dimensions import DIMENSIONS, Dimension

_NO_WORDS = frozenset(("NAME", "BOOK", "STRING", "DATE", "NUMBER", "UNIT", "$END"))
_RELATIONS = ("<", "<=", "=", "!=", ">=", ">")
_BEGINNINGS = (
    *("rulebook", "vocabulary", "title", "law", "use", "extends", "traffic", "semantics", "step"),
    *("priority", "provisions", "topics", "option", "param", "set", "define", "redefine", "signal"),
    *("quantity", "type", "fact", "constant", "presumed", "hard rule", "soft rule"),
    *("override rule", "confirm rule", "drop rule", "soften rule", "silent on"),
)
_CLAUSES = tuple(sorted((CLAUSE_WORDS - {"also"}) | {"also unless", "in force"}))
_KINDS = lsp.CompletionItemKind


def completions(
    names: DocumentNames, offset: int, positions: TextPositions, editor: EditorWorkspace
) -> list[lsp.CompletionItem]:
    """What can follow at a character of a document, the most likely first."""
    piece = piece_at(names, offset)
    if piece is None:
        return []
    where = positions.range(piece.start, offset)
    items: dict[str, lsp.CompletionItem] = {}
    for rank, item in _all(piece, names, offset, editor):
        if item.label not in items:
            new_text = item.insert_text or item.label
            item.text_edit = lsp.TextEdit(where, new_text)
            item.insert_text = None
            item.sort_text = f"{rank}{item.label}"
            items[item.label] = item
    return list(items.values())


Ranked = tuple[int, lsp.CompletionItem]


def _all(
    piece: PieceAtCursor, names: DocumentNames, offset: int, editor: EditorWorkspace
) -> Iterator[Ranked]:
    if piece.kind is None:
        words = DECLARATION_WORDS if piece.in_vocabulary else _BEGINNINGS
        yield from _keywords(words, 0)
        return
    if piece.kind == "clause" and not piece.tokens:
        yield from _keywords(_CLAUSES, 0)
        return
    if piece.accepted & {"NAME", "BOOK"}:
        yield from _names(piece, names, offset, editor)
    possible = [spelling(kind) for kind in sorted(piece.accepted - _NO_WORDS)]
    yield from _keywords([word for word in possible if word[0].isalpha()], 5)
    if "UNIT" in piece.accepted:
        yield from _units(names)
    if "$END" in piece.accepted and piece.kind == "clause":
        yield from _keywords(_CLAUSES, 6)
    elif "$END" in piece.accepted and piece.kind == "item":
        yield from _keywords(DECLARATION_WORDS if piece.in_vocabulary else _BEGINNINGS, 7)


def _keywords(words: Iterable[str], rank: int) -> Iterator[Ranked]:
    for word in words:
        yield rank, lsp.CompletionItem(word, kind=_KINDS.Keyword)


def _simple(
    words: Iterable[str], kind: lsp.CompletionItemKind, detail: str = ""
) -> Iterator[Ranked]:
    for word in words:
        yield 1, lsp.CompletionItem(word, kind=kind, detail=detail or None)


def _names(
    piece: PieceAtCursor, names: DocumentNames, offset: int, editor: EditorWorkspace
) -> Iterator[Ranked]:
    laid, symbols = names.chain.names.constants.overlay, names.chain.names.symbols
    before = piece.text()
    match piece.first, before:
        case ("use", "use") | ("extends", "extends"):
            yield from _files(piece.first, names, editor)
            return
        case ("override" | "confirm" | "drop" | "soften", "rule"):
            own = {item.name.text for item in names.file.items if isinstance(item, tree.RuleItem)}
            inherited = [name for name, entry in laid.rules.items() if name not in own]
            yield from _simple(inherited, _KINDS.Method, "inherited rule")
            return
        case ("set", "set"):
            yield from _simple([*laid.options, *laid.parameters], _KINDS.Constant)
            return
        case ("redefine", "redefine"):
            yield from _simple(laid.definitions, _KINDS.Function)
            return
        case ("topic", _):
            yield from _simple(laid.topics, _KINDS.Module)
            return
        case ("priority", _):
            yield from _simple(names.chain.names.levels, _KINDS.EnumMember)
            return
        case ("param", ":"):
            yield from _simple(DIMENSIONS, _KINDS.Unit, "dimension")
            return
        case (_, ":") | ("type", "is"):
            yield from _simple(symbols.types, _KINDS.Class, "type")
            return
        case ("constant" | "presumed", _):
            yield from _simple(symbols.items, _KINDS.Variable)
            return
    if piece.kind == "rule_head":
        if before == "in":
            yield from _simple(names.chain.names.levels, _KINDS.EnumMember, "priority level")
        return
    if piece.kind == "item" and piece.first not in ("param", "set", "define", "redefine", "fact"):
        return
    if piece.kind == "item" and len(piece.tokens) == 1 and piece.first != "fact":
        return  # a new name
    yield from _in_formula(piece, names, offset)


def _files(word: str, names: DocumentNames, editor: EditorWorkspace) -> Iterator[Ranked]:
    path = names.checked.path
    with editor.as_shown():
        try:
            folders = list(search_path(None if path is None else path.parent))
        except RulecError:
            folders = []
        folders += [] if path is None else [path.parent, path.parent.parent]
        available = (
            available_rulebooks(folders)
            if word == "extends"
            else [entry.name for entry in list_vocabularies(folders)]
        )
    own = names.file.name.text if names.file.name else ""
    yield from _simple([name for name in available if name != own], _KINDS.File)


def _scope(names: DocumentNames, piece: PieceAtCursor, offset: int) -> dict[str, str]:
    """The variables in scope at the cursor, with their types; empty if untyped."""
    scope: dict[str, str] = {}
    item = item_at(names, offset)
    match item:
        case tree.RuleItem():
            entry = names.chain.names.constants.overlay.rules.get(item.name.text)
            inherited = entry.item.variables if entry is not None else ()
            for parameter in item.variables or inherited:
                scope[parameter.name.text] = parameter.type.text if parameter.type else ""
            for example in item.examples:
                if example.span.start <= offset <= example.span.end:
                    scope |= {o.name.text: o.type.text for o in example.objects if o.type}
        case tree.DefineItem(parameters=parameters):
            scope = {x.name.text: x.type.text if x.type else "" for x in parameters}
    # What is being written may not be in a tree yet: look for `name: type` before the cursor.
    tokens = (*piece.heads, *piece.tokens)
    for number in range(len(tokens) - 2):
        if tokens[number + 1].text == ":" and tokens[number].kind == "word":
            scope[tokens[number].text] = tokens[number + 2].text
    return scope


def _in_formula(piece: PieceAtCursor, names: DocumentNames, offset: int) -> Iterator[Ranked]:
    scope = _scope(names, piece, offset)
    call = open_call(piece)
    if call is not None:
        yield from _arguments(call, scope, names)
        return
    wanted = _dimension_wanted(piece, names)
    laid, symbols = names.chain.names.constants.overlay, names.chain.names.symbols
    for name in (
        *symbols.atoms(),
        *(n for n, i in symbols.items.items() if isinstance(i, Quantity)),
    ):
        item = symbols.items.get(name) or symbols.value_of[name]
        unit = symbols.unit(item.unit) if isinstance(item, Quantity) else None
        if wanted is not None and (unit is None or unit.dimension != wanted):
            continue
        kind = _KINDS.Unit if unit is not None else _KINDS.EnumMember
        kind = _KINDS.Variable if unit is None and name in symbols.items else kind
        span = symbols.spans.get(name)
        text = description(span) if span is not None else ""
        in_unit = f" in {item.unit}" if isinstance(item, Quantity) else ""
        if not item.parameters:
            detail = f"of ego or the world{in_unit}"
            yield 2, lsp.CompletionItem(name, kind=kind, detail=detail, documentation=text or None)
            continue
        for objects in _fitting(item.parameters, scope, names):
            label = f"{name}({', '.join(objects)})"
            about = " and ".join(item.parameters)
            detail = f"of an object, {about}{in_unit}"
            yield 1, lsp.CompletionItem(label, kind=kind, detail=detail, documentation=text or None)
    if piece.kind == "state":
        return
    yield from _provisions(wanted, scope, names)
    if wanted is None:
        yield from _simple(laid.options, _KINDS.Constant, "option")


def _provisions(
    wanted: Dimension | None, scope: dict[str, str], names: DocumentNames
) -> Iterator[Ranked]:
    constants = names.chain.names.constants
    for name in constants.overlay.parameters:
        number = constants.numbers.get(name)
        dimension = None if number is None else number.dimension
        if wanted is None or dimension in (None, wanted):
            yield 3, lsp.CompletionItem(name, kind=_KINDS.Constant, detail="parameter")
    for name, item in constants.overlay.definitions.items():
        if wanted is not None:
            continue
        types = [parameter.type.text if parameter.type else "" for parameter in item.parameters]
        for objects in _fitting(types, scope, names) if types else [()]:
            label = f"{name}({', '.join(objects)})" if objects else name
            yield 3, lsp.CompletionItem(label, kind=_KINDS.Function, detail="definition")


def _fitting(
    types: Sequence[str], scope: dict[str, str], names: DocumentNames
) -> Iterator[tuple[str, ...]]:
    """Distinct variables in scope that fit these types; all choices for a single parameter."""
    symbols = names.chain.names.symbols
    fits = [
        [name for name, kind in scope.items() if not kind or not x or symbols.fits(kind, x)]
        for x in types
    ]
    if len(fits) == 1:
        yield from ((name,) for name in fits[0])
        return
    chosen: list[str] = []
    for options in fits:
        name = next((option for option in options if option not in chosen), None)
        if name is None:
            return
        chosen.append(name)
    yield tuple(chosen)


def open_call(piece: PieceAtCursor) -> tuple[str, int] | None:
    """The name whose parentheses are open at the cursor, and the number of the argument."""
    depth = commas = 0
    for back in range(1, len(piece.tokens) + 1):
        text = piece.text(back)
        if text == ")":
            depth += 1
        elif text == "(" and depth:
            depth -= 1
        elif text == "(":
            name = piece.tokens[-back - 1] if back < len(piece.tokens) else None
            touches = name is not None and name.end == piece.tokens[-back].start
            if name is None or name.kind != "word" or not touches:
                return None
            return name.text, commas
        elif text == "," and not depth:
            commas += 1
        elif depth == 0 and piece.tokens[-back].kind != "word":
            return None
    return None


def _arguments(
    call: tuple[str, int], scope: dict[str, str], names: DocumentNames
) -> Iterator[Ranked]:
    types = parameter_types(call[0], names)
    if types is None or call[1] >= len(types):
        return
    wanted, symbols = types[call[1]], names.chain.names.symbols
    for name, kind in scope.items():
        if not wanted or not kind or symbols.fits(kind, wanted):
            yield 1, lsp.CompletionItem(name, kind=_KINDS.Variable, detail=kind or None)


def parameter_types(name: str, names: DocumentNames) -> list[str] | None:
    """The parameter types of a word or definition, empty for any type; None for other names."""
    item = names.chain.names.constants.overlay.definitions.get(name)
    if item is not None:
        return [parameter.type.text if parameter.type else "" for parameter in item.parameters]
    symbols = names.chain.names.symbols
    known = symbols.items.get(name) or symbols.value_of.get(name)
    return None if known is None else list(known.parameters)


def _dimension_wanted(piece: PieceAtCursor, names: DocumentNames) -> Dimension | None:
    """The dimension of the number on the other side of a comparison; None elsewhere."""
    if piece.text() not in _RELATIONS:
        return None
    back = 2
    if piece.text(back) == ")":
        while back <= len(piece.tokens) and piece.text(back) != "(":
            back += 1
        back += 1
    return dimension_of(piece.text(back), names)


def dimension_of(name: str, names: DocumentNames) -> Dimension | None:
    """The dimension of a quantity, also in its short form, or of a parameter."""
    symbols, constants = names.chain.names.symbols, names.chain.names.constants
    known = constants.numbers.get(name)
    if known is not None:
        return known.dimension
    unit = symbols.unit(symbols.unit_meant(name))
    return None if unit is None else unit.dimension


def _units(names: DocumentNames) -> Iterator[Ranked]:
    """The units of the vocabularies' quantities."""
    symbols = names.chain.names.symbols
    used = dict.fromkeys(i.unit for i in symbols.items.values() if isinstance(i, Quantity))
    yield from _simple((unit for unit in used if unit), _KINDS.Unit, "unit")


def signature(names: DocumentNames, offset: int) -> lsp.SignatureHelp | None:
    """The parameters of the word or definition whose parentheses are open at a character."""
    piece = piece_at(names, offset)
    call = None if piece is None else open_call(piece)
    if call is None:
        return None
    name, number = call
    types = parameter_types(name, names)
    if types is None:
        return None
    definition = names.chain.names.constants.overlay.definitions.get(name)
    if definition is not None:
        labels = [*map(print_parameter, definition.parameters)]
        span = definition.span
    else:
        labels = types
        span = names.chain.names.symbols.spans[name]
    return lsp.SignatureHelp(
        [
            lsp.SignatureInformation(
                f"{name}({', '.join(labels)})",
                documentation=description(span) or None,
                parameters=[lsp.ParameterInformation(label) for label in labels],
            )
        ],
        active_signature=0,
        active_parameter=min(number, max(0, len(types) - 1)),
    )
