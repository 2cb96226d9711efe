"""What a monitor remembers of states makes it quicker, and nothing else."""

from collections import defaultdict
from copy import deepcopy
from math import inf, nan

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.online.encoding.encoded_values import breakpoints_of
from rulec.monitoring.online.encoding.state_shape import StateShape
from rulec.monitoring.online.rule_group import CacheSize
from rulec.rulebook.loader import parse_rulebook

RULES = compile_rulebook(
    parse_rulebook(
        """
rulebook remembered
type car
light is one of red, amber, green default green
signal fog, ice default false
quantity speed in m/s default 5
quantity wind in m/s default 0
place(c: car) is one of near, far
signal turning(c: car) default false
quantity gap(c: car) in m default 10
signal follows(c: car, d: car) default false
quantity between(c: car, d: car) in m default 3
fact count c: car (turning(c) and wind > 6 m/s) <= 1

hard rule lights { require always (red implies (fog or not ice)) }
hard rule slow { require always (speed > 8 m/s implies eventually speed <= 4 m/s) }
hard rule fog_ends_in_ice { require always (fog implies eventually ice) }
hard rule not_too_fast { require always (speed > 1e17 m/s implies (fog or speed < 2e18 m/s)) }
hard rule near_ones (c: car) { require always (near(c) implies once not turning(c)) }
soft rule behind (c: car, d: car) { require always not (follows(c, d) and gap(c) - gap(d) > 1 m) }
hard rule apart (c: car, d: car) { require always (near(c) implies eventually between(c, d) > 2 m) }
"""
    )
)
BOTH = {"a": "car", "b": "car"}
NUMBERS = st.sampled_from([0, 1, 1.0, 3, 4, 4.5, 8.000000000000002, 9, -0.0, 2**60, 1e300])
ODD_NUMBERS = NUMBERS | st.sampled_from([True, nan, inf, "fast", None, 10**400])
TRUTHS = st.booleans()
ODD_TRUTHS = TRUTHS | st.sampled_from([0, 1, 1.0, "true", None])


def about(names, values):
    return st.dictionaries(st.sampled_from(names), values, max_size=2)


def states(names, numbers, truths, words):
    """Whatever can be left out is so now and then."""
    everyone = {name: words | st.sampled_from(["near", "far"]) for name in names}
    return st.fixed_dictionaries(
        {"place": st.fixed_dictionaries(everyone)},
        optional={
            "light": words | st.sampled_from(["red", "amber"]),
            "fog": truths,
            "ice": truths,
            "speed": numbers,
            "wind": numbers,
            "turning": about(names, truths),
            "gap": about(names, numbers),
            "follows": about(names, about(names, truths)),
            "between": about(names, about(names, numbers)),
        },
    )


GOOD = states("ab", NUMBERS, TRUTHS, st.nothing())
ODD = states("abx", ODD_NUMBERS, ODD_TRUTHS, st.sampled_from(["nowhere", True, ()]))


@st.composite
def drives(draw):
    """States that come again and again, with odd ones between them."""
    some = draw(st.lists(GOOD, min_size=1, max_size=3))
    # Likely in the outline of the others, but for one thing.
    for state in draw(st.lists(st.sampled_from(some), max_size=2)):
        odd = draw(ODD)
        name = draw(st.sampled_from([*odd]))
        some.append({**state, name: odd[name]})
    return draw(st.lists(st.sampled_from(some), max_size=12))


def answer(monitor, state, objects=BOTH):
    try:
        return monitor.step(state, objects), monitor.snapshot()
    except RulecError as refused:
        return refused.diagnostics, monitor.snapshot()


PLACES = {"place": {"a": "far", "b": "far"}}
FOGGY, ICY, NOT_ICY = {**PLACES, "fog": True}, {**PLACES, "ice": True}, {**PLACES, "ice": False}
SIZES = [(1, 99, 1), (99, 3, 1), (2, 3, 2), (1 << 12, 1 << 9, 16)]


def turning(wind):
    return {**PLACES, "turning": {"a": True, "b": True}, "wind": wind}


def following(gap):
    return {**PLACES, "follows": {"a": {"b": True}}, "gap": {"a": gap, "b": 2}}


@given(drives(), st.sampled_from(SIZES))
# A number in place of a truth value.
@example([ICY, ICY, ICY, {**PLACES, "ice": 1}], SIZES[-1])
# A number that only a fact looks at; numbers whose difference matters.
@example([turning(5), turning(5), turning(5), turning(7)], SIZES[-1])
@example([following(3), following(3), following(3), following(4)], SIZES[-1])
# A number that is larger than any float.
@example([following(10**400), {**following(10**400), "speed": 10**400}], SIZES[-1])
@example([{**following(1.5), "gap": {"a": 1.5, "b": 10**400}}], SIZES[-1])
# Keys of two outlines that look the same, in the standing where the outline changes and elsewhere.
@example([FOGGY, FOGGY, FOGGY, ICY, FOGGY, ICY, NOT_ICY, ICY], SIZES[-1])
@example([FOGGY, FOGGY, FOGGY, ICY, FOGGY, ICY, NOT_ICY, FOGGY, ICY], SIZES[-1])
def test_with_and_without_outlines_and_memory_a_monitor_says_the_same(drive, size):
    one, other = Monitor(RULES), Monitor(RULES)
    for state in drive:
        with pytest.MonkeyPatch.context() as patched:
            for name, value in zip(("MOST", "TRIAL", "REST"), size, strict=True):
                patched.setattr(f"rulec.monitoring.online.transition_cache.{name}", value)
            remembering = answer(one, state)
        with pytest.MonkeyPatch.context() as patched:
            # As `verify` reads a state.
            patched.setattr(
                "rulec.monitoring.online.bound_rules.BoundRules._reader_of", lambda *_: None
            )
            assert remembering == answer(other, state)


@given(drives())
def test_a_state_may_be_changed_once_it_has_been_taken(drive):
    one, other, state = Monitor(RULES), Monitor(RULES), {}
    for new in drive:
        # The same objects all the time, with the new content.
        for name in [*state]:
            if name not in new:
                del state[name]
        for name, value in deepcopy(new).items():
            if isinstance(value, dict) and isinstance(state.get(name), dict):
                state[name].clear()
                state[name].update(value)
            else:
                state[name] = value
        assert answer(one, state) == answer(other, deepcopy(new))


def test_an_answer_cannot_be_changed():
    monitor = Monitor(RULES)
    for _ in range(4):
        found = monitor.step({"place": {"a": "near", "b": "far"}, "between": {"a": {"b": 1}}}, BOTH)
        monitor.step({"place": {"a": "far", "b": "far"}}, BOTH)
    with pytest.raises(AttributeError):
        found.state = 7
    with pytest.raises(TypeError):
        found.rules["apart"] = "violated"
    with pytest.raises(TypeError):
        found.changes[0].binding["c"] = "b"


def is_remembered(monitor, state, monkeypatch):
    """Is a state taken without being read?"""
    with monkeypatch.context() as patched:
        patched.delattr("rulec.monitoring.online.bound_rules.BoundRules.read")
        try:
            monitor.step(state, BOTH)
        except RulecError as error:
            if "has no attribute 'read'" not in str(error):
                raise
            return False
    return True


SLOW = {**PLACES, "speed": 3}


def test_what_has_been_is_remembered(monkeypatch):
    monitor = Monitor(RULES)
    for state in [SLOW] * 2:
        monitor.step(state, BOTH)
    assert is_remembered(monitor, SLOW, monkeypatch)
    assert is_remembered(monitor, {**SLOW, "speed": 3.5}, monkeypatch)
    assert not is_remembered(monitor, {**SLOW, "speed": 4.5}, monkeypatch)


def test_one_stranger_does_not_make_it_forget_but_two_do(monkeypatch):
    monitor = Monitor(RULES)
    windy = {**SLOW, "wind": 1}
    for state in [SLOW, SLOW, windy]:
        monitor.step(state, BOTH)
    assert is_remembered(monitor, SLOW, monkeypatch)
    for state in [windy, windy]:
        monitor.step(state, BOTH)
    assert is_remembered(monitor, windy, monkeypatch)
    assert not is_remembered(monitor, SLOW, monkeypatch)


def test_where_nothing_comes_again_nothing_is_remembered_for_a_while(monkeypatch):
    monkeypatch.setattr("rulec.monitoring.online.transition_cache.TRIAL", 16)
    monkeypatch.setattr("rulec.monitoring.online.transition_cache.REST", 2)
    monitor = Monitor(RULES)
    # In pairs of cars every gap matters.
    states = [{**SLOW, "gap": {"a": 1, "b": number / 10}} for number in range(100)]
    for state in states:
        monitor.step(state, BOTH)
    remembered = [n for n, one in enumerate(states) if is_remembered(monitor, one, monkeypatch)]
    # With state 0 the cars have come; the outline of state 1 was new, which counts as one more.
    # These states leave the monitor where it stands, so that the first after a rest is known, too.
    assert remembered == [*range(1, 16), *range(16 + 32, 64), *range(64 + 32, 100)]


PAIRS = {
    "place": {"a": "near"},
    "fog": True,
    "speed": 3,
    "between": {"a": {"b": 1.5}},
    "follows": {"a": {"b": False}},
}
KEY = StateShape([*PAIRS], BOTH, RULES.vocabulary, breakpoints_of(RULES)).key


@pytest.mark.parametrize(
    "odd",
    [
        {"fog": 1},
        {"fog": None},
        {"speed": True},
        {"speed": nan},
        {"speed": inf},
        {"speed": 2**60},
        {"speed": "fast"},
        {"speed": 2**53},
        {"place": {"x": "near"}},
        {"place": {"a": "near", "x": "near"}},
        {"place": {"a": "near", "b": "near", "x": "near"}},
        {"gap": {"a": 1}},
        {"place": defaultdict(lambda: "near", {"b": "near"})},
        {"place": [("a", "near")]},
        {"between": {"a": {"a": 1.5}}},
        {"between": {"a": {"a": 1.5, "b": 1.5}}},
        {"between": {"x": {"b": 1.5}}},
        {"between": {"a": 1.5}},
        {"between": {"a": {"b": "1.5"}}},
        {"follows": {"a": {"b": 0}}},
        {"ice": False},
    ],
)
def test_what_is_not_of_the_same_outline_has_no_key(odd):
    with pytest.raises((LookupError, TypeError)):
        KEY({**PAIRS, **odd})


ONE = {"a": "car"}
A_NEAR, BOTH_NEAR = {"place": {"a": "near"}}, {"place": {"a": "near", "b": "near"}}


@pytest.mark.parametrize(
    ("objects", "state", "odd"),
    [
        (ONE, A_NEAR, {**A_NEAR, "fog": True}),
        (ONE, A_NEAR, BOTH_NEAR),
        (BOTH, BOTH_NEAR, {**BOTH_NEAR, "fog": True}),
        (BOTH, BOTH_NEAR, {"place": {"a": "near", "b": "near", "x": "near"}}),
        (BOTH, {"fog": True}, {"fog": True, "frog": True}),
        (BOTH, {"turning": {"a": True}}, {"turning": {"a": True}, "fog": True}),
    ],
)
def test_nor_has_more_than_a_single_name_says(objects, state, odd):
    key = StateShape([*state], objects, RULES.vocabulary, breakpoints_of(RULES)).key
    assert key(deepcopy(state)) == key(state)
    with pytest.raises(LookupError):
        key(odd)


def test_alike_is_what_no_rule_tells_apart():
    same = [{}, {"speed": 4.0}, {"speed": -(10**9)}]
    # Others than `a` follow whom they follow by default.
    same += [{"follows": {}}, {"follows": {"b": {"a": False}}}, {"follows": {"a": {}}}]
    assert {KEY({**deepcopy(PAIRS), **one}) for one in same} == {KEY(PAIRS)}
    for other in [
        {"place": {"a": "far"}},
        {"place": {}},
        {"place": {"a": "near", "b": "near"}},
        {"fog": False},
        {"speed": 4.5},
        {"between": {"a": {"b": 2.5}}},
        {"follows": {"a": {"b": True}}},
    ]:
        assert KEY({**PAIRS, **other}) != KEY(PAIRS)


AFTER_FOG = compile_rulebook(
    parse_rulebook(
        """
rulebook after_fog
type car
signal fog, ice default false
hard rule three_states_later { require never (previously[3 steps] fog and ice) }
hard rule of_no_matter (c: car) { require always (fog implies fog or once ice) }
"""
    )
)
FOGS = [{"fog": bit == "1"} for n in range(32) for bit in f"{n:05b}"]
"""What the last three states were leads everywhere: to 8 nodes, by 2 letters in 16 ways."""


def stay(state):
    return [(state, {})]


def come_and_go(state):
    return [(state, {}), (state, {"a": "car"})]


def are_refused_now_and_then(state):
    return [(state, {}), ({"frog": True}, {})]


@pytest.mark.parametrize(
    # Where somebody comes or goes no ways are learnt.
    ("they", "most"),
    [(stay, 20), (come_and_go, 5), (are_refused_now_and_then, 20)],
)
def test_what_has_been_learnt_does_not_grow_for_ever(they, most, monkeypatch):
    made = []

    def cache_size():
        made.append(CacheSize())
        return made[-1]

    monkeypatch.setattr("rulec.monitoring.online.rule_group.CacheSize", cache_size)
    monkeypatch.setattr("rulec.monitoring.online.running_monitor.MOST_CACHED", most)
    monitor = Monitor(AFTER_FOG)
    for state in FOGS:
        for told, objects in they(state):
            answer(monitor, told, objects)
    # In one step not many can be added.
    assert max(one.n for one in made) < most + 10
    assert sum(one.n > most for one in made) > 2


def test_objects_stay_in_the_order_in_which_they_came(monkeypatch):
    monkeypatch.setattr("rulec.monitoring.online.running_monitor.MOST_CACHED", 0)
    monitor = Monitor(AFTER_FOG)
    for names in ("ab", "ba"):
        monitor.step({}, dict.fromkeys(names, "car"))
    assert [*monitor.objects] == ["a", "b"]
