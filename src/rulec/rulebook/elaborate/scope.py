"""Scopes: the symbols that a formula can refer to, and their lookup."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.logic.formula import Atom, QuantityTerm
from rulec.rulebook.names import atom_messages
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.syntax import tree
from rulec.vocabulary import Enumeration, Signal
from rulec.vocabulary import Quantity as QuantityDeclaration

SIDES = {"near_side_of": {"right": "right_of", "left": "left_of"}}
SIDES["far_side_of"] = {"right": "left_of", "left": "right_of"}
"""Relation -> traffic -> the absolute side that it is."""


@dataclass(frozen=True, slots=True)
class BoundVariable:
    """Bound variable: its type, None if unknown, and its place.

    ``actual`` is its name in the rule: inside a definition that is the argument's.
    """

    type: str | None
    span: Span
    actual: str


@dataclass(frozen=True, slots=True)
class AnyArgument:
    """Object or relation, unknown while a definition is checked by itself."""


@dataclass(frozen=True, slots=True)
class Call:
    """Expansion of a definition, or evaluation of a parameter, in progress.

    ``span`` is the use; None where that says nothing: a parameter is the same wherever it is used.
    """

    name: str
    span: Span | None


Declared_ = Signal | Enumeration | QuantityDeclaration


@dataclass(slots=True)
class Scope:
    """One rule's or definition's view: the declarations, provisions and its variables.

    ``relations`` are the parameters of a definition that stand for relations. ``calls`` are the
    definitions that are being put in, outermost first. ``in_moment`` tells that the formula speaks
    of one state alone, as in a count and in a parameter. ``counted`` are the variables (actual
    names) of the counts around, ``taken`` all actual names in use.
    """

    symbols: SymbolTable
    constants: ConstantsAndMacros
    variables: dict[str, BoundVariable]
    mistakes: list[Diagnostic]
    used: set[str] = field(default_factory=set)
    relations: dict[str, str | AnyArgument] = field(default_factory=dict)
    calls: tuple[Call, ...] = ()
    counted: frozenset[str] = frozenset()
    taken: frozenset[str] = frozenset()
    in_moment: bool = False
    of_definition: bool = False
    blamed: set[int] = field(default_factory=set)
    """Where uses of definitions begin that have been found to be wrong."""

    def report(self, mistake: Diagnostic) -> None:
        """Note a mistake, with the uses of definitions that led to it.

        A definition has been checked by itself. If what is wrong is how it is used, one mistake is
        enough to say so.
        """
        outermost = self.calls[0].span if self.calls else None
        if outermost is not None and mistake.severity == "error":
            if outermost.start in self.blamed:
                return
            self.blamed.add(outermost.start)
        labels: list[Label] = []
        for call in reversed(self.calls):
            if call.span is None:
                break
            labels.insert(0, Label(call.span.place, f"`{call.name}` is used here"))
        if labels:
            mistake = replace(mistake, labels=(*mistake.labels, *labels))
        if mistake not in self.mistakes:
            self.mistakes.append(mistake)

    def behind(self, name: str) -> Declared_ | None:
        """The signal, quantity or enumeration that a name refers to.

        An enumeration is found by the names of its values.
        """
        quantity = self.symbols.items.get(name)
        if isinstance(quantity, QuantityDeclaration):
            return quantity
        return self.symbols.behind_atom(name)

    def relation_names(self) -> list[str]:
        """Names that can be given to a definition for a relation."""
        return [*self.symbols.atoms(), *SIDES, *self.constants.names(), *self.relations]

    def absolute(self, use: tree.AtomUse, name: str) -> str | None:
        """The name with ``near_side_of`` resolved by traffic; None if reported."""
        if name not in SIDES or self.behind(name) is not None:
            return name
        traffic = self.constants.traffic
        if not traffic:
            self.report(atom_messages.no_traffic(use, name))
            return None
        side = SIDES[name][traffic]
        if self.behind(side) is None:
            if not self.symbols.may_know(side):
                self.report(atom_messages.no_sides(use, name, side))
            return None
        return side

    def enumeration(self, use: tree.AtomUse) -> Enumeration | None:
        """The enumeration of that name, which is no atom: its values are."""
        name = use.name.text
        item = self.symbols.items.get(name)
        hidden = name in self.variables or name in self.relations
        return item if isinstance(item, Enumeration) and not hidden else None

    def reference(self, use: tree.AtomUse) -> Atom | QuantityTerm | None:
        """The atom or quantity of a use; None after a reported mistake."""
        name = self.absolute(use, use.name.text)
        if name is None:
            return None
        if self.behind(name) is not None:
            return self._checked(use, name, use.arguments)
        if not use.arguments and "_" in name:
            readings = self._readings(name)
            if len(readings) > 1:
                self.report(atom_messages.two_readings(use, readings))
                return None
            if readings:
                head, variable = readings[0]
                return self._checked(use, head, (tree.Name(variable, span=use.span),))
        if not self.constants.may_know(name) and not self.symbols.may_know(name):
            types = {variable: bound.type for variable, bound in self.variables.items()}
            others = [*self.constants.names(), *self.relations]
            self.report(atom_messages.explain(use, self.symbols, types, others))
        return None

    def _readings(self, name: str) -> list[tuple[str, str]]:
        """The ways to read ``b_v`` as ``b(v)``."""
        result: list[tuple[str, str]] = []
        for position in (at for at, letter in enumerate(name) if letter == "_"):
            head, variable = name[:position], name[position + 1 :]
            item = self.behind(head)
            if item is not None and len(item.parameters) == 1 and variable in self.variables:
                result.append((head, variable))
        return result

    def _checked(
        self, use: tree.AtomUse, name: str, arguments: tuple[tree.Name, ...]
    ) -> Atom | QuantityTerm | None:
        item = self.behind(name)
        assert item is not None, "only called for known names"
        if len(arguments) != len(item.parameters):
            self.used |= {argument.text for argument in arguments}
            self.report(
                atom_messages.wrong_number(use, item, self.symbols, self.variables, name=name)
            )
            return None
        actual = [
            self.object(one, wanted, (item.name, position))
            for position, (one, wanted) in enumerate(zip(arguments, item.parameters, strict=True))
        ]
        names = tuple(one for one in actual if one is not None)
        if len(names) < len(actual):
            return None
        if isinstance(item, QuantityDeclaration):
            return QuantityTerm(item.name, names)
        return Atom(item.name, names, name if isinstance(item, Enumeration) else None)

    def object(
        self,
        argument: tree.Name,
        wanted: str | None,
        parameter: tuple[str, int] | None = None,
        relations: Sequence[str] = (),
    ) -> str | None:
        """The actual name of an argument; None after a reported mistake.

        ``parameter``: which parameter of which declaration asks for it. ``relations``: what could
        be meant besides an object.
        """
        self.used.add(argument.text)
        if isinstance(self.relations.get(argument.text), AnyArgument):
            return argument.text
        variable = self.variables.get(argument.text)
        if variable is None:
            variables = list(self.variables)
            self.report(
                atom_messages.unknown_variable(
                    argument,
                    self.symbols,
                    variables,
                    known=[*variables, *relations],
                    owner="definition" if self.of_definition else "rule",
                )
            )
            return None
        if wanted is None or variable.type is None or self.symbols.fits(variable.type, wanted):
            return variable.actual
        where = None if parameter is None else self.symbols.parameter_spans.get(parameter)
        labels = [Label(variable.span.place, f"`{argument.text}` is declared here")]
        if parameter is not None and where is not None:
            about = f"`{parameter[0]}` is about objects of type `{wanted}`"
            labels.append(Label(where.place, about))
        self.report(atom_messages.wrong_type(argument, variable.type, wanted, labels))
        return None
