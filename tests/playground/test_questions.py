"""What the page asks of rulec, asked of a Python that has no more than the page's own."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rulec
from tools.playground.__main__ import samples
from tools.playground.parts import HERE, LIBRARIES

ROOT = Path(__file__).resolve().parents[2]
NATIVE = re.findall(r"^(\w+)==", (HERE / "requirements.txt").read_text(), re.MULTILINE)

BROWSER = """
import json, os, sys
from importlib.machinery import BuiltinImporter, FrozenImporter, PathFinder
known = {*json.loads(sys.argv[1]), *sys.stdlib_module_names} - {"resource", "_multiprocessing"}

class Finder:
    def find_spec(self, name, path=None, target=None):
        found = name.partition(".")[0] in known
        return PathFinder.find_spec(name, path, target) if found else None

sys.meta_path[:] = [BuiltinImporter, FrozenImporter, Finder()]
sys.platform = "emscripten"
del os.geteuid
from tools.playground.questions import answer
for line in sys.stdin:
    print(answer(line), flush=True)
"""


class Browser:
    """The page's Python: a process that imports what the page has, and starts no other."""

    def __init__(self, folder):
        known = json.dumps(["rulec", "tools", *LIBRARIES, *NATIVE])
        self.process = subprocess.Popen(
            [sys.executable, "-c", BROWSER, known],
            cwd=folder,
            env={"PYTHONPATH": str(ROOT / "src"), "HOME": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def ask(self, kind, **question):
        print(json.dumps({"ask": kind, **question}), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    started = Browser(tmp_path_factory.mktemp("page"))
    yield started
    started.process.communicate()
    assert started.process.returncode == 0


SAMPLES = {sample["title"]: sample for sample in samples()}
ATLANTIS = SAMPLES["A country: Atlantis"]
MISTAKEN = SAMPLES["Atlantis, with a mistake"]


def test_a_sample_has_its_messages(browser):
    assert browser.ask("check", source=ATLANTIS["source"]) == {"result": []}
    (finding,) = browser.ask("check", source=MISTAKEN["source"])["result"]
    assert finding["code"] == "R0202"
    assert finding["place"]["file"] == "atlantis.rules"
    assert (finding["place"]["line"], finding["place"]["column"]) == (9, 18)


def test_examples_run(browser):
    run = browser.ask("test", source=ATLANTIS["source"])["result"]
    labels = {one["label"] for one in run["examples"] if one["rule"] == "passing_cyclists"}
    assert labels == {"enough room", "still behind", "too close"}
    assert run["failed"] == 0
    wrong = SAMPLES["A first rule"]["source"].replace("reject", "accept")
    run = browser.ask("test", source=wrong)["result"]
    assert [one["passed"] for one in run["examples"]] == [True, False]


def test_traces_are_judged_and_explained(browser):
    question = {"source": ATLANTIS["source"], "traces": ATLANTIS["traces"]}
    cyclist, tram = browser.ask("judge", book="", **question)["result"]
    (violation,) = cyclist["violations"]
    assert (violation["rule"], violation["step"]) == ("passing_cyclists", 1)
    facts = {fact["reads"]: fact["values"] for fact in violation["explanation"]["facts"]}
    assert facts == {"station(c1)": ["behind", "beside"], "lateral_gap(c1)": [10.0, 1.2]}
    assert [one["rule"] for one in tram["violations"]] == ["boarding_passengers"]


def test_a_table_of_traces_is_read_too(browser):
    table = (
        "trace,step,object,type,position\n1,0,v1,vehicle,b\n1,1,v1,vehicle,r\n1,2,v1,vehicle,f\n"
    )
    question = {"source": SAMPLES["A first rule"]["source"], "book": ""}
    (verdict,) = browser.ask("judge", traces=table, **question)["result"]
    assert verdict["satisfied"] is False


def test_countries_are_compared_with_a_witness(browser):
    question = {"source": "", "first": "de", "second": "nl", "rule": "bus_leaving"}
    (pair,) = browser.ask("compare", **question)["result"]["rules"]
    assert pair["relation"] == "stricter"
    (witness,) = pair["first_forbids"]
    assert [state["station"]["b"] for state in witness["states"]] == ["behind", "beside"]
    assert [state.get("speed", 0) for state in witness["states"]] == [20, 20]


def test_rules_are_said_in_english_and_a_text_is_tidied(browser):
    source = SAMPLES["A first rule"]["source"]
    (rule,) = browser.ask("rules", source=source)["result"]["rules"]
    assert rule["sentence"].startswith("For every vehicle v")
    assert browser.ask("format", source=source.replace("  cite", "cite"))["result"] == source


def test_a_source_that_ships_can_be_edited(browser):
    shipped = (ROOT / "rulebooks/de/de.rules").read_text(encoding="utf-8")
    assert browser.ask("source", name="de") == {"result": shipped}


def test_what_is_wrong_is_an_answer_too(browser):
    answer = browser.ask("test", source=MISTAKEN["source"])
    assert [finding["code"] for finding in answer["findings"]] == ["R0202"]
    broken = {"source": ATLANTIS["source"], "book": "", "traces": '{"id": 1'}
    (verdict,) = browser.ask("judge", **broken)["result"]
    assert verdict["findings"][0]["code"] == "R0501"


def test_a_violation_is_told_in_words_and_what_would_have_kept_the_rule(browser):
    question = {"source": ATLANTIS["source"], "traces": ATLANTIS["traces"]}
    cyclist, _ = browser.ask("judge", book="", **question)["result"]
    told = cyclist["violations"][0]["explanation"]
    assert told["in_words"] == (
        "at state 1: ego is beside c1 and the lateral gap from ego to c1 is 1.2 m"
    )
    assert told["kept_if"] == ["kept if state 1 says: not beside(c) or lateral_gap(c) >= 1.5 m"]
    margins = {part["formula"]: part["margins"] for part in told["parts"]}
    assert margins["lateral_gap(c) < 1.5 m"] == ["10.0 >= 1.5", "1.2 < 1.5"]
    assert margins["beside(c)"] == []


GAP = """\
rulebook gap
use road
hard rule keep_off(c: cyclist) {
  require never (beside(c) and lateral_gap(c) < 1.5 m)
}
"""


def test_of_a_trace_of_which_not_all_is_known_is_said_what_it_depends_on(browser):
    trace = {
        "objects": {"c1": "cyclist"},
        "states": [{"station": {"c1": None}, "lateral_gap": {"c1": 1}}],
    }
    question = {"source": GAP, "book": "", "traces": json.dumps(trace)}
    (verdict,) = browser.ask("judge", **question)["result"]
    assert verdict["satisfied"] is None
    (doubt,) = verdict["open"]
    assert (doubt["rule"], doubt["binding"]) == ("keep_off", {"c": "c1"})
    assert doubt["depends_on"] == ["station"]
    assert doubt["in_words"].startswith("open, depends on station: violated if station = beside")
    untold = {**trace, "told": ["lateral_gap"], "states": [{"lateral_gap": {"c1": 1}}]}
    (verdict,) = browser.ask("judge", **{**question, "traces": json.dumps(untold)})["result"]
    assert [(one["rule"], one["untold"]) for one in verdict["not_judged"]] == [
        ("keep_off", ["station"])
    ]


def test_a_trace_that_is_cut_may_still_keep_a_duty(browser):
    duty = "rulebook duty\nsignal horn\nhard rule honk { require eventually horn }\n"
    trace = '{"objects": {}, "ends": "cut", "states": [{"horn": false}]}'
    (verdict,) = browser.ask("judge", source=duty, book="", traces=trace)["result"]
    assert [one["because"] for one in verdict["open"]] == [["not over"]]


def test_numbers_within_bounds_are_explained_too(browser):
    trace = {
        "objects": {"c1": "cyclist"},
        "states": [{"station": {"c1": "beside"}, "lateral_gap": {"c1": {"from": 1.0, "to": 1.4}}}],
    }
    question = {"source": GAP, "book": "", "traces": json.dumps(trace)}
    (verdict,) = browser.ask("judge", **question)["result"]
    (violation,) = verdict["violations"]
    (gap,) = [fact for fact in violation["explanation"]["facts"] if "lateral" in fact["reads"]]
    assert gap["values"] == [{"from": 1.0, "to": 1.4}]


SEVERAL = SAMPLES["Three files: words, a depot, and one upon it"]
DEPOT = {"source": SEVERAL["source"], "others": json.loads(SEVERAL["others"])}


def test_a_rulebook_builds_upon_other_files(browser):
    assert browser.ask("check", **DEPOT) == {"result": []}
    assert browser.ask("test", **DEPOT)["result"]["passed"] == 4
    for book, satisfied in (("", False), ("depot.rules", True)):
        (verdict,) = browser.ask("judge", book=book, traces=SEVERAL["traces"], **DEPOT)["result"]
        assert verdict["satisfied"] is satisfied
    pairs = browser.ask("compare", first="", second="depot.rules", rule="", **DEPOT)["result"]
    assert [pair["relation"] for pair in pairs["rules"]] == ["stricter", "equal"]
    words, depot = DEPOT["others"]
    assert browser.ask("check", source=words, others=[depot]) == {"result": []}
    (finding,) = browser.ask("check", source=DEPOT["source"], others=[words])["result"]
    assert "depot" in finding["message"]


def test_a_compiled_rulebook_judges(browser, tmp_path):
    folder = tmp_path / "books"
    folder.mkdir()
    (folder / "yard.rules").write_text(DEPOT["others"][0])
    (folder / "depot.rules").write_text(DEPOT["others"][1])
    rulec.write_compiled(rulec.compile(folder / "depot.rules"), tmp_path)
    question = {"source": "", "traces": SEVERAL["traces"].replace("8", "11")}
    compiled = {"depot.json": (tmp_path / "depot.json").read_text()}
    (verdict,) = browser.ask("judge", book="depot.json", compiled=compiled, **question)["result"]
    assert [one["rule"] for one in verdict["violations"]] == ["keep_to_the_limit"]
    broken = browser.ask("judge", book="depot.json", compiled={"depot.json": "{}"}, **question)
    assert broken["findings"]


def test_a_mistake_of_its_own_is_told(browser):
    assert "KeyError" in browser.ask("source")["failure"]
