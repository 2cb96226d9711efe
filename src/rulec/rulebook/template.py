"""A rulebook to start from."""

from __future__ import annotations

from datetime import date

from rulec.rulebook.loader import parse_rulebook

_TEXT = """\
# {name}: a rulebook to start from. `rulec check` says what is wrong in it, `rulec test` runs its
# examples, `rulec list` shows the vocabularies whose words rules can use.

rulebook {name}
title "What this rulebook is about"
law   "The law that it puts into rules" as of {today}
use   road  # station, lateral, surface, congested; and types such as vehicle and pedestrian

# A hard rule must never be violated, a soft rule may yield. It holds for every vehicle v.
hard rule overtake_on_the_left (v: vehicle) {{
  cite    "Article 1"
  says    "Do not overtake on the right."
  require congested or never (behind(v) then beside(v) and right_of(v) then in_front_of(v))

  # What the rule allows and what it forbids, state by state; what is not said has its default.
  accept "on the left" {{
    behind(v) and same_lane(v);
    beside(v) and left_of(v);
    in_front_of(v) and same_lane(v)
  }}
  accept "in a queue" {{
    congested and behind(v) and right_of(v);
    beside(v) and right_of(v);
    in_front_of(v) and right_of(v)
  }}
  reject "on the right" {{
    behind(v) and same_lane(v);
    beside(v) and right_of(v);
    in_front_of(v) and same_lane(v)
  }}
}}
"""


def new_rulebook(name: str, today: date) -> str:
    """The text of a rulebook that checks, tests and compiles, to be changed.

    Raises:
        RulecError: if a rulebook cannot have this name, at its place in the text.
    """
    text = _TEXT.format(name=name, today=today.isoformat())
    parse_rulebook(text, f"{name}.rules")
    return text
