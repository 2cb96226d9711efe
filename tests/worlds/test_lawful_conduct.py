"""In the stored worlds nobody is accused of what the simulator's drivers do not do.

They brake for a reason, keep to their side and to lights, set off from nowhere but their lane, and
none of them drives backwards.
"""

from collections import Counter

import pytest

import rulec
from rulec.extraction.selection import RequestedDrives
from rulec.rulebook.loader import parse_rulebook
from support.worlds.stored import StoredWorld

NEVER = {
    "needless_braking": "brakes_needlessly",
    "stopping": "stands_needlessly",
    "too_slow": "impedes_traffic",
    "wrong_way": "drives_against_traffic",
    "reversing": "reversing",
    "turning_round": "u_turn",
    "setting_off": "joins_road",
    "amber_light": "drives_at_amber",
}
MOST_OPEN = 1 / 6
"""Some who brake as they join, or one who sets off late, may have had a reason or none."""

RULES = [f"hard rule {name} {{ require never {what} }}" for name, what in NEVER.items()]
RULES.append("hard rule turning (u: road_user) { require never turns_in_way_of(u) }")
BOOK = "\n".join(["rulebook conduct", "extends schemas", "traffic right", *RULES])


@pytest.fixture(scope="module")
def machines():
    return rulec.compile_rulebook(parse_rulebook(BOOK), step_s=0.2)


@pytest.mark.parametrize("name", ["motorway", "grid", "all_way_stop"])
def test_nobody_is_accused(name, machines):
    world = StoredWorld(name)
    found = rulec.verify_recording(world.data, machines, RequestedDrives(), world.net)
    answers = [one.answer for one in found.answers() if hasattr(one, "drive")]
    assert len(answers) >= 12
    assert [violation for one in answers for violation in one.violations] == []
    # And not because nothing was known
    rules = Counter(rule.rule for one in answers for rule in (*one.open, *one.not_judged))
    assert rules.keys() <= {"too_slow", "amber_light", "needless_braking", "stopping"}
    assert max(rules["needless_braking"], rules["stopping"]) <= MOST_OPEN * len(answers)
