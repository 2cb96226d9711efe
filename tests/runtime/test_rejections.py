"""What each rule rejects, against judging every path."""

from graphs import graphs
from hypothesis import given
from random_priorities import rulebooks

from rulec.runtime.cheapest import cheapest
from rulec.runtime.effects import effects
from rulec.runtime.instances import instances
from rulec.runtime.rejections import violating, violating_alone
from rulec.runtime.verify import verify
from rulec.trace.paths import paths, trace_of


def accepted(product):
    return sorted(maneuver.nodes for maneuver in cheapest(product))


@given(graphs(objects=("car1", "car2")), rulebooks(strengths=("hard",)))
def test_what_a_rule_rejects_and_what_it_alone_rejects(graph, rulebook):
    violated = {
        path: {one.rule for one in verify(trace_of(graph, path, ""), rulebook).violations}
        for path in paths(graph)
    }
    found = effects(graph, instances(graph, rulebook))
    some, alone = violating(found), violating_alone(found)
    names = [rule.name for rule in rulebook.rules]
    for product, expected in (
        (some, {name: [path for path in violated if name in violated[path]] for name in names}),
        (alone, {name: [path for path in violated if violated[path] == {name}] for name in names}),
    ):
        assert {name: accepted(one) for name, one in product.items()} == {
            name: every for name, every in expected.items() if every
        }
        for name, one in product.items():
            assert one.accepted == len(expected[name])
