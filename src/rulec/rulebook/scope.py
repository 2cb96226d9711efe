"""What a rule's formula and examples can refer to, and atoms looked up in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.diagnostics import Diagnostic, Label, Span, did_you_mean, named
from rulec.logic.formula import Atom
from rulec.rulebook import atom_messages
from rulec.rulebook.declared import Declared
from rulec.syntax import tree
from rulec.vocabulary import Enumeration, Signal


@dataclass(frozen=True, slots=True)
class BoundVariable:
    """A rule's variable: its type, None if that is not known, and its place."""

    type: str | None
    span: Span


@dataclass(slots=True)
class Scope:
    """One rule's view: the declarations and the rule's variables."""

    declared: Declared
    variables: dict[str, BoundVariable]
    mistakes: list[Diagnostic]
    used: set[str] = field(default_factory=set)

    def atom(self, use: tree.AtomUse) -> Atom | None:
        """The atom meant; None when that is not known, which is then reported."""
        name = use.name.text
        if self.declared.behind_atom(name) is not None:
            return self._checked(use, name, use.arguments)
        if not use.arguments and "_" in name:
            readings = self._readings(name)
            if len(readings) > 1:
                self.mistakes.append(atom_messages.two_readings(use, readings))
                return None
            if readings:
                head, variable = readings[0]
                return self._checked(use, head, (tree.Name(variable, use.span),))
        if not self.declared.may_know(name):
            self.mistakes.append(atom_messages.explain(use, self.declared, list(self.variables)))
        return None

    def _readings(self, name: str) -> list[tuple[str, str]]:
        """The ways to read ``b_v`` as ``b(v)``."""
        found: list[tuple[str, str]] = []
        for position in (at for at, letter in enumerate(name) if letter == "_"):
            head, variable = name[:position], name[position + 1 :]
            item = self.declared.behind_atom(head)
            if item is not None and len(item.parameters) == 1 and variable in self.variables:
                found.append((head, variable))
        return found

    def _checked(
        self, use: tree.AtomUse, name: str, arguments: tuple[tree.Name, ...]
    ) -> Atom | None:
        item = self.declared.behind_atom(name)
        assert item is not None, "only called for known names"
        self.used |= {one.text for one in arguments}
        if len(arguments) != len(item.parameters):
            self.mistakes.append(
                atom_messages.wrong_number(use, name, item, self.declared, list(self.variables))
            )
            return None
        fine = [
            self._fits(one, wanted, item, position)
            for position, (one, wanted) in enumerate(zip(arguments, item.parameters, strict=True))
        ]
        if not all(fine):
            return None
        value = name if isinstance(item, Enumeration) else None
        return Atom(item.name, tuple(one.text for one in arguments), value)

    def _fits(
        self, argument: tree.Name, wanted: str, item: Signal | Enumeration, position: int
    ) -> bool:
        variable = self.variables.get(argument.text)
        if variable is None:
            self.mistakes.append(_unknown_variable(argument, list(self.variables)))
            return False
        if variable.type is None or self.declared.fits(variable.type, wanted):
            return True
        parameter = self.declared.parameter_spans[item.name, position]
        self.mistakes.append(_wrong_type(argument, variable, wanted, item.name, parameter))
        return False


def _unknown_variable(name: tree.Name, known: list[str]) -> Diagnostic:
    if known:
        way_out = f"the rule's variables are {named(known)}"
    else:
        way_out = f"declare it behind the rule's name, such as `({name.text}: vehicle)`"
    return Diagnostic(
        "R0203",
        f"the rule has no variable `{name.text}`",
        name.span.place,
        expected="expected a variable of the rule",
        help=did_you_mean(name.text, known) or way_out,
    )


def _wrong_type(
    argument: tree.Name, variable: BoundVariable, wanted: str, item: str, parameter: Span
) -> Diagnostic:
    return Diagnostic(
        "R0302",
        f"`{argument.text}` is of type `{variable.type}`, which is no `{wanted}`",
        argument.span.place,
        expected=f"expected a variable of type `{wanted}`",
        help=f"declare it as `{argument.text}: {wanted}`, or use another variable",
        labels=(
            Label(variable.span.place, f"`{argument.text}` is declared here"),
            Label(parameter.place, f"`{item}` is about objects of type `{wanted}`"),
        ),
    )
