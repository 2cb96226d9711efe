"""The playground as somebody uses it, in headless Chromium."""

import json
import os
import re
from contextlib import contextmanager
from pathlib import Path

import pytest

import rulec
from tools.browser import visit
from tools.browser.chromium import accessibility_rules
from tools.browser.visit import SCREENS
from tools.programs import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
TUTORIAL = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
DRIVES = re.search(r"^```json\n(.*?)^```", TUTORIAL, re.MULTILINE | re.DOTALL)[1]

pytestmark = pytest.mark.long


class Page:
    """The page, by what is written on it."""

    def __init__(self, seen):
        self.seen, self.page = seen, seen.page
        self.source = seen.page.get_by_role("textbox", name="Rulebook")

    def expect(self, selector):
        from playwright.sync_api import expect

        return expect(self.page.locator(selector))

    def write(self, source):
        self.source.fill(source)

    def ask(self, tab):
        self.page.get_by_role("tab", name=tab).click()

    def judge(self, traces, book="this rulebook"):
        self.ask("Traces")
        self.page.get_by_label("Judged by").select_option(book)
        self.page.get_by_label("Traces: one per line").fill(traces)

    def compare(self, first, second, rule):
        self.ask("Compare")
        for label, value in (("Is", first), ("stricter than", second)):
            self.page.get_by_label(label, exact=True).select_option(value)
        self.page.get_by_label("in rules called").fill(rule)
        self.page.get_by_role("button", name="Compare").click()


@contextmanager
def opened(chromium, address, screen=SCREENS[0]):
    """The page, ready; it has called nobody but its own server, and had no error."""
    with visit.opened(chromium, address, screen) as seen:
        shown = Page(seen)
        shown.expect("#state").to_have_text("Ready")
        yield shown
        assert seen.faults == []


@pytest.fixture(scope="module")
def page(chromium, address):
    with opened(chromium, address) as shown:
        yield shown


def rulebooks(text):
    return re.findall(r"^```rulec[^\n]*\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


SOURCES = [*rulebooks(README), *rulebooks(TUTORIAL)]
MISTAKEN = [source for source in SOURCES if "besides" in source]


@pytest.mark.parametrize("source", [source for source in SOURCES if source not in MISTAKEN])
def test_every_example_of_the_readme_and_the_tutorial_comes_out(page, source):
    page.ask("Examples")
    page.write(source)
    page.expect("#count").to_have_text("nothing found")
    labels = re.findall(r"^  (?:accept|reject)", source, re.MULTILINE)
    page.expect("#test .summary").to_have_text(re.compile(r"\d+ examples: \d+ passed, 0 failed"))
    page.expect("#test .result > ul .pass").to_have_count(len(labels))


def test_the_tutorials_mistake_is_shown_where_it_is(page):
    (source,) = MISTAKEN
    page.write(source)
    page.expect("#count").to_have_text("1 error")
    page.expect("#found li").to_contain_text("error R0202: nothing is called besides")
    page.expect("#found li").to_contain_text("Help: did you mean beside?")
    page.expect("#shown .error").to_have_text("besides")
    page.page.get_by_role("button", name="line 9").click()
    selected = page.page.evaluate(
        "() => { const at = document.getElementById('source');"
        " return at.value.slice(at.selectionStart, at.selectionEnd) }"
    )
    assert selected == "besides"
    page.page.keyboard.type("beside")
    page.expect("#count").to_have_text("nothing found")


def test_traces_of_the_readme_are_judged_and_explained(page):
    page.write(rulebooks(README)[0])
    page.judge((ROOT / "docs/samples/traces.jsonl").read_text(encoding="utf-8"), "esterle2019")
    page.expect("#judge .summary").to_have_text("2 traces: 1 satisfied, 1 violated")
    page.expect("#judge .violation").to_contain_text("R1 [Article 11.1, 11.6] for v = v1")
    page.expect("#judge .violation").to_contain_text("cannot be kept any more after state 3")
    (row,) = page.page.locator("tr", has_text="position(v1)").all()
    assert row.inner_text().split() == ["position(v1)", "b", "r", "r", "f*"]


def test_a_rule_that_is_changed_changes_its_verdict(page):
    source = rulebooks(TUTORIAL)[-1]
    page.write(source)
    page.judge(DRIVES)
    page.expect("#judge .summary").to_have_text("2 traces: 0 satisfied, 2 violated")
    page.write(
        source.replace("param room_for_cyclists : length = 1.5 m", "")
        .replace("room_for_cyclists", "1.1 m")
        .replace("= 1.4 m", "= 1 m")
    )
    page.expect("#judge .summary").to_have_text("2 traces: 1 satisfied, 1 violated")
    page.judge(DRIVES, "vienna")
    page.expect("#judge .summary").to_have_text("2 traces: 2 satisfied, 0 violated")


def test_a_violation_is_told_with_margins_and_what_would_have_kept_the_rule(page):
    page.write(rulebooks(TUTORIAL)[-1])
    page.judge(DRIVES)
    page.expect("#judge .violation").to_have_count(2)
    first = page.page.locator("#judge .violation").first
    assert "at state 1: ego is beside c1 and the lateral gap from ego to c1" in first.inner_text()
    (kept,) = first.locator(".repair").all_inner_texts()
    assert kept.startswith("kept if state 1 says: not beside(c) or lateral_gap(c) >=")
    (row,) = first.locator("tbody tr", has_text="lateral_gap(c) <").last.all()
    assert row.locator("td").all_inner_texts() == ["F 10.0 >= 1.5", "T 1.2 < 1.5"]


def test_a_trace_with_unknown_values_is_open_and_says_on_what(page):
    page.write(rulebooks(README)[0])
    trace = {"objects": {"v1": "vehicle"}, "states": []}
    trace["states"] = [{"position": {"v1": place}} for place in ("b", None, "f")]
    page.judge(json.dumps(trace))
    page.expect("#judge .summary").to_have_text("1 trace: 0 satisfied, 0 violated, 1 open")
    page.expect("#judge h3").to_have_text("line 1: open")
    page.expect("#judge .open").to_contain_text("for v = v1: open, depends on position: violated")


def test_files_stand_side_by_side(page, chromium, address):
    page.page.get_by_label("Start from").select_option(
        "Three files: words, a depot, and one upon it"
    )
    group = page.page.get_by_role("group", name="Files")
    assert group.get_by_role("button").all_inner_texts() == [
        "yard.rules",
        "depot.rules",
        "depot_north.rules",
    ]
    page.expect("#count").to_have_text("nothing found")
    page.ask("Traces")
    page.expect("#judge .summary").to_have_text("1 trace: 0 satisfied, 1 violated")
    page.page.get_by_label("Judged by").select_option("depot.rules")
    page.expect("#judge .summary").to_have_text("1 trace: 1 satisfied, 0 violated")
    group.get_by_role("button", name="depot.rules").click()
    depot = page.source.input_value()
    assert depot.startswith("rulebook depot\n")
    page.page.get_by_label("Judged by").select_option("this rulebook")
    page.write(depot.replace("= 10 km/h", "= 7 km/h"))
    page.expect("#judge .summary").to_have_text("1 trace: 0 satisfied, 1 violated")
    with opened(chromium, page.page.url) as other:
        other.expect("#judge .summary").to_have_text("1 trace: 0 satisfied, 1 violated")
        assert other.page.locator("#files button").count() == 3
    page.page.get_by_role("button", name="yard.rules").click()
    page.page.get_by_role("button", name="Remove file").click()
    page.expect("#found").to_contain_text("yard")
    page.page.get_by_role("button", name="New file").click()
    assert page.source.input_value().startswith("vocabulary words1 {")
    page.expect("#count").to_have_text("nothing found")


def test_files_are_opened_compiled_ones_too(page, tmp_path):
    yard, depot, _ = rulebooks((ROOT / "docs/own_rulebooks.md").read_text(encoding="utf-8"))
    for name, text in (("yard", yard), ("depot", depot)):
        (tmp_path / f"{name}.rules").write_text(text, encoding="utf-8")
    (tmp_path / "ride.jsonl").write_text('{"objects": {}, "states": [{"speed": 11}]}')
    rulec.write_compiled(rulec.compile(tmp_path / "depot.rules"), tmp_path)
    page.page.get_by_label("Start from").select_option("A first rule")
    names = ("ride.jsonl", "depot.json")
    page.page.get_by_label("Open …").set_input_files([tmp_path / name for name in names])
    page.expect("#judge-book").to_have_value("depot.json")
    page.expect("#judge .violation").to_contain_text("keep_to_the_limit [Depot manual 4.1]")
    page.page.get_by_label("Open …").set_input_files(
        [tmp_path / "yard.rules", tmp_path / "depot.rules"]
    )
    page.expect("#files button").to_have_text(["quiet_lane.rules", "yard.rules", "depot.rules"])
    page.expect("#count").to_have_text("nothing found")


def test_countries_are_compared_and_the_witness_is_judged(page):
    page.compare("de", "nl", "bus_leaving")
    page.expect("#compare .summary").to_contain_text("1 shared rule: 1 stricter")
    page.expect("#compare .result").to_contain_text("de is stricter")
    page.page.get_by_role("button", name="Judge this trace").click()
    for book, says in (("de", "bus_leaving"), ("nl", "satisfied")):
        page.page.get_by_label("Judged by").select_option(book)
        page.expect("#judge .result").to_contain_text(says)


def test_rules_are_said_in_english_and_missing_examples_inserted(page):
    source = rulebooks(README)[0]
    page.write(source)
    page.ask("In English")
    page.expect("#rules .result").to_contain_text("For every vehicle v")
    page.ask("Examples")
    without = re.sub(r"^  reject.*\n", "", source, flags=re.MULTILINE)
    page.write(without)
    page.page.get_by_role("button", name="Insert it").first.click()
    page.expect("#test .summary").to_have_text("2 examples: 2 passed, 0 failed")
    page.source.press("Control+z")
    page.expect("#test .summary").to_have_text("1 example: 1 passed, 0 failed")


def test_a_link_has_all_that_is_on_the_page(page, chromium, address):
    page.write(rulebooks(TUTORIAL)[-1])
    page.judge(DRIVES)
    page.page.get_by_role("button", name="Copy link").click()
    page.expect("#state").to_have_text(re.compile("^The link is"))
    with opened(chromium, page.page.url) as other:
        assert other.source.input_value() == rulebooks(TUTORIAL)[-1]
        other.expect("#judge .summary").to_have_text("2 traces: 0 satisfied, 2 violated")


@pytest.mark.parametrize("fragment", ["#1.AAAA", "#2.x", "#1.€", "#1."])
def test_a_broken_link_is_named(page, fragment):
    page.page.evaluate("(hash) => { location.hash = hash }", fragment)
    page.expect("#state").to_contain_text("The link cannot be read")


def test_what_takes_too_long_can_be_stopped(page):
    page.compare("es", "pl", "")
    page.page.get_by_role("button", name="Stop").click()
    page.expect("#compare .summary").to_have_text("Stopped.")
    page.expect("#state").to_have_text("Ready")
    page.compare("de", "nl", "bus_leaving")
    page.expect("#compare .result").to_contain_text("de is stricter")


def test_everything_can_be_done_from_the_keyboard(chromium, address):
    with opened(chromium, address) as page:
        keys = page.page.keyboard
        order = []
        for _ in range(10):
            keys.press("Tab")
            order.append(page.page.evaluate("() => document.activeElement.id"))
        assert order[:3] == ["start", "tidy", "share"]
        assert order[4:7] == ["add", "open", "source"]
        assert "tab-test" in order[7:]
        page.source.focus()
        keys.press("Control+End")
        keys.type("\nhard rule broken { require never surprise }")
        page.expect("#count").to_have_text("1 error")
        keys.press("Tab")
        keys.press("Enter")
        assert page.page.evaluate("() => document.activeElement.id") == "source"
        keys.press("Control+End")
        keys.press("Shift+Home")
        keys.press("Delete")
        page.expect("#count").to_have_text("nothing found")
        page.page.locator("#tab-test").focus()
        keys.press("ArrowRight")
        keys.press("ArrowRight")
        page.expect("#tab-compare").to_be_focused()
        page.expect("#compare").to_be_visible()
        page.page.get_by_label("in rules called").focus()
        keys.type("R1")
        keys.press("Enter")
        page.expect("#compare .summary").to_contain_text("shared rule")


def many_rules(number):
    """A rulebook of many rules, of whose examples each leaves an edge untried."""
    rules = "".join(
        f"hard rule keep_{n:02} {{\n  require never (busy and speed > {n + 1} km/h)\n"
        f"  accept {{ speed = {n} km/h }}\n}}\n"
        for n in range(number)
    )
    return f"rulebook many\nuse road\nsignal busy default false\n{rules}"


def test_what_is_long_is_folded_and_opened_from_the_keyboard(page):
    page.ask("Examples")
    page.write(many_rules(30))
    page.expect("#test .summary").to_have_text("30 examples: 30 passed, 0 failed")
    page.expect("#test .pass >> visible=true").to_have_count(10)
    rest = page.page.locator("#test summary", has_text="and 20 more that pass")
    rest.focus()
    page.page.keyboard.press("Enter")
    page.expect("#test .pass >> visible=true").to_have_count(30)
    page.write(many_rules(31))
    page.expect("#test .pass >> visible=true").to_have_count(31)
    missing = page.page.locator("#test summary", has_text="that no example covers")
    missing.focus()
    page.page.keyboard.press("Enter")
    page.page.get_by_role("button", name="Insert it").last.click()
    page.expect("#test .summary").to_have_text("32 examples: 32 passed, 0 failed")
    page.write(many_rules(12).replace("busy and", "bussy and"))
    page.expect("#count").to_have_text("12 errors")
    page.expect("#found > li").to_have_count(12)
    page.write(many_rules(30).replace("busy and", "bussy and"))
    page.expect("#count").to_have_text("30 errors")
    page.expect("#found > li:not(.more) >> visible=true").to_have_count(10)
    page.page.get_by_text("and 20 more messages").click()
    page.expect("#found .error >> visible=true").to_have_count(30)
    page.write(many_rules(30))
    page.judge(json.dumps({"objects": {}, "states": [{"busy": True, "speed": None}]}))
    page.expect("#judge .open >> visible=true").to_have_count(5)
    page.page.get_by_text("and 25 more that are open").click()
    page.expect("#judge .open >> visible=true").to_have_count(30)
    page.judge(json.dumps({"objects": {}, "states": [{"busy": True, "speed": 40}]}))
    page.expect("#judge .violation >> visible=true").to_have_count(5)
    page.page.get_by_text("and 25 more violations").click()
    page.expect("#judge .violation >> visible=true").to_have_count(30)
    page.ask("Examples")


@pytest.mark.parametrize("screen", SCREENS, ids=str)
def test_the_page_is_accessible_and_fits(chromium, address, screen):
    with opened(chromium, address, screen) as page:
        page.page.get_by_label("Start from").select_option("Atlantis, with a mistake")
        page.expect("#count").to_have_text("1 error")
        check(page, f"{screen}-messages")
        page.page.get_by_label("Start from").select_option("A country: Atlantis")
        page.expect("#test .summary").to_contain_text("0 failed")
        check(page, f"{screen}-examples")
        page.ask("Traces")
        page.expect("#judge .summary").to_contain_text("2 violated")
        check(page, f"{screen}-traces")
        page.compare("de", "nl", "bus_leaving")
        page.expect("#compare .result").to_contain_text("de is stricter")
        check(page, f"{screen}-compare")
        title = "Three files: words, a depot, and one upon it"
        page.page.get_by_label("Start from").select_option(title)
        page.judge('{"objects": {}, "states": [{"speed": null}, {"reversing": true}]}')
        page.expect("#judge .open").to_contain_text("depends on speed")
        check(page, f"{screen}-files")
        page.ask("Examples")
        page.write(many_rules(30))
        page.expect("#test .result").to_contain_text("and 20 more that pass")
        check(page, f"{screen}-folded")
        page.page.get_by_text("that no example covers").last.click()
        check(page, f"{screen}-opened")


def check(page, name):
    """No rule of axe is broken, nothing is wider than the screen; RULEC_SCREENSHOTS keeps it."""
    if "RULEC_SCREENSHOTS" in os.environ:
        picture = Path(os.environ["RULEC_SCREENSHOTS"], f"{name}.png")
        page.page.screenshot(path=picture, full_page=True)
    found = page.page.evaluate(f"async () => {{ {accessibility_rules()}; return await axe.run() }}")
    broken = [(one["id"], [node["target"] for node in one["nodes"]]) for one in found["violations"]]
    assert broken == [], json.dumps(broken)
    page.seen.refuse_wide()
