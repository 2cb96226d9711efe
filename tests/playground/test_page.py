"""The playground as somebody uses it, in headless Chromium."""

import json
import os
import re
import shutil
import subprocess
from contextlib import contextmanager
from pathlib import Path

import pytest

from tools.playground.parts import HERE

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
TUTORIAL = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
DRIVES = re.search(r"^```json\n(.*?)^```", TUTORIAL, re.MULTILINE | re.DOTALL)[1]

pytestmark = pytest.mark.long


class Page:
    """The page, by what is written on it."""

    def __init__(self, page):
        self.page = page
        self.source = page.get_by_role("textbox", name="Rulebook")

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
        self.page.get_by_label("What was driven").fill(traces)

    def compare(self, first, second, rule):
        self.ask("Compare")
        for label, value in (("Is", first), ("stricter than", second)):
            self.page.get_by_label(label, exact=True).select_option(value)
        self.page.get_by_label("in rules called").fill(rule)
        self.page.get_by_role("button", name="Compare").click()


@contextmanager
def opened(chromium, address, fragment="", **settings):
    """The page, ready; it has called nobody but its own server, and had no error."""
    context = chromium.new_context(**settings)
    page = context.new_page()
    called, errors = [], []
    context.on("request", lambda request: called.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    page.goto(address + fragment)
    shown = Page(page)
    shown.expect("#state").to_have_text("Ready")
    yield shown
    assert errors == []
    assert [url for url in called if not url.startswith((address, "data:", "blob:"))] == []
    context.close()


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
    fragment = page.page.url.removeprefix(address)
    with opened(chromium, address, fragment) as other:
        assert other.source.input_value() == rulebooks(TUTORIAL)[-1]
        other.expect("#judge .summary").to_have_text("2 traces: 0 satisfied, 2 violated")


@pytest.mark.parametrize("fragment", ["#1.AAAA", "#2.x", "#1.€", "#1."])
def test_a_broken_link_is_named(page, fragment):
    page.page.evaluate("(hash) => { location.hash = hash }", fragment)
    page.expect("#state").to_contain_text("The link cannot be read")


def test_what_takes_too_long_can_be_stopped(page):
    page.compare("de", "us-ca", "")
    page.page.get_by_role("button", name="Stop").click()
    page.expect("#compare .summary").to_have_text("Stopped.")
    page.expect("#state").to_have_text("Ready")
    page.compare("de", "nl", "bus_leaving")
    page.expect("#compare .result").to_contain_text("de is stricter")


def test_everything_can_be_done_from_the_keyboard(chromium, address):
    with opened(chromium, address) as page:
        keys = page.page.keyboard
        order = []
        for _ in range(8):
            keys.press("Tab")
            order.append(page.page.evaluate("() => document.activeElement.id"))
        assert order[:4] == ["start", "tidy", "share", "source"]
        assert "tab-test" in order[4:]
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


SCREENS = {"desktop": {"width": 1280, "height": 800}, "phone": {"width": 375, "height": 740}}


@pytest.fixture(scope="session")
def axe(tmp_path_factory):
    """The rules for accessible pages of Deque's axe."""
    folder = tmp_path_factory.mktemp("axe")
    for name in ("package.json", "package-lock.json"):
        shutil.copy(HERE / name, folder)
    subprocess.run(["npm", "ci", "--ignore-scripts", "--silent"], cwd=folder, check=True)
    return (folder / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("screen", SCREENS)
def test_the_page_is_accessible_and_fits(chromium, address, axe, screen, theme):
    settings = {
        "viewport": SCREENS[screen],
        "color_scheme": theme,
        "has_touch": screen == "phone",
        "is_mobile": screen == "phone",
    }
    with opened(chromium, address, **settings) as page:
        page.page.get_by_label("Start from").select_option("Atlantis, with a mistake")
        page.expect("#count").to_have_text("1 error")
        check(page, axe, f"{screen}-{theme}-messages")
        page.page.get_by_label("Start from").select_option("A country: Atlantis")
        page.expect("#test .summary").to_contain_text("0 failed")
        check(page, axe, f"{screen}-{theme}-examples")
        page.ask("Traces")
        page.expect("#judge .summary").to_contain_text("2 violated")
        check(page, axe, f"{screen}-{theme}-traces")
        page.compare("de", "nl", "bus_leaving")
        page.expect("#compare .result").to_contain_text("de is stricter")
        check(page, axe, f"{screen}-{theme}-compare")


def check(page, axe, name):
    """No rule of axe is broken, nothing is wider than the screen; RULEC_SCREENSHOTS keeps it."""
    if "RULEC_SCREENSHOTS" in os.environ:
        picture = Path(os.environ["RULEC_SCREENSHOTS"], f"{name}.png")
        page.page.screenshot(path=picture, full_page=True)
    found = page.page.evaluate(f"async () => {{ {axe}; return await axe.run() }}")
    broken = [(one["id"], [node["target"] for node in one["nodes"]]) for one in found["violations"]]
    assert broken == [], json.dumps(broken)
    assert page.page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
