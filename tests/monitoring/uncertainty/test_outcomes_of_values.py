"""How an open verdict comes out if the values that are not known are always the same."""

import pytest

import rulec
from rulec import UNKNOWN, Trace

HEAD = "rulebook small\nsignal p, q\nlight is one of red, amber, green\n"


def open_verdicts(requires, states):
    rules = rulec.compile_rulebook(
        rulec.parse_rulebook(f"{HEAD}hard rule r {{ require {requires} }}")
    )
    given = Trace("t", 1, {}, [dict.fromkeys("pq", False) | {"light": "green"} | s for s in states])
    return rulec.verify(given, rules).open


def test_a_value_that_is_always_the_same_decides():
    (found,) = open_verdicts("never (p and q)", [{"p": UNKNOWN, "q": True}, {"p": UNKNOWN}])
    assert [(dict(case.when), case.outcome) for case in found.outcomes] == [
        ({"p": False}, "kept"),
        ({"p": True}, "violated"),
    ]


@pytest.mark.parametrize(
    ("requires", "word"),
    [("never (p and next not p)", "p"), ("never (light = red and next light = green)", "light")],
)
def test_no_value_decides_where_it_matters_when_it_changes(requires, word):
    requires = requires.replace("light = ", "")
    (found,) = open_verdicts(requires, [{word: UNKNOWN}, {word: UNKNOWN}])
    assert (found.depends_on, found.outcomes, found.exact) == ((word,), (), True)
