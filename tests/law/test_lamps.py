"""What only lamps decide is not judged where no lamps are recorded."""

import pytest

from rulec.monitoring.uncertainty.judged_rules import judged_rules
from support.builders.national_books import NATIONAL, compiled


@pytest.mark.parametrize("name", NATIONAL)
def test_whoever_shows_something_could_have_kept_the_rules_on_indicators(name):
    rulebook = compiled(name)
    told = frozenset(rulebook.vocabulary.declarations) - {"indicator"}
    judged = judged_rules(rulebook, told, cut=False)
    without = {one.rule for one in judged.unknowable if "indicator" in one.untold}
    about = {rule.name for rule in rulebook.rules if rule.name.startswith("indicator_")}
    assert about
    assert about <= without
