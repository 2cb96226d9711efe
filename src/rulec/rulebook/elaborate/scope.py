"""Scopes: the symbols that a formula can refer to, and their lookup."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Literal

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.logic.formula import Atom, QuantityTerm
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.arithmetic.size_limits import OverLimitError
from rulec.rulebook.elaborate.rule_messages import over_limit, unused_variable
from rulec.rulebook.names import atom_messages, side_messages
from rulec.rulebook.names.declaration_messages import twice
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.syntax import tree
from rulec.vocabulary import Enumeration, Quantity, Signal

SIDES = {"near_side_of": {"right": "right_of", "left": "left_of"}}
SIDES["far_side_of"] = {"right": "left_of", "left": "right_of"}
"""Maps a relation and the side of traffic to the absolute side."""


@dataclass(frozen=True, slots=True)
class BoundVariable:
    """A bound variable: its type, None if unknown, and its place.

    ``actual`` is its name in the rule; inside a definition it is the argument's name.
    """

    type: str | None
    span: Span
    actual: str


@dataclass(frozen=True, slots=True)
class AnyArgument:
    """An object or relation that is unknown while a definition is checked by itself."""


@dataclass(frozen=True, slots=True)
class Call:
    """An expansion of a definition, used at ``span``, or an evaluation of a parameter."""

    name: str
    span: Span | None


@dataclass(slots=True)
class Scope:
    """What one rule or definition can refer to: the declarations, constants and its variables.

    ``relations`` are the parameters of a definition that stand for relations, and ``given`` is
    where the rule has written what they stand for. ``calls`` are the definitions being expanded,
    outermost first. ``in_moment``: the formula is about a single state, as in a count and in a
    parameter. ``counted`` are the variables (actual names) of the
    surrounding counts, ``taken`` all actual names in use.
    """

    symbols: SymbolTable
    constants: ConstantsAndMacros
    variables: dict[str, BoundVariable]
    mistakes: list[Diagnostic]
    used: set[str] = field(default_factory=set)
    relations: dict[str, str | AnyArgument] = field(default_factory=dict)
    given: dict[str, Span] = field(default_factory=dict)
    calls: tuple[Call, ...] = ()
    counted: frozenset[str] = frozenset()
    taken: frozenset[str] = frozenset()
    in_moment: bool = False
    owner: Literal["rule", "definition", "example"] = "rule"
    blamed: set[int] = field(default_factory=set)
    """Where uses of definitions begin that have been found to be wrong."""

    def report(self, mistake: Diagnostic) -> None:
        """Record a mistake, with the uses of definitions that led to it.

        Definitions are also checked by themselves. If one is merely used wrongly, one mistake is
        reported for that use.
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

    def report_wrong_arity(self, use: tree.AtomUse, mistake: Diagnostic) -> None:
        """Record that a relation is about another number of objects than ``use`` gives it.

        If it was given to the definition that uses it, that is where to mend it, and not in the
        definition, which may be right for others.
        """
        # As written: the name itself has been replaced by what the parameter stands for
        given = self.given.get(use.name.span.text)
        if given is not None:
            mistake = atom_messages.wrong_arity_of_argument(mistake, use, given)
        self.report(mistake)

    @contextmanager
    def within_limits(self, part: str, name: tree.Name) -> Iterator[None]:
        """Elaborate a whole expression, and report it if it is too deep or too large."""
        self.constants.begin()
        try:
            yield
        except OverLimitError as error:
            self.report(over_limit(error.limit, part, name))

    def unused(
        self, variables: Iterable[tree.Parameter], owner: tree.RuleItem | tree.DefineItem
    ) -> Iterator[Diagnostic]:
        """Warnings for the variables of ``owner`` that its formula does not use."""
        for variable in variables:
            if variable.name.text not in self.used:
                yield unused_variable(variable, owner)

    def behind(self, name: str) -> Signal | Enumeration | Quantity | None:
        """The signal, the quantity, or the enumeration with such a value."""
        quantity = self.symbols.items.get(name)
        if isinstance(quantity, Quantity):
            return quantity
        return self.symbols.behind_atom(name)

    def relation_names(self) -> list[str]:
        """The names that can be given to a definition for a relation."""
        return [*self.symbols.atoms(), *SIDES, *self.constants.names(), *self.relations]

    def _absolute(self, use: tree.AtomUse) -> str | None:
        """The name with ``near_side_of`` resolved by the side of traffic; None if reported."""
        name = use.name.text
        if name not in SIDES or self.behind(name) is not None:
            return name
        traffic = self.constants.traffic
        if not traffic:
            self.report(side_messages.no_traffic(use, name))
            return None
        side = SIDES[name][traffic]
        if self.behind(side) is None:
            if not self.symbols.may_know(side):
                self.report(side_messages.no_sides(use, name, side))
            return None
        return side

    def enumeration(self, use: tree.AtomUse) -> Enumeration | None:
        """The enumeration of that name, which is not an atom, as only its values are."""
        item = self.symbols.items.get(use.name.text)
        hidden = use.name.text in {*self.variables, *self.relations}
        return item if isinstance(item, Enumeration) and not hidden else None

    def reference(self, use: tree.AtomUse) -> Atom | QuantityTerm | None:
        """The atom or quantity of a use; None after a reported mistake."""
        name = self._absolute(use)
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
        cuts = (at for at, letter in enumerate(name) if letter == "_")
        pairs = ((name[:at], name[at + 1 :], self.behind(name[:at])) for at in cuts)
        return [
            (head, variable)
            for head, variable, item in pairs
            if item is not None and len(item.parameters) == 1 and variable in self.variables
        ]

    def _checked(
        self, use: tree.AtomUse, name: str, arguments: tuple[tree.Name, ...]
    ) -> Atom | QuantityTerm | None:
        item = self.behind(name)
        assert item is not None, "only called for known names"
        if len(arguments) != len(item.parameters):
            self.used |= {argument.text for argument in arguments}
            variables = list(self.variables)
            mistake = atom_messages.wrong_number(use, name, item, self.symbols, variables)
            self.report_wrong_arity(use, mistake)
            return None
        actual = [
            self.object(argument, type_, (item.name, index))
            for index, (argument, type_) in enumerate(zip(arguments, item.parameters, strict=True))
        ]
        names = tuple(name for name in actual if name is not None)
        if len(names) < len(actual):
            return None
        if isinstance(item, Quantity):
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

        It is the argument for ``parameter`` of a declaration; one of ``relations`` could be meant
        instead.
        """
        self.used.add(argument.text)
        if isinstance(self.relations.get(argument.text), AnyArgument):
            return argument.text
        variable = self.variables.get(argument.text)
        if variable is None:
            variables = list(self.variables)
            self.report(
                atom_messages.unknown_variable(
                    argument, self.symbols, variables, relations, owner=self.owner, wanted=wanted
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


Evaluate = Callable[[tree.Formula, Scope], NumberByCases | None]
"""A function that elaborates a number."""


def bound_variables(
    parameters: Iterable[tree.Parameter],
    symbols: SymbolTable,
    report: Callable[[Diagnostic], object],
) -> dict[str, BoundVariable]:
    """The variables of a rule or a definition, with their types."""
    variables: dict[str, BoundVariable] = {}
    for parameter in parameters:
        name = parameter.name
        assert parameter.type is not None, "the grammar asks for a variable's type"
        kind = symbols.known_type(parameter.type, report)
        if name.text in variables:
            report(twice("variable", name, variables[name.text].span))
        else:
            variables[name.text] = BoundVariable(kind, parameter.span, name.text)
    return variables
