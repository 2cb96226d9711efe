"""``rulec maneuvers`` and ``rulec maneuvers --traces`` as their user meets them."""

import json
import re

import pytest

from rulec import compile_rulebook, find_maneuvers
from rulec.api.named_monitor import Monitor
from rulec.cli.main import main
from support.builders.road_scenes import BEHIND_A_VAN, CHILD_AT_THE_KERB
from support.unwrapped import unwrapped


def answer(capsys, *arguments):
    status = main(["maneuvers", *arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_text(capsys):
    status, out, err = answer(capsys, "s2", "--rulebook", "esterle2019")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[:5] == [
        "scenario    s2: 4 s in steps of 1 s, partition paper, adjacency touch",
        "graph       35 nodes, 124 edges",
        "maneuvers   139 paths through cells",
        "satisfying  83 by esterle2019 (R1, R2, R3)",
        "by default  CONGESTED: the scenario does not say",
    ]
    assert len(lines) == 6


def test_what_the_scenario_does_not_say_is_named(tmp_path, capsys):
    signals = "signal p, q, unread default false\nquantity speed in m/s default 3\n"
    rules = (
        "hard rule a { require always (p or not q or speed > 2 m/s) }\n"
        "soft rule b { require always surface_is_usual }\n"
        "define surface_is_usual = not R_pc\n"
    )
    book = tmp_path / "book.rules"
    book.write_text(f"rulebook book\nuse paper\n{signals}{rules}", encoding="utf-8")
    _, out, _ = answer(capsys, "s2", "--rulebook", str(book), "--json")
    # Nobody asks for `unread` or CONGESTED, and the scenario has surfaces.
    assert json.loads(out)["by_default"] == ["p", "q", "speed"]
    _, out, _ = answer(capsys, "s2", "--rulebook", str(book))
    assert "by default  p, q, speed: the scenario does not say" in out.splitlines()


def test_the_list_is_sorted_and_complete(capsys):
    _, out, _ = answer(capsys, "s2", "--rulebook", "esterle2019", "--list", "1000", "--json")
    found = json.loads(out)
    maneuvers = found["maneuvers"]
    assert len(maneuvers) == found["satisfying"] == 83
    costs = [maneuver["cost"] for maneuver in maneuvers]
    assert costs == sorted(costs)
    paths = [tuple(cell["cell"] for cell in maneuver["cells"]) for maneuver in maneuvers]
    assert len(set(paths)) == 83
    # Staying behind the vehicle costs nothing and is never too late.
    assert (costs[0], maneuvers[0]["margin_s"], len(set(paths[0]))) == (0, None, 1)
    for maneuver in maneuvers[1:]:
        assert maneuver["cost"] > 0
        assert 1 <= maneuver["margin_s"] <= 5
        for bounds in maneuver["envelope"]:
            assert bounds["s_min"] < bounds["s_max"]
            assert bounds["d_right"][0][0] == bounds["d_left"][0][0] == bounds["s_min"]
            assert bounds["d_right"][0][1] < bounds["d_left"][0][1]


def test_listing_none_and_not_listing(capsys):
    _, out, _ = answer(capsys, "s1", "-r", "esterle2019", "--list", "0", "--json")
    assert json.loads(out)["maneuvers"] == []
    _, out, _ = answer(capsys, "s1", "-r", "esterle2019", "--json")
    assert "maneuvers" not in json.loads(out)


def test_no_satisfying_maneuver_is_status_1(tmp_path, capsys):
    source = tmp_path / "stop.rules"
    source.write_text("rulebook stop\nuse paper\nhard rule A (v: vehicle) { require l(v) }\n")
    status, out, _ = answer(capsys, "s2", "--rulebook", str(source))
    assert status == 1
    assert "satisfying  0 by stop (A)" in out


def test_soft_rules_reject_nothing(tmp_path, capsys):
    source = tmp_path / "wish.rules"
    source.write_text("rulebook wish\nuse paper\nsoft rule A (v: vehicle) { require l(v) }\n")
    status, out, _ = answer(capsys, "s2", "--rulebook", str(source), "--json")
    assert status == 0
    assert json.loads(out)["satisfying"] == 139


def test_the_rulebook_chooses_the_partition(tmp_path, capsys):
    source = tmp_path / "roadwise.rules"
    source.write_text(
        "rulebook roadwise\nuse road\n"
        "hard rule A (v: vehicle) { require always not (beside(v) and right_of(v)) }\n"
    )
    for scenario in ("s1", "s2", "s3"):
        status, out, err = answer(capsys, scenario, "--rulebook", str(source), "--json")
        assert (status, err) == (0, "")
        assert json.loads(out)["partition"] == "fine"


@pytest.mark.parametrize(
    ("rulebook", "partition"),
    [
        ("use road\nhard rule A { require always not crossing }", "fine"),
        ("use paper\nhard rule A { require always not R_pc }", "paper"),
        ("signal p default true\nhard rule A { require always p }", "paper"),
        pytest.param(
            "type obstacle\ntype vehicle is obstacle\ntype pedestrian is obstacle\n"
            "type cyclist is obstacle\nposition(v: vehicle) is one of b, f, l, r\n"
            "hard rule A (v: vehicle) { require always not r(v) }",
            "paper",
        ),
    ],
)
def test_a_vocabulary_need_not_have_words_for_all_that_a_partition_supplies(
    rulebook, partition, tmp_path, capsys
):
    source = tmp_path / "few_words.rules"
    source.write_text(f"rulebook few_words\n{rulebook}\n")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        "[road]\ns = [0.0, 100.0]\nlanes = [-1.75, 1.75, 5.25]\n[ego]\ns = 10.0\nd = 0.0\n"
        '[[obstacle]]\nid = "v1"\ntype = "vehicle"\nlength = 4.0\nwidth = 2.0\n'
        "s = 40.0\nd = 0.0\n"
        '[[obstacle]]\nid = "p1"\ntype = "pedestrian"\nlength = 1.0\nwidth = 1.0\n'
        "s = 70.0\nd = 3.5\nwalking_direction = -90.0\n"
    )
    for scenario in ("s2", str(scene)):
        status, out, err = answer(capsys, scenario, "--rulebook", str(source), "--json")
        assert (status, err) == (0, "")
        assert json.loads(out)["partition"] == partition


def test_a_partition_that_does_not_supply_what_rules_read(capsys):
    status, _, err = answer(capsys, "s2", "-r", "esterle2019", "--partition", "fine")
    assert status == 2
    assert "reads `position`, which the partition `fine` does not supply" in err
    assert "use the partition `paper`" in err


def test_a_scenario_that_does_not_fit_the_vocabulary(tmp_path, capsys):
    source = tmp_path / "cats.rules"
    source.write_text(
        "rulebook cats\ntype cat\nsignal purrs(c: cat)\nhard rule A { require true }\n"
    )
    status, _, err = answer(capsys, "s2", "--rulebook", str(source))
    assert status == 2
    assert "object `o1` is of type `vehicle`" in err
    assert re.search(r"--> .*s2\.toml:\d+", err)


SAYS = """\
[road]
s = [-30.0, 60.0]
lanes = [-1.75, 1.75]
[ego]
s = 0.0
d = 0.0
[[obstacle]]
id = "van"
type = "car"
length = 6.0
width = 2.2
s = 14.0
d = 0.0
signals = { stopped = "yes" }
[[obstacle]]
id = "cart"
type = "lorry"
length = 6.0
width = 2.2
s = 34.0
d = 0.0
[obstacle.signals]
parked = 1
[signals]
built_up = 3
gap = 5
"""


def test_what_a_scenario_says_wrongly_is_shown_where_it_says_it(tmp_path, capsys):
    file = tmp_path / "road.toml"
    file.write_text(SAYS)
    lines = SAYS.splitlines()
    status, _, err = answer(capsys, str(file), "-r", "de")
    assert status == 2
    found = re.findall(r"error\[(R\d+)\].*\n *--> .*road.toml:(\d+):", err)
    # What is said of an obstacle of a type that there is not is no mistake of its own.
    assert {lines[int(line) - 1]: code for code, line in found} == {
        "built_up = 3": "R0503",
        "gap = 5": "R0503",
        'signals = { stopped = "yes" }': "R0503",
        'type = "lorry"': "R0505",
    }
    assert "help: give it for an obstacle: `signals = { gap = … }`" in err


def test_relations_of_two_partitions(tmp_path, capsys):
    source = tmp_path / "mixed.rules"
    source.write_text(
        "rulebook mixed\ntype vehicle\n"
        "position(v: vehicle) is one of b, f, l, r\n"
        "station(v: vehicle) is one of behind, beside, in_front_of\n"
        "hard rule A (v: vehicle) { require b(v) or behind(v) }\n"
    )
    status, _, err = answer(capsys, "s2", "--rulebook", str(source))
    assert status == 2
    assert "error[R0405]" in err
    assert "no one partition" in err


@pytest.mark.parametrize("adjacency", ["touch", "edge", "forward"])
@pytest.mark.parametrize("partition", ["paper", "fine"])
def test_counting_is_enumerating_for_every_graph(adjacency, partition, tmp_path, capsys):
    rule = "always not r(v)" if partition == "paper" else "always not right_of(v)"
    vocabulary = "paper" if partition == "paper" else "road"
    source = tmp_path / "any.rules"
    source.write_text(
        f"rulebook any\nuse {vocabulary}\nhard rule A (v: vehicle) {{ require {rule} }}\n"
    )
    how = ["s2", "--adjacency", adjacency, "--horizon", "3"]
    _, out, _ = answer(capsys, *how, "--rulebook", str(source), "--json")
    counted = json.loads(out)
    file = str(tmp_path / "t.jsonl")
    assert main(["maneuvers", "--traces", *how, "--partition", partition, "-o", file]) == 0
    capsys.readouterr()
    main(["verify", file, "--rulebook", str(source), "--json"])
    verdicts = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(verdicts) == counted["traces"]
    assert sum(verdict["satisfied"] for verdict in verdicts) == counted["satisfying"]


def test_an_unknown_scenario_names_the_nearest(capsys):
    status, _, err = answer(capsys, "s22", "--rulebook", "esterle2019")
    assert status == 2
    assert "s2" in err


def test_traces_to_standard_output(capfdbinary):
    assert main(["maneuvers", "--traces", "s1", "-o", "-"]) == 0
    assert len(capfdbinary.readouterr().out.splitlines()) == 16


def test_a_limit(tmp_path, capsys):
    file = tmp_path / "t.jsonl"
    assert main(["maneuvers", "--traces", "s2", "--first", "5", "-o", str(file)]) == 0
    assert len(file.read_text().splitlines()) == 5
    assert "wrote 5 of 139 traces" in capsys.readouterr().out


def test_too_many_traces_are_not_begun(tmp_path, capsys):
    file = tmp_path / "t.jsonl"
    assert main(["maneuvers", "--traces", "s2", "--step", "0.25", "-o", str(file)]) == 2
    assert "--first" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_an_unwritable_file(tmp_path, capsys):
    assert main(["maneuvers", "--traces", "s1", "-o", str(tmp_path / "no" / "t.jsonl")]) == 2
    assert "no such file or directory" in capsys.readouterr().err


def test_the_interface_gives_networkx_and_lazy_maneuvers():
    found = find_maneuvers("s2", "esterle2019", step_s=0.5)
    graph = found.graph.to_networkx()
    assert (graph.number_of_nodes(), graph.number_of_edges()) == (63, 248)
    assert len(found.cheapest(7)) == 7


def written(folder, name, *records):
    path = folder / name
    path.write_text("".join(f"{json.dumps(one)}\n" for one in records), encoding="utf-8")
    return str(path)


QUEUE = {
    "step_s": 0.5,
    "objects": {"o1": "vehicle", "o2": "vehicle"},
    "states": [{"position": {"o1": "b", "o2": "b"}, "CONGESTED": True}],
}
PASSED = {
    "objects": {"o9": "vehicle"},
    "present": {"o9": [0, 2]},
    "states": [{"position": {"o9": place}} for place in "brf"] + [{}],
}


def test_after_a_past(tmp_path, capsys):
    """R1 rejects 32 maneuvers, but not if traffic was congested when the trace began."""
    arguments = ["s1", "--step", "0.5", "-r", "esterle2019", "--json"]
    past = written(tmp_path, "queue.jsonl", QUEUE)
    assert json.loads(answer(capsys, *arguments)[1])["satisfying"] == 640
    found = json.loads(answer(capsys, *arguments, "--after", past)[1])
    assert (found["satisfying"], found["violated_before"]) == (672, [])


def test_after_a_monitor_that_was_saved(tmp_path, capsys):
    rules = compile_rulebook("esterle2019")
    monitor = Monitor(rules)
    monitor.step(QUEUE["states"][0], QUEUE["objects"])
    past = written(tmp_path, "saved.json", monitor.snapshot())
    status, out, _ = answer(
        capsys, "s1", "--step", "0.5", "-r", "esterle2019", "--after", past, "--json"
    )
    assert (status, json.loads(out)["satisfying"]) == (0, 672)


def test_what_the_past_has_violated_is_said_and_not_counted(tmp_path, capsys):
    past = written(tmp_path, "passed.jsonl", PASSED)
    status, out, _ = answer(capsys, "s2", "-r", "esterle2019", "--after", past)
    assert status == 0
    assert out.splitlines()[3:5] == [
        "satisfying  83 by esterle2019 (R1, R2, R3)",
        "violated    R1 for v = o9, before, and not counted any more",
    ]
    found = json.loads(answer(capsys, "s2", "-r", "esterle2019", "--after", past, "--json")[1])
    assert found["violated_before"] == [
        {"rule": "R1", "strength": "hard", "binding": {"v": "o9"}, "step": 2}
    ]


def test_only_so_many_are_named(tmp_path, capsys):
    names = [f"x{number}" for number in range(9)]
    objects = dict.fromkeys(names, "vehicle")
    states = [{"position": dict.fromkeys(names, place)} for place in "brf"]
    past = written(tmp_path, "past.jsonl", {"objects": objects, "states": states})
    _, out, _ = answer(capsys, "s2", "-r", "esterle2019", "--after", past)
    assert "            and 3 more; --json has them all" in out.splitlines()


@pytest.mark.parametrize(
    ("records", "code"),
    [([QUEUE], "R0511"), ([PASSED] * 2, "R0511"), ([[]], "R0501"), ([], "R0501")],
)
def test_what_is_no_past(tmp_path, capsys, records, code):
    past = written(tmp_path, "past.jsonl", *records)
    status, out, err = answer(capsys, "s2", "-r", "esterle2019", "--after", past)
    assert (status, out) == (2, "")
    assert f"error[{code}]" in err
    assert "past.jsonl" in err


HURRY = """rulebook hurry
use paper
priority people > progress
hard rule wait_behind (v: vehicle) in people weight 2 { cite "1" require always not f(v) }
hard rule arrive (v: vehicle) in progress weight 0.5 { require eventually f(v) }
soft rule pull_out_early (v: vehicle) { cite "3" require eventually[<= 1 steps] l(v) }
"""


@pytest.fixture
def hurry(tmp_path):
    source = tmp_path / "hurry.rules"
    source.write_text(HURRY)
    return str(source)


def test_where_nothing_satisfies_the_least_violating_are_shown(hurry, capsys):
    status, out, err = answer(capsys, "s2", "--horizon", "2", "-r", hurry)
    assert (status, err) == (1, "")
    lines = [line.strip() for line in out.splitlines()]
    assert "Every maneuver violates a hard rule. No other violates less than:" in lines
    # People come first, so ego stays behind; then pulling out early keeps the soft rule, too.
    assert "violates hard progress 0.5" in lines
    assert "hard rule arrive for v = o1: by how it ends" in lines
    assert sum(line.startswith("violates") for line in lines) == 1

    status, out, _ = answer(capsys, "s2", "--horizon", "2", "-r", hurry, "--json")
    assert status == 1
    (best,) = json.loads(out)["least_violating"]
    assert best["place"] == 1
    assert best["penalty"] == [{"strength": "hard", "levels": ["progress"], "weight": 0.5}]
    assert best["violations"] == [
        {
            "rule": "arrive",
            "cite": "",
            "binding": {"v": "o1"},
            "lost_s": None,
            "strength": "hard",
            "level": "progress",
            "weight": 0.5,
        }
    ]
    assert best["cells"][1]["signature"]["o1"] == "l"


def test_a_soft_rule_that_cannot_be_judged_takes_no_answer_away(tmp_path, capsys):
    source = tmp_path / "blind.rules"
    source.write_text(HURRY + "signal foggy\nsoft rule lights { require always not foggy }\n")
    status, out, err = answer(capsys, "s2", "--horizon", "2", "-r", str(source), "--json")
    assert status == 1
    assert json.loads(out)["satisfying"] == 0
    assert "least_violating" not in json.loads(out)
    assert "does not say the `foggy`, which rule `lights` needs" in err
    # Asked for, they are needed.
    status, out, err = answer(capsys, "s2", "-r", str(source), "--rank", "1")
    assert (status, out) == (2, "")
    assert "R0504" in err


@pytest.mark.parametrize(
    ("priority", "level", "expected"),
    [
        ("people > progress", "in progress", [["arrive"]]),
        ("progress > people", "in progress", [["wait_behind"]]),
        ("people = progress", "in progress", [["arrive"]]),  # 0.5 is less than 1
        # Rules without a level are not comparable to others: neither is better.
        ("people > progress", "", [["wait_behind"], ["arrive"]]),
    ],
)
def test_levels_decide_which_rule_yields(priority, level, expected, tmp_path, capsys):
    source = tmp_path / "torn.rules"
    text = HURRY.replace("people > progress", priority).replace("in progress", level)
    source.write_text(text)
    _, out, _ = answer(capsys, "s2", "--horizon", "2", "-r", str(source), "--json")
    best = json.loads(out)["least_violating"]
    violated = [[v["rule"] for v in each["violations"] if v["strength"] == "hard"] for each in best]
    assert sorted(violated, reverse=True) == expected


def test_soft_rules_rank_what_satisfies(tmp_path, capsys):
    source = tmp_path / "wish.rules"
    source.write_text(
        "rulebook wish\nuse paper\n"
        "hard rule A (v: vehicle) { require always not r(v) }\n"
        "soft rule B (v: vehicle) { require always b(v) }\n"
        "soft rule C (v: vehicle) weight 2 { require next l(v) }\n"
    )
    status, out, _ = answer(capsys, "s2", "-r", str(source), "--rank", "500", "--json")
    assert status == 0
    found = json.loads(out)
    assert "least_violating" not in found
    ranked = found["ranked"]
    # Of the maneuvers that are not satisfying, none is better than one that is.
    assert len(ranked) == found["traces"]
    kept = [not any(v["strength"] == "hard" for v in one["violations"]) for one in ranked]
    assert sum(kept) == found["satisfying"]
    assert kept == sorted(kept, reverse=True)
    weights = [sum(v["weight"] for v in one["violations"]) for one in ranked]
    assert weights == sorted(weights)
    # B and C exclude each other: pulling out at once costs 1, staying behind 2, changing later 3.
    assert sorted(set(weights)) == [1, 2, 3]
    assert [one["place"] for one in ranked] == weights
    for weight in (1, 2, 3):
        alike = [one for one, mine in zip(ranked, weights, strict=True) if mine == weight]
        assert [one["cost"] for one in alike] == sorted(one["cost"] for one in alike)
        assert {one["members"] for one in alike} == {len(alike)}


def test_which_rule_prunes_what(hurry, capsys):
    _, out, _ = answer(capsys, "s2", "--horizon", "2", "-r", hurry, "--why", "--json")
    rules = {one["rule"]: one for one in json.loads(out)["rules"]}
    # 7 maneuvers: each passes the vehicle or does not.
    assert rules["wait_behind"]["violating"] + rules["arrive"]["violating"] == 7
    for name in ("wait_behind", "arrive"):
        assert rules[name]["alone"] == rules[name]["violating"] > 0
        assert [v["rule"] for v in rules[name]["example"]["violations"]] == [name]
    assert (rules["pull_out_early"]["strength"], rules["pull_out_early"]["alone"]) == ("soft", None)
    assert rules["wait_behind"]["example"]["violations"][0]["lost_s"] == 2.0

    _, out, _ = answer(capsys, "s2", "-r", "esterle2019", "--why")
    assert "violated by none: R1, R3" in out
    _, german, _ = answer(capsys, "s2", "-r", "de", "--why")
    idle = german.partition("violated by none: ")[2]
    assert idle.count(",") > 50
    assert max(map(len, idle.splitlines())) <= 100
    (line,) = [line for line in out.splitlines() if line.startswith("R2")]
    assert line.split()[1:3] == ["56", "56"]  # 139 - 83


def test_classes(capsys, tmp_path):
    _, out, _ = answer(capsys, "s1", "-r", "esterle2019", "--classes", "100", "--json")
    classes = json.loads(out)["classes"]
    assert (classes["divided"], classes["counting_steps"]) == (0, [])
    assert sum(one["members"] for one in classes["representatives"]) == 16
    assert len(classes["representatives"]) == classes["satisfying"] == classes["total"]

    source = tmp_path / "soon.rules"
    source.write_text(
        "rulebook soon\nuse paper\nhard rule A (v: vehicle) { require next next l(v) }\n"
    )
    _, out, _ = answer(capsys, "s2", "-r", str(source), "--classes", "0")
    assert "of these depending on how long one stays: `A` counts steps" in out


def test_several_predictions(tmp_path, capsys):
    """In 2 s a child may be on the crossing: whoever is in front of it then violates R3."""
    file = tmp_path / "kerb.toml"
    file.write_text(CHILD_AT_THE_KERB, encoding="utf-8")
    book = (str(file), "-r", "esterle2019", "--json")
    status, out, _ = answer(capsys, *book, "--list", "99", "--worlds")
    found = json.loads(out)
    assert (status, found["likeliest"]) == (0, 0.75)
    (world,) = found["worlds"]
    assert (world["obstacle"], world["prediction"], world["weight"]) == ("child", 2, 0.25)
    told = [one["chances"] for one in found["maneuvers"]]
    assert len(told) == found["satisfying"] > 0
    assert sum(one["clear"] == 1 for one in told) == world["traces"]
    assert sum(one["every_hard_rule"] == 1 for one in told) == world["satisfying"]
    assert {one["clear"] for one in told} == {0.75, 1.0}
    in_front = [one for one in told if one["clear"] == 1 > one["every_hard_rule"]]
    assert in_front
    for one in in_front:
        r3 = {"rule": "R3", "strength": "hard", "kept": 0.75}
        assert {**r3, "bindings": [{"binding": {"p": "child"}, "kept": 0.75}]} in one["rules"]
    (best, *_) = json.loads(answer(capsys, *book, "--rank", "1")[1])["ranked"]
    assert best["chances"] == told[0]


def test_without_predictions_nothing_is_said_of_them(capsys):
    _, out, _ = answer(capsys, "s1", "-r", "esterle2019", "--json", "--list", "1")
    found = json.loads(out)
    assert "worlds" not in found
    assert "likeliest" not in found
    assert "chances" not in found["maneuvers"][0]


def test_the_extent(tmp_path, capsys):
    """Where lanes are taken whole there is no way past a cyclist in the only one."""
    file = tmp_path / "wide.toml"
    cyclist = 'id = "c"\ntype = "cyclist"\nlength = 2.0\nwidth = 0.6\ns = 20.0\nd = -2.6\n'
    road = "[road]\ns = [-20.0, 60.0]\nlanes = [-3.0, 3.0]\n"
    ego = "[ego]\ns = 0.0\nd = 0.0\nwidth = 1.8\n[goal]\ns = [40.0, 60.0]\n"
    file.write_text(f"{road}{ego}[[obstacle]]\n{cyclist}", encoding="utf-8")
    book = (str(file), "-r", "vienna", "--partition", "fine", "--json")
    status, out, _ = answer(capsys, *book)
    assert (status, json.loads(out)["extent"], json.loads(out)["traces"]) == (1, "lane", 0)
    status, out, _ = answer(capsys, *book, "--extent", "body", "--list", "1")
    found = json.loads(out)
    assert (status, found["extent"]) == (0, "body")
    # Ego's centre stays 0.9 m from the verge, and from the cyclist, who reaches to -2.3
    beside = [
        one
        for one, cell in zip(
            found["maneuvers"][0]["envelope"], found["maneuvers"][0]["cells"], strict=True
        )
        if cell["signature"]["c"] == ["beside", "left_of"]
    ]
    assert beside
    assert beside[0]["d_right"][0][1] == pytest.approx(-1.4)
    assert beside[0]["d_left"][0][1] == pytest.approx(2.1)
    _, out, _ = answer(capsys, *book[:-1], "--extent", "body")
    assert "partition fine, adjacency touch, extent body" in unwrapped(out)


DARK = (
    BEHIND_A_VAN
    + """speed = 4.0
[signals]
CONGESTED = "?"
"""
)


def test_what_is_not_known_is_said_of_each_maneuver(tmp_path, capsys):
    file = tmp_path / "dark.toml"
    file.write_text(DARK, encoding="utf-8")
    about = [str(file), "-r", "esterle2019", "--horizon", "2"]
    status, out, _ = answer(capsys, *about, "--list", "9")
    lines = out.splitlines()
    assert (status, lines[3:7]) == (
        0,
        [
            "satisfying  4 by esterle2019 (R1, R2, R3)",
            "violating   0",
            "open        1",
            "unknown     CONGESTED: not, or not exactly, known",
        ],
    )
    (place,) = [number for number, line in enumerate(lines) if line.endswith("; open")]
    assert unwrapped(" ".join(lines[place + 1 : place + 3])).endswith(
        "violated if not CONGESTED, kept if CONGESTED"
    )
    found = json.loads(answer(capsys, *about, "--list", "9", "--json")[1])
    assert (found["satisfying"], found["open"], found["unknown"]) == (4, 1, ["CONGESTED"])
    doubts = [maneuver["open"] for maneuver in found["maneuvers"]]
    assert [len(doubt) for doubt in doubts] == [0, 0, 0, 0, 1]
    assert doubts[-1][0]["depends_on"] == ["CONGESTED"]


def test_strict_wants_a_maneuver_that_keeps_every_rule_for_sure(tmp_path, capsys):
    rules = tmp_path / "flow.rules"
    rules.write_text("rulebook flow\nuse paper\nhard rule flow { require CONGESTED }\n")
    file = tmp_path / "dark.toml"
    file.write_text(DARK, encoding="utf-8")
    about = [str(file), "-r", str(rules)]
    assert answer(capsys, *about)[0] == 0
    assert answer(capsys, *about, "--strict")[0] == 1


def test_what_is_assumed_holds_where_the_scenario_does_not_tell(tmp_path, capsys):
    def counts(signals, *options):
        file = tmp_path / "dark.toml"
        file.write_text(DARK.replace('CONGESTED = "?"', signals), encoding="utf-8")
        arguments = [str(file), "-r", "esterle2019", "--json", *options]
        found = json.loads(answer(capsys, *arguments)[1])
        dark = [rule["rule"] for rule in found["not_judged"]]
        return found["satisfying"], found["open"], found["unknown"], dark

    yes, no = counts("CONGESTED = true"), counts("CONGESTED = false")
    assert yes[0] > no[0]
    for given in ("", 'CONGESTED = "?"'):
        assert counts(given, "--assume", "CONGESTED=true") == yes
        assert counts(given, "--assume", "CONGESTED=false", "--told-only") == no
        assert counts(given, "--assume", "defaults") == no
    assert counts("CONGESTED = true", "--assume", "CONGESTED=false", "--told-only") == yes
    assert counts("") == no
    assert counts('CONGESTED = "?"') == (no[0], yes[0] - no[0], ["CONGESTED"], [])
    assert counts("", "--told-only")[2:] == (["CONGESTED"], ["R1"])


def test_where_nothing_can_be_judged_there_is_no_answer(capsys):
    status, out, _ = answer(capsys, "s2", "-r", "vienna", "--told-only")
    assert status == 2
    assert "satisfying  not known: no hard rule of vienna can be judged" in out.splitlines()


def test_told_only_contradicts_defaults(capsys):
    status, _, err = answer(
        capsys, "s2", "-r", "esterle2019", "--told-only", "--assume", "defaults"
    )
    assert status == 2
    assert "opposite" in err


@pytest.mark.parametrize("ending", ["jsonl", "csv", "parquet"])
def test_traces_of_what_is_not_known_have_the_same_verdicts(tmp_path, capsys, ending):
    file, traces = tmp_path / "dark.toml", tmp_path / f"dark.{ending}"
    file.write_text(DARK, encoding="utf-8")
    found = find_maneuvers(file, "esterle2019", horizon_s=2)
    about = [str(file), "-r", "esterle2019", "--horizon", "2"]
    assert main(["maneuvers", "--traces", *about, "-o", str(traces)]) == 0
    capsys.readouterr()
    main(["verify", str(traces), "-r", "esterle2019", "--json"])
    verdicts = [json.loads(line)["satisfied"] for line in capsys.readouterr().out.splitlines()]
    assert (verdicts.count(True), verdicts.count(None)) == (found.satisfying, found.open) == (4, 1)


def test_bounds_and_pictures_read_what_is_not_known_alike(tmp_path, capsys):
    """Bounds and pictures are of open maneuvers, too; by what is assumed these are satisfying."""
    file = tmp_path / "dark.toml"
    file.write_text(DARK, encoding="utf-8")
    about = (str(file), "-r", "esterle2019", "--horizon", "2")
    told = tmp_path / "told.jsonl"
    plain = tmp_path / "plain.jsonl"
    assert main(["maneuvers", "--envelopes", *about, "--list", "99", "-o", str(plain)]) == 0
    assumed = ["--assume", "CONGESTED=true"]
    assert (
        main(["maneuvers", "--envelopes", *about, "--list", "99", "-o", str(told), *assumed]) == 0
    )
    capsys.readouterr()
    _, out, _ = answer(capsys, *about, *assumed)
    satisfying = int(next(x for x in out.splitlines() if x.startswith("satisfying")).split()[1])
    layers = 3
    assert len(told.read_text().splitlines()) == layers * satisfying
    assert len(plain.read_text().splitlines()) == layers * satisfying
    never = ["--assume", "CONGESTED=false"]
    assert main(["maneuvers", "--envelopes", *about, "--list", "99", "-o", str(told), *never]) == 0
    assert len(told.read_text().splitlines()) == layers * (satisfying - 1)
    capsys.readouterr()
    drawing = tmp_path / "graph.svg"
    shown = ["--maneuver", str(satisfying), "-o", str(drawing)]
    assert main(["draw", "graph", *about, *shown]) == 0
    assert main(["draw", "graph", *about, *shown, *assumed]) == 0
    assert main(["draw", "graph", *about, *shown, *never]) == 2
    assert main(["draw", "graph", str(file), "-o", str(drawing), "--told-only"]) == 2
    assert "--told-only needs a rulebook" in capsys.readouterr().err


def test_predictions_that_are_one_motion_are_one_world_and_said_to_be(tmp_path, capsys):
    scene = tmp_path / "kerb.toml"
    scene.write_text(CHILD_AT_THE_KERB.replace("lateral_speed = 0.6\n", ""))
    asked = [str(scene), "-r", "esterle2019", "--horizon", "1", "--list", "1", "--worlds", "--json"]
    assert main(["maneuvers", *asked]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["likeliest"], data["worlds"]) == (1, [])
    assert data["maneuvers"][0]["chances"]["clear"] == 1


def test_what_is_mirrored_is_said(tmp_path, capsys):
    """The sample's traffic keeps to the right, gb's to the left."""
    scene = ["docs/samples/following.xml", "--ego", "1"]
    line = "mirrored recorded where traffic keeps to the right, judged as if it kept to the left"
    assert main(["maneuvers", *scene, "-r", "gb"]) == 0
    assert line in unwrapped(capsys.readouterr().out)
    assert main(["maneuvers", *scene, "-r", "gb", "-r", "de", "--json"]) == 0
    british, german = map(json.loads, capsys.readouterr().out.splitlines())
    assert (british["scene"]["mirrored"], german["scene"]["mirrored"]) == (True, False)
    table = tmp_path / "bounds.csv"
    assert main(["maneuvers", "--envelopes", *scene, "-r", "gb", "-o", str(table)]) == 0
    assert "mirrored: d is positive to the right" in capsys.readouterr().err
    for picture in ("scene", "graph"):
        drawing = tmp_path / f"{picture}.svg"
        assert main(["draw", picture, *scene, "-r", "gb", "-o", str(drawing)]) == 0
        assert "mirror image" in drawing.read_text()
        assert main(["draw", picture, *scene, "-r", "de", "-o", str(drawing)]) == 0
        assert "mirror image" not in drawing.read_text()
