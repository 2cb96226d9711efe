"""Overlay of a rulebook on its bases: rules, options and definitions.

Everything here is still as written; meaning comes afterwards, so that an inherited rule uses the
definitions of the rulebook that inherits it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from rulec.diagnostics import Diagnostic, Span
from rulec.rulebook.names.referenced_names import names_in_examples, names_used
from rulec.rulebook.overlay import overlay_messages as say
from rulec.rulebook.rulebook_model import Remark
from rulec.syntax import tree


@dataclass(frozen=True, slots=True)
class RuleEntry:
    """A rule after all overrides.

    ``book`` is the file that it, or its last override, stands in, ``examples_from`` the one that
    its examples stand in. ``changed`` is the name in the last line that changed it.
    """

    item: tree.RuleItem
    book: tree.File
    examples_from: tree.File
    changed: tree.Name | None = None


@dataclass(frozen=True, slots=True)
class Value:
    """Value of a parameter, from file number ``level`` of the chain."""

    item: tree.ParamItem | tree.SetItem
    level: int


@dataclass(slots=True)
class Overlay:
    """The result of a chain of rulebooks, each laid over its base.

    An option, a parameter and a definition never have the same name.
    """

    options: dict[str, bool] = field(default_factory=dict)
    parameters: dict[str, list[Value]] = field(default_factory=dict)
    definitions: dict[str, tree.DefineItem] = field(default_factory=dict)
    rules: dict[str, RuleEntry] = field(default_factory=dict)
    gone: dict[str, tree.Name] = field(default_factory=dict)
    """Where a rule was last dropped or passed over in silence."""
    remarks: list[Remark] = field(default_factory=list)
    declared_at: dict[str, tree.Name] = field(default_factory=dict)
    """Where each option, parameter and definition was first named."""
    levels: dict[str, int] = field(default_factory=dict)
    """The number in the chain of the file that named it first."""
    changed_at: dict[str, tree.Name] = field(default_factory=dict)
    """Where an option or a definition was last ``set`` or redefined."""
    mistakes: list[Diagnostic] = field(default_factory=list)
    unsure: bool = False
    """A rulebook of the chain could not be read whole: names may be missing for that reason."""
    unsure_rules: bool = False
    """The head of a rule could not be read: it may have any name."""
    suspects: set[str] = field(default_factory=set)
    """Names in what could not be read."""

    def kind_of(self, name: str) -> str:
        """``option``, ``parameter``, ``definition``, or empty for any other name."""
        if name in self.options:
            return "option"
        if name in self.parameters:
            return "parameter"
        return "definition" if name in self.definitions else ""


def overlay(chain: Sequence[tree.File], spans: dict[str, Span], *, unsure: bool) -> Overlay:
    """Lay rulebooks over one another, the most general first.

    Args:
        chain: their trees.
        spans: where the names of the vocabularies' and rulebooks' declarations stand.
        unsure: one of them could not be read.
    """
    result = Overlay(unsure=unsure)
    for level, file in enumerate(chain):
        laid = _Layer(result, file, level, spans)
        for item in file.items:
            laid.take(item)
    return result


@dataclass(frozen=True, slots=True)
class _Layer:
    result: Overlay
    file: tree.File
    level: int
    spans: dict[str, Span]

    def take(self, item: tree.Item) -> None:
        """Lay one item over what there is."""
        match item:
            case tree.RuleItem() | tree.ParamItem() | tree.SetItem():
                if item.in_force is not None and never_in_force(item.in_force):
                    self.result.mistakes.append(say.never_in_force(item.in_force))
        match item:
            case tree.RuleItem(override=False):
                self._rule(item)
            case tree.RuleItem():
                self._override(item)
            case tree.OptionItem(name, value):
                if self._new(name, "option"):
                    self.result.options[name.text] = value
            case tree.ParamItem(name):
                known = name.text in self.result.parameters
                again = known and self.result.levels[name.text] == self.level
                if again or self._new(name, "parameter"):
                    values = self.result.parameters.setdefault(name.text, [])
                    values.append(Value(item, self.level))
            case tree.SetItem():
                self._set(item)
            case tree.DefineItem(name, again=False):
                if self._new(name, "definition"):
                    self.result.definitions[name.text] = item
            case tree.DefineItem(name):
                if name.text not in self.result.definitions:
                    self._nothing(name, "definition", "redefine", self.result.definitions)
                elif self._changes(name, "definition", "redefine"):
                    before = self.result.definitions[name.text]
                    if len(item.parameters) != len(before.parameters):
                        self.result.mistakes.append(say.other_parameters(item, before))
                    else:
                        self.result.definitions[name.text] = item
            case tree.DropItem(name, because):
                if self._inherited(name, "drop"):
                    del self.result.rules[name.text]
                    self.result.gone[name.text] = name
                    self.result.remarks.append(Remark(name.text, because.value, "dropped"))
            case tree.SoftenItem():
                self._soften(item)
            case tree.SilentItem(name, because):
                if name.text not in self.result.rules or self._inherited(name, "be silent on"):
                    self.result.rules.pop(name.text, None)
                    self.result.gone[name.text] = name
                self.result.remarks.append(Remark(name.text, because.value, "silent"))
            case tree.BrokenItem(names):
                self.result.suspects |= names
                self.result.unsure_rules |= item.word == "rule"
                self.result.unsure |= item.nameless and item.word != "rule"
            case _:
                return

    def _new(self, name: tree.Name, kind: str) -> bool:
        """Declare a name; return False and report it if taken."""
        first = self.spans.get(name.text)
        known = self.result.declared_at.get(name.text)
        if known is not None:
            inherited = self.result.levels[name.text] < self.level
            mistake = say.inherited_name(name, kind, known) if inherited else None
            self.result.mistakes.append(mistake or say.twice(kind, name, known.span))
            return False
        if first is not None:
            self.result.mistakes.append(say.twice("name", name, first))
            return False
        self.result.declared_at[name.text] = name
        self.result.levels[name.text] = self.level
        return True

    def _set(self, item: tree.SetItem) -> None:
        name = item.name
        if name.text in self.result.options:
            if not isinstance(item.value, bool):
                self.result.mistakes.append(say.option_is_on_or_off(item))
            elif self._changes(name, "option", "set"):
                self.result.options[name.text] = item.value
        elif name.text in self.result.parameters:
            if isinstance(item.value, bool):
                self.result.mistakes.append(say.parameter_is_a_number(item))
            elif self._is_inherited(name, "parameter", "set"):
                self.result.parameters[name.text].append(Value(item, self.level))
        else:
            known = [*self.result.options, *self.result.parameters]
            self._nothing(name, "option or parameter", "set", known)

    def _is_inherited(self, name: tree.Name, kind: str, verb: str) -> bool:
        """Tell whether an option, parameter or definition is inherited; else report."""
        if self.result.levels[name.text] < self.level:
            return True
        known = self.result.declared_at[name.text]
        self.result.mistakes.append(say.own(name, kind, verb, known))
        return False

    def _changes(self, name: tree.Name, kind: str, verb: str) -> bool:
        """Note the first change of an inherited name; report mistakes."""
        if not self._is_inherited(name, kind, verb):
            return False
        before = self.result.changed_at.get(name.text)
        if before is not None and before.span.source is name.span.source:
            self.result.mistakes.append(say.changed_twice(name, kind, before))
            return False
        self.result.changed_at[name.text] = name
        return True

    def _rule(self, item: tree.RuleItem) -> None:
        known = self.result.rules.get(item.name.text)
        if known is None:
            self.result.rules[item.name.text] = RuleEntry(item, self.file, self.file)
        elif known.book is self.file:
            self.result.mistakes.append(say.rule_twice(item, known.item))
        else:
            self.result.mistakes.append(say.inherited_rule(item, known.item))

    def _override(self, item: tree.RuleItem) -> None:
        if self._inherited(item.name, "override"):
            base = self.result.rules[item.name.text]
            after = merged(base.item, item)
            lost = _lost_variables(base.item, item)
            if lost:
                self.result.mistakes.append(say.lost_variables(item, lost))
                variables = (*after.variables, *lost)
                after = replace(after, variables=variables, examples=item.examples, complete=False)
            self.result.rules[item.name.text] = RuleEntry(
                after,
                self.file,
                self.file if item.examples else base.examples_from,
                item.name,
            )

    def _soften(self, item: tree.SoftenItem) -> None:
        if not self._inherited(item.name, "soften"):
            return
        entry = self.result.rules[item.name.text]
        if entry.item.strength == "soft" and item.level is None and item.weight is None:
            self.result.mistakes.append(say.soft_already(item, entry.item))
        softer = replace(
            entry.item,
            strength="soft",
            level=item.level or entry.item.level,
            weight=item.weight or entry.item.weight,
        )
        self.result.rules[item.name.text] = replace(entry, item=softer, changed=item.name)
        because = item.because.value if item.because else ""
        self.result.remarks.append(Remark(item.name.text, because, "softened"))

    def _inherited(self, name: tree.Name, verb: str) -> bool:
        """Tell whether a name is an inherited rule; report anything else."""
        known = self.result.rules.get(name.text)
        before = self.result.gone.get(name.text) if known is None else known.changed
        if before is not None and before.span.source is name.span.source:
            self.result.mistakes.append(say.changed_twice(name, "rule", before))
            return False
        if known is not None and known.book is not self.file:
            return True
        if known is not None:
            self.result.mistakes.append(say.own_rule(name, verb, known.item))
        else:
            self._nothing(name, "rule", verb, self.result.rules)
        return False

    def _nothing(self, name: tree.Name, kind: str, verb: str, known: Iterable[str]) -> None:
        unsure = self.result.unsure or (kind == "rule" and self.result.unsure_rules)
        if unsure or name.text in self.result.suspects:
            return
        base = self.file.extends
        extends = None if base is None else base.name.text
        self.result.mistakes.append(say.nothing_to(verb, kind, name, list(known), extends))


def never_in_force(dates: tree.InForce | None) -> bool:
    """Tell whether the dates end before they begin."""
    return dates is not None and bool(dates.until) and dates.until < dates.since


def _lost_variables(base: tree.RuleItem, over: tree.RuleItem) -> list[tree.Parameter]:
    """Variables that an override omits although inherited clauses use them."""
    if not over.variables:
        return []
    inherited = replace(
        base,
        require=None if over.require else base.require,
        when=None if over.when else base.when,
        unless=() if over.unless else base.unless,
        examples=() if over.examples else base.examples,
    )
    spoken_of = {*names_used(inherited), *names_in_examples(inherited)}
    kept = {variable.name.text for variable in over.variables}
    return [
        variable
        for variable in base.variables
        if variable.name.text not in kept
        and any(
            name == variable.name.text or name.endswith(f"_{variable.name.text}")
            for name in spoken_of
        )
    ]


def merged(base: tree.RuleItem, over: tree.RuleItem) -> tree.RuleItem:
    """A rule with the clauses that an override gives it replaced.

    Where a provision was read, and how sure that is, goes with the provision.
    """
    read = replace(base, source=None, certainty="") if over.cite else base
    return replace(
        base,
        strength=over.strength or base.strength,
        name=over.name,
        variables=over.variables or base.variables,
        require=over.require or base.require,
        cite=over.cite or base.cite,
        says=over.says or base.says,
        examples=over.examples or base.examples,
        complete=over.complete and base.complete,
        span=over.span,
        level=over.level or base.level,
        weight=over.weight or base.weight,
        unless=over.unless or base.unless,
        when=over.when or base.when,
        source=over.source or read.source,
        certainty=over.certainty or read.certainty,
        in_force=over.in_force or base.in_force,
    )
