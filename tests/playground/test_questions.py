"""What the page asks of rulec, asked of a Python that has no more than the page's own."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tools.playground.__main__ import samples
from tools.playground.parts import HERE, LIBRARIES

ROOT = Path(__file__).resolve().parents[2]
NATIVE = re.findall(r"^(\w+)==", (HERE / "requirements.txt").read_text(), re.MULTILINE)

BROWSER = """
import json, sys
from importlib.machinery import BuiltinImporter, FrozenImporter, PathFinder
known = {*json.loads(sys.argv[1]), *sys.stdlib_module_names} - {"resource", "_multiprocessing"}

class Finder:
    def find_spec(self, name, path=None, target=None):
        found = name.partition(".")[0] in known
        return PathFinder.find_spec(name, path, target) if found else None

sys.meta_path[:] = [BuiltinImporter, FrozenImporter, Finder()]
sys.platform = "emscripten"
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
            env={"PYTHONPATH": str(ROOT / "src")},
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
    # As the README shows it.
    assert [state.get("speed", 0) for state in witness["states"]] == [0, 1]


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


def test_a_trace_of_which_not_all_is_known_is_refused(browser):
    trace = '{"objects": {"c1": "cyclist"}, "states": [{"lateral_gap": {"c1": null}}]}'
    question = {"source": ATLANTIS["source"], "book": "", "traces": trace}
    assert "`rulec verify`" in browser.ask("judge", **question)["refused"]


def test_a_mistake_of_its_own_is_told(browser):
    assert "KeyError" in browser.ask("source")["failure"]
