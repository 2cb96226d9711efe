"""What each rule rejects, against judging every path."""

from graphs import graphs
from hypothesis import given
from random_priorities import rulebooks

from rulec.runtime.cheapest import cheapest
from rulec.runtime.effects import effects
from rulec.runtime.instances import instances
from rulec.runtime.rejections import rejections
from rulec.runtime.verify import verify
from rulec.trace.paths import paths, trace_of


def accepted(product):
    return [] if product is None else sorted(maneuver.nodes for maneuver in cheapest(product))


@given(graphs(objects=("car1", "car2")), rulebooks(strengths=("hard",)))
def test_what_a_rule_rejects_and_what_it_alone_rejects(graph, rulebook):
    violated = {
        path: {one.rule for one in verify(trace_of(graph, path, ""), rulebook).violations}
        for path in paths(graph)
    }
    found = {one.rule: one for one in rejections(effects(graph, instances(graph, rulebook)))}
    for rule in rulebook.rules:
        every = [path for path, rules in violated.items() if rule.name in rules]
        alone = [path for path, rules in violated.items() if rules == {rule.name}]
        if not every:
            assert rule.name not in found
            continue
        assert accepted(found[rule.name].every) == every
        assert accepted(found[rule.name].alone) == alone
        assert found[rule.name].every.accepted == len(every)
        assert (found[rule.name].alone is None) == (not alone)
