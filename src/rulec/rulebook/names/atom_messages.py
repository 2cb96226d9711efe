"""Messages about names in formulas."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

from rulec.diagnostics import Diagnostic, Label, Offer, Span, any_of, named, nearest_name
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import (
    Help,
    declared,
    meant,
    offering,
    text_before,
    write,
)
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.names.word_meanings import described, in_other_letters, offer
from rulec.syntax import tree
from rulec.syntax.keywords import INFIX_LETTERS, PREFIX_LETTERS, UNARY_OPERATORS
from rulec.syntax.messages.in_comparisons import ABSOLUTE, NO_ABSOLUTE_VALUE
from rulec.vocabulary import Enumeration, Quantity, Signal
from rulec.vocabulary.units import parse_unit

UNKNOWN_NAME = Code("R0202")

UNKNOWN_VARIABLE = Code("R0203")


WRONG_ARITY = Code("R0301")

WRONG_ARGUMENT_TYPE = Code("R0302")

NOT_BOOLEAN = Code("R0303")

AMBIGUOUS_NAME = Code("R0309")


MIXED_DIMENSIONS = Code("R0312")

NUMBER_OR_FORMULA = Code("R0313")

_ALIKE = 0.75
"""The least similarity of a misspelt name; less similar ones are usually other words."""

MOST_SEARCHED = 100
"""For so many unknown names of a rulebook known ones are looked for, which takes milliseconds."""

_COMPARED = re.compile(r"\s*(?:[<>]=?|!?=)\s*[\d.]+[ \t]*([^\W\d][\w/^%]*|%)?")
_PARTED_UNIT = re.compile(r"\d[ \t]*([^\W\d]+)[ \t]*/[ \t]*\Z")
_ATOM = "expected a signal or a value"
_GLUED = re.compile(rf"([{PREFIX_LETTERS}]+)(\w+)")
_GLUED_BINARY = re.compile(rf"(\w+?)([{INFIX_LETTERS}])(\w+)")


def explain(
    use: tree.AtomUse,
    symbols: SymbolTable,
    variables: Mapping[str, str | None],
    others: Collection[str],
) -> Diagnostic:
    """The mistake that a name is not an atom: it is something else, or unknown.

    ``variables`` have types, None if unknown; ``others`` are further names that a formula may use.
    """
    name = use.name.text
    item = symbols.items.get(name)
    if isinstance(item, Enumeration):
        call = f"({', '.join('…' for _ in item.parameters)})" if item.parameters else ""
        values = any_of([f"`{value}{call}`" for value in item.values])
        message, span = "has several values and cannot", symbols.spans[name]
        way_out: Help = offering(f"write {values}", *(() if call else item.values))
    elif name in symbols.types:
        message, span = "is a type of objects and cannot", symbols.type_spans[name]
        way_out = f"speak of an object: give the rule a variable, such as `(x: {name})`"
    else:
        return _unknown(use, symbols, variables, others)
    return NOT_BOOLEAN.at(
        use.name.span,
        f"`{name}` {message} be true or false",
        expected=_ATOM,
        help=way_out,
        labels=(Label(span.place, f"`{name}` is declared here"),),
    )


def _unknown(
    use: tree.AtomUse,
    symbols: SymbolTable,
    variables: Mapping[str, str | None],
    others: Collection[str],
) -> Diagnostic:
    name = use.name.text
    atoms = symbols.atoms()
    quantities = [item.name for item in symbols.items.values() if isinstance(item, Quantity)]
    # `nevr (p)` reads as a name with an argument
    operators = sorted(UNARY_OPERATORS) if use.arguments else []
    spelt = [*atoms, *quantities, *others, *operators]
    glued = _glued(name, set(atoms))
    parted = _PARTED_UNIT.search(use.span.source.text, 0, use.name.span.start)
    if parted and parse_unit(f"{parted[1]}/{name}"):
        whole = Span(use.span.source, parted.start(1), use.name.span.end)
        unit = f"{parted[1]}/{name}"
        way_out: Help = offering(f"a unit is one word: write `{unit}`", write(unit, whole))
    elif name == "if":
        way_out = "write `p implies q` for `if p then q`"
    elif use.arguments and name.casefold() in ABSOLUTE:
        way_out = NO_ABSOLUTE_VALUE
    elif glued:
        way_out = offering(f"write `{glued}`", glued)
    elif len(symbols.searched) >= MOST_SEARCHED and name not in symbols.searched:
        way_out = _to_be_declared(use, variables)
    else:
        symbols.searched.add(name)
        way_out = (
            ("" if use.arguments else _short_form(name, symbols, list(variables)))
            or in_other_letters(name, spelt)
            or meant(name, spelt, _ALIKE, longer=False)
            or _by_meaning(name, [*atoms, *quantities, *others], symbols)
            or meant(name, spelt, _ALIKE)
            or _of_no_object(use, quantities)
            or _to_be_declared(use, variables)
        )
    return UNKNOWN_NAME.at(
        use.name.span, f"nothing is called `{name}`", expected=_ATOM, help=way_out
    )


def _to_be_declared(use: tree.AtomUse, variables: Mapping[str, str | None]) -> Help:
    """Help that declares the name: as a quantity if it is compared with a number."""
    words, unit = f"signal {_as_used(use, variables)}", ""
    if compared := _COMPARED.match(use.span.source.text, use.span.end):
        unit = compared[1] if compared[1] and parse_unit(compared[1]) else "UNIT"
        words = f"quantity {_as_used(use, variables)} in {unit}"
    # Which unit is meant, only the author knows.
    offers = () if unit == "UNIT" else (declared(words, use.span),)
    return offering(f"declare it, such as `{words}`, or `use` a vocabulary that has it", *offers)


def _by_meaning(name: str, known: Sequence[str], symbols: SymbolTable) -> Help:
    """Words that mean what a name seems to mean: those without phrases by their names alone."""
    vocabularies = {Path(file.name).stem for file in symbols.of_vocabularies}
    return offer(name, described(known, vocabularies))


def _of_no_object(use: tree.AtomUse, quantities: Collection[str]) -> str:
    """Help for what looks like a function of numbers, which no declaration can be."""
    number = next((one.text for one in use.arguments if one.text in quantities), "")
    return f"only objects go in parentheses, and `{number}` is a number" if number else ""


def _as_used(use: tree.AtomUse, variables: Mapping[str, str | None]) -> str:
    """The declaration that fits a use: `braking(v: vehicle)` for `braking(v)`."""
    names = [argument.text for argument in use.arguments]
    if not names or any(variables.get(name) is None for name in names):
        return use.name.text
    parameters = ", ".join(f"{name}: {variables[name]}" for name in names)
    return f"{use.name.text}({parameters})"


def _short_form(name: str, symbols: SymbolTable, variables: Sequence[str]) -> Help:
    head, _, tail = name.rpartition("_")
    item = symbols.behind_atom(head)
    if item is not None and len(item.parameters) == 1:
        known = f"it has {named(variables)}" if variables else "it has none"
        return f"`{name}` means `{head}({tail})`, but the rule has no variable `{tail}`; {known}"
    if item is not None and tail in variables:
        number = len(item.parameters) or "no"
        return f"`{head}` is about {number} objects, so `_{tail}` cannot follow it"
    near = nearest_name(head, symbols.about_one()) if tail in variables else None
    return offering(f"did you mean `{near}_{tail}`?", f"{near}_{tail}") if near else ""


def _glued(name: str, atoms: set[str]) -> str:
    """``GFp`` split to ``G F p``, ``pUq`` to ``p U q``; empty if the parts are no atoms."""
    unary = _GLUED.fullmatch(name)
    if unary is not None:
        for cut in range(len(unary[1]), 0, -1):
            if name[cut:] in atoms:
                return " ".join([*name[:cut], name[cut:]])
    binary = _GLUED_BINARY.fullmatch(name)
    if binary is not None and binary[1] in atoms and binary[3] in atoms:
        return " ".join(binary.groups())
    return ""


def wrong_number(
    use: tree.AtomUse,
    name: str,
    item: Signal | Enumeration | Quantity,
    symbols: SymbolTable,
    variables: Sequence[str],
) -> Diagnostic:
    needed, given = len(item.parameters), len(use.arguments)
    objects = {0: "no object", 1: "one object"}.get(needed, f"{needed} objects")
    has = {0: "none is", 1: "one is"}.get(given, f"{given} are")
    named_here = [argument.text for argument in use.arguments]
    rest = [variable for variable in variables if variable not in named_here]
    written = f"{name}({', '.join([*named_here, *rest, *['…'] * needed][:needed])})"
    if given > needed:
        way_out: Help = says_nothing_of(name, named_here, needed, symbols)
    elif variables:
        # Of several variables, which are meant only the author knows.
        way_out = offering(
            f"write `{written}`", *((written,) if given + len(rest) == needed else ())
        )
    else:
        way_out = _declared(name, item)
    is_value = isinstance(item, Enumeration) and item.name != name
    subject = f"`{name}` is a value of `{item.name}`, which" if is_value else f"`{name}`"
    return WRONG_ARITY.at(
        use.span,
        f"{subject} is about {objects}, and {has} given",
        expected=f"expected {objects}",
        help=way_out,
        labels=(Label(symbols.spans[name].place, f"`{name}` is declared here"),),
    )


def says_nothing_of(name: str, objects: Sequence[str], needed: int, symbols: SymbolTable) -> str:
    """Help where a word is said of too many objects.

    Without them it would be about somebody else, so this is never an edit.
    """
    if needed:
        return f"say of {'which' if needed == 1 else f'which {needed}'} of them it holds"
    others = [
        word
        for word in {*symbols.atoms(), *symbols.items}
        if isinstance(item := symbols.behind_atom(word) or symbols.items[word], Quantity | Signal)
        and len(item.parameters) == len(objects)
    ]
    near = offer(
        name, described(others, {Path(file.name).stem for file in symbols.of_vocabularies})
    )
    whom = f"`{name}` is about ego or the world, and no word says it of {named(objects)}"
    return f"{whom}; {near}" if near else whom


def wrong_arity_of_argument(mistake: Diagnostic, use: tree.AtomUse, given: Span) -> Diagnostic:
    """WRONG_ARITY of a relation that was given to a definition, at the place where it was given."""
    text = use.span.text
    number = len(use.arguments)
    objects = {0: "no object", 1: "one object"}.get(number, f"{number} objects")
    return WRONG_ARITY.at(
        given,
        mistake.message,
        expected=f"expected something about {objects}",
        help=f"the definition uses it as `{text}`: give it what is about {objects}",
        labels=(*mistake.labels, Label(use.span.place, f"it is used here as `{text}`")),
    )


def _declared(name: str, item: Signal | Enumeration | Quantity) -> str:
    """Help where there is no variable yet."""
    letters = "xyz"[: len(item.parameters)]
    pairs = zip(letters, item.parameters, strict=False)
    variables = ", ".join(f"{letter}: {parameter}" for letter, parameter in pairs)
    return (
        f"write `{name}({', '.join(letters)})`, and `({variables})` after the rule's name or that "
        "of the definition"
    )


def two_readings(use: tree.AtomUse, readings: Sequence[tuple[str, str]]) -> Diagnostic:
    """``a_b_c`` where both ``a(b_c)`` and ``a_b(c)`` make sense."""
    ways = any_of([f"`{head}({variable})`" for head, variable in readings])
    return AMBIGUOUS_NAME.at(
        use.span,
        f"`{use.name.text}` can mean {ways}",
        expected="expected a name with one meaning",
        help=offering(
            "write the one you mean with parentheses",
            *(f"{head}({variable})" for head, variable in readings),
        ),
    )


def unknown_variable(
    name: tree.Name,
    symbols: SymbolTable,
    variables: Sequence[str],
    relations: Sequence[str],
    *,
    owner: str,
    wanted: str | None = None,
) -> Diagnostic:
    """The mistake that the rule or definition ``owner`` has no such variable.

    In its place a definition could take one of ``relations``. A variable there would be of the type
    ``wanted``, if known.
    """
    kind = wanted or next(iter(symbols.types), "vehicle")
    if owner == "example":
        typed = f"({name.text}: {kind})"
        way_out: Help = (
            f"declare it after the rule's name, or after this example's label: `{typed}`"
        )
    elif variables:
        way_out = f"the {owner}'s variables are {named(variables)}"
        if len(variables) == 1:
            way_out = offering(f"the {owner}'s only variable is {named(variables)}", *variables)
    else:
        way_out = f"declare it after the {owner}'s name, such as `({name.text}: {kind})`"
    return UNKNOWN_VARIABLE.at(
        name.span,
        f"the {owner} has no variable `{name.text}`",
        expected=f"expected a variable of the {owner}",
        help=meant(name.text, [*variables, *relations]) or way_out,
    )


def wrong_type(argument: tree.Name, kind: str, wanted: str, labels: Sequence[Label]) -> Diagnostic:
    return WRONG_ARGUMENT_TYPE.at(
        argument.span,
        f"`{argument.text}` is of type `{kind}`, which is no `{wanted}`",
        expected=f"expected a variable of type `{wanted}`",
        help=offering(
            f"declare it as `{argument.text}: {wanted}`, or use another variable",
            *_as_declared(argument, wanted),
        ),
        labels=tuple(labels),
    )


def _as_declared(argument: tree.Name, wanted: str) -> Iterator[Offer]:
    """Another type for a variable where it is declared, in the head of its rule."""
    before = text_before(argument.span)
    start = argument.span.start - len(before)
    declarations = re.finditer(rf"\b{re.escape(argument.text)}\s*:\s*\w+", before)
    for last in deque(declarations, maxlen=1):
        place = Span(argument.span.source, start + last.start(), start + last.end())
        yield write(f"{argument.text}: {wanted}", place)


def two_types(name: tree.Name, wanted: str, known_type: str | None, known: Span) -> Diagnostic:
    return WRONG_ARGUMENT_TYPE.at(
        name.span,
        f"`{name.text}` cannot be both a `{known_type}` and a `{wanted}`",
        expected=f"here it has to be a `{wanted}`",
        help="say the fact of objects of one type",
        labels=(Label(known.place, f"here it has to be a `{known_type}`"),),
    )
