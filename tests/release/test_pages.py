"""What is wrong with a page is found: dead links, errors, calls to others, too wide a table."""

import subprocess
import sys

import pytest

from tools.browser.links import followed
from tools.browser.served import served
from tools.browser.visit import SCREENS, opened

SITE = {
    "index.html": '<h1 id="top">Front</h1><a href="#top">up</a><a href="more/#end">on</a>'
    '<a href="https://example.org/gone">elsewhere</a>',
    "more/index.html": '<p id="end"></p><a href="../index.html#nowhere">back</a>'
    '<img src="picture.svg#svgView(viewBox(0,0,1,1))"><a href="gone.html">on</a>',
    "more/picture.svg": '<svg xmlns="http://www.w3.org/2000/svg"/>',
    "lonely.html": "<p>Nobody leads here.</p>",
}


@pytest.fixture
def site(tmp_path):
    for name, text in SITE.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    with served(tmp_path) as address:
        yield address


def test_links_are_followed_from_the_front_page(site):
    found = followed(f"{site}index.html".removesuffix("index.html"))
    assert found.pages == [site, f"{site}more/", f"{site}index.html"]
    assert found.faults == [
        f"{site}more/: {site}more/gone.html is not there",
        f"{site}more/: {site}index.html has no place #nowhere",
    ]


GOOD = '<meta name="viewport" content="width=device-width"><p>Good.</p>'
BAD = {
    "error": ("<script>undefined_name()</script>", "undefined_name"),
    "console": ("<script>console.error('not well')</script>", "not well"),
    "missing": ('<img src="gone.png">', "404"),
    "elsewhere": ('<img src="http://127.0.0.2:9/picture.png">', "it calls http://127.0.0.2:9/"),
    "wide": ('<div style="width: 600px">wide</div>', "the page is 6"),
}


def faults(chromium, folder, text, screen):
    (folder / "index.html").write_text(f"<link rel=icon href='data:,'>{text}", encoding="utf-8")
    with served(folder) as address, opened(chromium, address, screen) as visit:
        visit.page.wait_for_load_state("networkidle")
        visit.refuse_wide()
    return visit.faults


@pytest.mark.long
@pytest.mark.parametrize("screen", SCREENS, ids=str)
def test_a_good_page_has_no_fault(chromium, tmp_path, screen):
    assert faults(chromium, tmp_path, GOOD, screen) == []


@pytest.mark.long
@pytest.mark.parametrize("kind", BAD)
def test_a_fault_of_a_page_is_found(chromium, tmp_path, kind):
    text, says = BAD[kind]
    found = faults(chromium, tmp_path, GOOD + text, SCREENS[-1])
    assert any(says in fault for fault in found), found
    if kind == "wide":
        assert faults(chromium, tmp_path, GOOD + text, SCREENS[0]) == []


UNSTARTED = """
import sys
from pathlib import Path
from tools.browser import chromium
from tools.programs import MissingPartError

chromium._installed = lambda: Path(sys.argv[1])
try:
    with chromium.chromium():
        pass
except MissingPartError as error:
    print(error)
"""


@pytest.mark.long
def test_a_browser_that_does_not_start_is_a_missing_part(tmp_path):
    (tmp_path / "chromium").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "chromium").chmod(0o755)
    command = [sys.executable, "-c", UNSTARTED, tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("Chromium does not start: ")
