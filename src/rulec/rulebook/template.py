"""A rulebook to start from: on its own, or extending another one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.loader import Loaded, parse_rulebook, read_rulebook
from rulec.rulebook.names.doc_comments import description
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.rulebook.rulebook_model import Rule
from rulec.rulebook.template_messages import no_name
from rulec.syntax import decode, parse, tree
from rulec.syntax.tree_printer import print_formula

_TEXT = """\
# {name}: a rulebook to start from. `rulec check` says what is wrong in it, `rulec test` runs its
# examples, `rulec list` shows the vocabularies whose words rules can use.

rulebook {name}
title   "What this rulebook is about"
law     "The law that it puts into rules" as of {today}
traffic right  # the near side, that of the kerb, is the right one
use     road   # station, lateral, surface, congested; and types such as vehicle and pedestrian

# A hard rule must never be violated, a soft rule may yield. It holds for every vehicle v.
hard rule overtake_on_the_far_side (v: vehicle) {{
  cite    "Article 1"
  says    "Do not overtake on the side of the kerb."
  require never (behind(v) then beside(v) and near_side_of(v) then in_front_of(v))
  unless  congested throughout

  # What the rule allows and what it forbids, state by state; what is not said has its default.
  accept "on the far side" {{
    behind(v) and same_lane(v);
    beside(v) and far_side_of(v);
    in_front_of(v) and same_lane(v)
  }}
  accept "in a queue" {{
    behind(v) and near_side_of(v);
    congested and beside(v) and near_side_of(v);
    in_front_of(v) and near_side_of(v)
  }}
  reject "on the near side" {{
    behind(v) and same_lane(v);
    beside(v) and near_side_of(v);
    in_front_of(v) and same_lane(v)
  }}
}}
"""

_UPON = """\
# {name}: a rulebook that builds upon `{base}`. Take the # off the lines that you need.
# `rulec check` says what is wrong in it, `rulec test` runs the examples, the inherited ones too.

rulebook {name}
extends {base}
title   "What this rulebook is about"
law     "The law that it puts into rules" as of {today}
"""


def new_rulebook(name: str, today: date) -> str:
    """Text of a new rulebook that checks, tests and compiles.

    Raises RulecError R0738 if a rulebook cannot have this name.
    """
    _refuse(name)
    text = _TEXT.format(name=name, today=today.isoformat())
    parse_rulebook(text, f"{name}.rules")
    return text


def new_rulebook_upon(name: str, base: str, today: date, search_path: Sequence[Path] = ()) -> str:
    """The text of a new rulebook that extends another one, with possible changes as comments.

    Raises RulecError if a rulebook cannot have this name (R0738), or if the base cannot be read.
    """
    _refuse(name)
    inherited = read_rulebook(base, search_path)
    head = _UPON.format(name=name, base=base, today=today.isoformat())
    text = "\n".join([head, *_changes(inherited)])
    parse_rulebook(text, f"{name}.rules", search_path)
    return text


def _refuse(name: str) -> None:
    """Raise RulecError R0738 if this is no name of a rulebook."""
    try:
        source = decode(name, f"rulebook {name}\n{_ANY}".encode("utf-8", "replace"))
        if parse(source)[1]:
            raise no_name(name)
    except RulecError:
        raise no_name(name) from None


_ANY = "signal p\nhard rule r { require p }\n"


def _changes(loaded: Loaded) -> Iterator[str]:
    base = loaded.rulebook
    if base.traffic:
        other = "left" if base.traffic == "right" else "right"
        yield f"# traffic {other}   # belongs into the header; `{base.name}` says {base.traffic}"
        yield ""
    settings = _settings(loaded)
    if settings:
        yield from (*settings, "")
    for rule in base.rules:
        yield from _rule(rule)
    yield '# silent on TOPIC because "…"'
    yield ""


def _settings(loaded: Loaded) -> list[str]:
    values: dict[str, str] = {}
    notes: dict[str, str] = {}
    for item in (item for book in loaded.books for item in book.items):
        match item:
            case tree.OptionItem(name, value) | tree.SetItem(name, bool() as value):
                text = "on" if value else "off"
            case tree.ParamItem() | tree.SetItem():
                if not in_force(item.in_force, loaded.rulebook.at):
                    continue
                assert not isinstance(item.value, bool), "that is an option's"
                name, text = item.name, print_formula(item.value, "written")
            case _:
                continue
        values[name.text] = text
        notes[name.text] = description(item.span) or notes.get(name.text, "")
    comments = {name: f"  # {note}" if note else "" for name, note in notes.items()}
    return [f"# set {name} = {value}{comments[name]}" for name, value in values.items()]


def _rule(rule: Rule) -> Iterator[str]:
    about = ", ".join(f"{variable.name}: {variable.type}" for variable in rule.variables)
    if rule.says or rule.cite:
        yield f"# {' '.join(filter(None, (rule.cite, rule.says)))}"
    head = f"{rule.name} ({about})" if about else rule.name
    yield f'# override rule {head} {{ cite "…" }}'
    yield f'# drop rule {rule.name} because "…"'
    if rule.strength == "hard":
        yield f'# soften rule {rule.name} because "…"'
    yield ""
