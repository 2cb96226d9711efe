"""Applies a rulebook to its bases: rules, options and definitions.

Everything here is still as written and is resolved afterwards, so that an inherited rule uses the
definitions of the rulebook that inherits it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from rulec.diagnostics import Diagnostic, Span
from rulec.rulebook.names.declaration_messages import twice
from rulec.rulebook.overlay import overlay_messages as say
from rulec.rulebook.overlay import topic_messages as topics
from rulec.rulebook.overlay.rule_override import (
    changed_types,
    lost_exceptions,
    lost_variables,
    merged,
    softened,
)
from rulec.rulebook.rulebook_model import Remark
from rulec.syntax import tree


@dataclass(frozen=True, slots=True)
class RuleEntry:
    """A rule after all overrides.

    ``book`` is the file with the rule or its last override, ``examples_from`` the one with its
    examples, and ``law`` the one whose law it is: which last declared it, confirmed it or gave it
    another provision. ``changed`` is the name in the last line that changed it.
    """

    item: tree.RuleItem
    book: tree.File
    examples_from: tree.File
    law: tree.File
    changed: tree.Name | None = None


@dataclass(frozen=True, slots=True)
class Value:
    """A value of a parameter, from file number ``level`` of the chain."""

    item: tree.ParamItem | tree.SetItem
    level: int


@dataclass(slots=True)
class Overlay:
    """A chain of rulebooks, each applied to its base; filled by ``overlay``.

    Options, parameters and definitions all have different names.
    """

    spans: Mapping[str, Span] = field(default_factory=dict)
    """The places of the names in the declarations of vocabularies and rulebooks."""
    options: dict[str, bool] = field(default_factory=dict)
    parameters: dict[str, list[Value]] = field(default_factory=dict)
    definitions: dict[str, tree.DefineItem] = field(default_factory=dict)
    meanings: dict[str, tree.DefineItem] = field(default_factory=dict)
    """The definitions of declared words."""
    rules: dict[str, RuleEntry] = field(default_factory=dict)
    gone: dict[str, tree.Name] = field(default_factory=dict)
    """Where a rule was last dropped or declared silent."""
    remarks: list[Remark] = field(default_factory=list)
    declared_at: dict[str, tree.Name] = field(default_factory=dict)
    """Where each option, parameter and definition was first declared."""
    changed_at: dict[str, tree.Name] = field(default_factory=dict)
    """Where an option or definition was last ``set`` or redefined."""
    mistakes: list[Diagnostic] = field(default_factory=list)
    topics: dict[str, tree.TopicEntry] = field(default_factory=dict)
    provisions: list[tuple[tree.File, tree.ProvisionsItem]] = field(default_factory=list)
    """The lists of articles, each with its rulebook."""
    unsure: bool = False
    """Whether a rulebook of the chain was partly unreadable, so that names may be missing."""
    unsure_rules: bool = False
    """Whether the head of some rule could not be read, so that it may have any name."""
    suspects: set[str] = field(default_factory=set)
    """The names in unreadable text."""

    def kind_of(self, name: str) -> str:
        """``option``, ``parameter``, ``definition``, or empty for any other name."""
        if name in self.options:
            return "option"
        if name in self.parameters:
            return "parameter"
        return "definition" if name in self.definitions else ""

    def lay(self, item: tree.Item, file: tree.File, level: int) -> None:
        """Apply an item of a file, ``level`` files above the most general one, to the others."""
        dates: tree.InForce | None = getattr(item, "in_force", None)
        if dates is not None and never_in_force(dates):
            self.mistakes.append(say.never_in_force(dates))
        match item:
            case tree.RuleItem(override=True):
                self._override(item, file)
            case tree.RuleItem(name=name):
                self.mistakes += map(
                    say.nothing_to_add_to, (unless for unless in item.unless if unless.also)
                )
                known = self.rules.get(name.text)
                if known is None:
                    self.rules[name.text] = RuleEntry(item, file, file, file)
                else:
                    message = say.rule_twice if known.book is file else say.inherited_rule
                    self.mistakes.append(message(item, known.item))
            case tree.OptionItem(name, value):
                if self._is_new(name, "option"):
                    self.options[name.text] = value
            case tree.ParamItem(name):
                again = name.text in self.parameters and self._is_own(name)
                if again or self._is_new(name, "parameter"):
                    self.parameters.setdefault(name.text, []).append(Value(item, level))
            case tree.SetItem():
                self._set(item, file, level)
            case tree.DefineItem(name):
                is_declared = name.text in self.spans
                self._define(item, self.meanings if is_declared else self.definitions, file)
            case tree.DropItem(name, because):
                if self._is_inherited_rule(name, "drop", file):
                    del self.rules[name.text]
                    self.gone[name.text] = name
                    self.remarks.append(Remark(name.text, because.value, "dropped", _name(file)))
            case tree.SoftenItem(name):
                if self._is_inherited_rule(name, "soften", file):
                    self._soften(item, file)
            case tree.SilentItem(name, because):
                unknown = name.text not in self.rules
                if unknown or self._is_inherited_rule(name, "be silent on", file):
                    self.rules.pop(name.text, None)
                    self.gone[name.text] = name
                self.remarks.append(Remark(name.text, because.value, "silent", _name(file)))
            case tree.TopicsItem(entries):
                for entry in entries:
                    self._add_topic(entry)
            case tree.ProvisionsItem():
                self._add_provisions(item, file)
            case tree.BrokenItem(names):
                self.suspects |= names
                self.unsure_rules |= item.word == "rule"
                self.unsure |= item.nameless and item.word != "rule"

    def _define(
        self, item: tree.DefineItem, known: dict[str, tree.DefineItem], file: tree.File
    ) -> None:
        name = item.name
        if not item.again:
            if self._is_new(name, "definition"):
                known[name.text] = item
        elif name.text not in known:
            inherited = self._inherited([*self.definitions, *self.meanings], name)
            self._nothing(name, "definition", "redefine", inherited, file)
        elif self._changes(name, "definition", "redefine"):
            if len(item.parameters) != len(known[name.text].parameters):
                self.mistakes.append(say.other_parameters(item, known[name.text]))
            else:
                known[name.text] = item

    def _is_new(self, name: tree.Name, kind: str) -> bool:
        if name.text in self.declared_at:
            known = self.declared_at[name.text]
            if self._is_own(name):
                self.mistakes.append(twice(kind, name, known.span))
            else:
                self.mistakes.append(say.inherited_name(name, kind, known))
            return False
        if kind != "definition" and name.text in self.spans:
            self.mistakes.append(twice("name", name, self.spans[name.text]))
            return False
        self.declared_at[name.text] = name
        return True

    def _is_own(self, name: tree.Name) -> bool:
        """Whether the file that uses a name has also declared it."""
        return self.declared_at[name.text].span.source is name.span.source

    def _inherited(self, names: Iterable[str], user: tree.Name) -> list[str]:
        """The options, parameters or definitions that are not from the user's own file."""
        source = user.span.source
        return [name for name in names if self.declared_at[name].span.source is not source]

    def _add_topic(self, entry: tree.TopicEntry) -> None:
        known = self.topics.setdefault(entry.name.text, entry)
        if known is not entry:
            self.mistakes.append(twice("topic", entry.name, known.name.span))

    def _add_provisions(self, item: tree.ProvisionsItem, file: tree.File) -> None:
        """Add a list of articles; a rulebook may have only one."""
        first = {
            entry.number.value: entry.number
            for book, earlier in self.provisions
            for entry in earlier.entries
            if book is file
        }
        for entry in item.entries:
            known = first.setdefault(entry.number.value, entry.number)
            if known is not entry.number:
                self.mistakes.append(topics.article_twice(entry.number, known))
        self.provisions.append((file, item))

    def topics_of(self, rule: tree.RuleItem) -> tuple[str, ...]:
        """The topics of a rule: those that it names, else those that list it.

        A topic also lists rules by the beginning of their names; the longest match decides.
        """
        if not rule.topics:
            named = [
                (len(name.text), topic)
                for topic, entry in self.topics.items()
                for name in entry.rules
                if f"{rule.name.text}_".startswith(f"{name.text}_")
            ]
            longest = max((length for length, _ in named), default=0)
            return tuple(topic for length, topic in named if length == longest)
        return tuple(name.text for name in rule.topics)

    def wrong_topics(self, rule: tree.RuleItem) -> Iterator[Diagnostic]:
        """Undeclared topics of a rule, except those that unreadable text may declare."""
        known = self.topics.keys() | self.suspects
        for name in () if self.unsure else rule.topics:
            if name.text not in known:
                of_rule = self.topics_of(replace(rule, name=name, topics=()))
                yield topics.no_topic(name, list(self.topics), of_rule)

    def _set(self, item: tree.SetItem, file: tree.File, level: int) -> None:
        name, known = item.name, [*self.options, *self.parameters]
        if name.text not in known:
            inherited = self._inherited(known, name)
            self._nothing(name, "option or parameter", "set", inherited, file)
        elif isinstance(item.value, bool) != (name.text in self.options):
            self.mistakes.append(say.value_of_another_kind(item))
        elif not isinstance(item.value, bool):
            if self._is_inherited(name, "parameter", "set"):
                self.parameters[name.text].append(Value(item, level))
        elif self._changes(name, "option", "set"):
            self.options[name.text] = item.value

    def _is_inherited(self, name: tree.Name, kind: str, verb: str) -> bool:
        """Whether an option, parameter or definition is inherited; if not, report it."""
        own = self._is_own(name)
        if own:
            self.mistakes.append(say.not_inherited(name, kind, verb, self.declared_at[name.text]))
        return not own

    def _changes(self, name: tree.Name, kind: str, verb: str) -> bool:
        """Record the first change of an inherited name; report mistakes."""
        if not self._is_inherited(name, kind, verb):
            return False
        before = self.changed_at.get(name.text)
        if before is not None and before.span.source is name.span.source:
            self.mistakes.append(say.changed_twice(name, kind, before))
            return False
        self.changed_at[name.text] = name
        return True

    def _override(self, item: tree.RuleItem, file: tree.File) -> None:
        if not self._is_inherited_rule(item.name, "confirm" if item.confirm else "override", file):
            return
        base = self.rules[item.name.text]
        after = merged(base.item, item)
        if after == base.item and item.cite is None and not item.confirm:
            self.mistakes.append(say.idle_override(item))
        gone = lost_exceptions(base.item, item)
        # Who says in words what the rule is now has said what its exceptions are.
        if gone and item.says is None and not item.confirm:
            self.mistakes.append(say.lost_exceptions(item, gone))
        changed = changed_types(base.item, item)
        if changed:
            self.mistakes.append(say.other_types(item, changed))
        lost = lost_variables(base.item, item)
        if lost:
            self.mistakes.append(say.lost_variables(item, lost))
            variables = (*after.variables, *lost)
            after = replace(after, variables=variables, examples=item.examples, complete=False)
        examples_from = file if item.examples else base.examples_from
        law = file if item.cite else base.law
        self.rules[item.name.text] = RuleEntry(after, file, examples_from, law, item.name)

    def _soften(self, item: tree.SoftenItem, file: tree.File) -> None:
        entry = self.rules[item.name.text]
        if entry.item.strength == "soft" and item.level is None and item.weight is None:
            self.mistakes.append(say.soft_already(item, entry.item))
        softer = softened(entry.item, item)
        self.rules[item.name.text] = replace(entry, item=softer, changed=item.name)
        because = item.because.value if item.because else ""
        self.remarks.append(Remark(item.name.text, because, "softened", _name(file)))

    def _is_inherited_rule(self, name: tree.Name, verb: str, file: tree.File) -> bool:
        """Whether a name is an inherited rule; if not, report it."""
        known = self.rules.get(name.text)
        before = self.gone.get(name.text) if known is None else known.changed
        if before is not None and before.span.source is name.span.source:
            self.mistakes.append(say.changed_twice(name, "rule", before))
        elif known is None and before is not None:
            remark = next(one for one in reversed(self.remarks) if one.name == name.text)
            self.mistakes.append(say.gone_before(name, verb, remark, before))
        elif known is None:
            entries = self.rules.items()
            inherited = [value for value, by in entries if by.changed or by.book is not file]
            self._nothing(name, "rule", verb, inherited, file)
        elif known.book is file:
            self.mistakes.append(say.not_inherited(name, "rule", verb, known.item.name))
        else:
            return True
        return False

    def _nothing(
        self, name: tree.Name, kind: str, verb: str, known: Iterable[str], file: tree.File
    ) -> None:
        unsure = self.unsure or (kind == "rule" and self.unsure_rules)
        if not unsure and name.text not in self.suspects:
            extends = file.extends.name.text if file.extends else None
            self.mistakes.append(say.nothing_to(verb, kind, name, list(known), extends))


def overlay(chain: Sequence[tree.File], spans: Mapping[str, Span], *, unsure: bool) -> Overlay:
    """Apply rulebooks to one another, the most general first.

    ``spans`` are the places of declared names; ``unsure``: a file could not be read.
    """
    laid = Overlay(spans, unsure=unsure)
    for level, file in enumerate(chain):
        for item in file.items:
            laid.lay(item, file, level)
    return laid


def own_law(chain: Sequence[tree.File]) -> Sequence[tree.File]:
    """The rulebooks at the end of a chain that form its own law: from the last that names a law on.

    A rulebook that extends another without naming a law, as a variant or a depot's book does,
    belongs to the same law. If none names a law, only the last one is returned.
    """
    named = [number for number, file in enumerate(chain) if file.law and file.law.text.value]
    return chain[named[-1] if named else -1 :]


def law_line(chain: Sequence[tree.File]) -> tree.LawLine | None:
    """The line of the law that the last rulebook of a chain is: its own or its nearest base's."""
    return own_law(chain)[0].law


def in_force(dates: tree.InForce | None, day: str) -> bool:
    """Whether a day (ISO) lies within dates, the last one included."""
    if dates is None:
        return True
    return dates.since <= day and (not dates.until or day <= dates.until)


def never_in_force(dates: tree.InForce | None) -> bool:
    """Whether the dates end before they begin."""
    return dates is not None and bool(dates.until) and dates.until < dates.since


def _name(file: tree.File) -> str:
    return "" if file.name is None else file.name.text
