"""The documentation builds into a site, every link in it leads somewhere, nothing is left out."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from rulec.cli.main import VERBS, rulec

pytest.importorskip("sphinx")

ROOT = Path(__file__).resolve().parents[2]


SPHINX = """
import gc, sys
from sphinx.builders.html import StandaloneHTMLBuilder
from sphinx.cmd.build import main

gc.set_threshold(400_000)  # pages stay, and need not be looked through so often
StandaloneHTMLBuilder.search = False  # its index takes an eighth of the time
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    options = ["-W", "--keep-going", "-q", "-b", "html"]
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            SPHINX,
            *options,
            "-d",
            folder / "doctrees",
            ROOT / "docs",
            folder / "html",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder / "html"


class Page(HTMLParser):
    """What a page of the site has: targets, links from its text within the site, and the text."""

    def __init__(self, path):
        super().__init__()
        self.ids, self.links, self.text = set(), [], ""
        self.inside = False
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids.add(values.get("id"))
        self.inside |= tag == "article"
        if self.inside and "internal" in values.get("class", "").split():
            self.links.append(values["href"])

    def handle_endtag(self, tag):
        self.inside &= tag != "article"

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def pages(site):
    return {path.name: Page(path) for path in site.glob("*.html")}


def test_every_page_is_on_the_site(pages):
    assert {f"{page.stem}.html" for page in (ROOT / "docs").glob("*.md")} <= set(pages)


def test_every_link_within_the_site_leads_somewhere(pages, site):
    for name, page in pages.items():
        for link in page.links:
            target, _, place = link.partition("#")
            assert (site / target).exists(), (name, link)
            if not target:
                assert place in page.ids, (name, link)
            elif place:
                assert place in pages[target].ids, (name, link)


def test_every_verb_and_its_options_are_described(pages):
    for verb in VERBS:
        assert f"rulec-{verb}" in pages["commands.html"].ids
        for parameter in rulec.get_command(None, verb).params:
            wanted = f"cmdoption-rulec-{verb}-"
            if parameter.param_type_name == "option":
                wanted += parameter.opts[-1].lstrip("-")
                assert wanted in pages["commands.html"].ids


def test_every_public_name_is_described(pages):
    import rulec

    described = [name for name in rulec.__all__ if name not in ("__version__", "UNKNOWN")]
    assert {f"rulec.{name}" for name in described} <= pages["python.html"].ids


def test_every_rule_of_the_grammar_is_shown(pages):
    text = (ROOT / "grammar" / "rulec.lark").read_text(encoding="utf-8")
    rules = set(re.findall(r"^\??([a-z_]+):", text, re.MULTILINE)) - {"item"}
    assert {f"grammar-token-{name.replace('_', '-')}" for name in rules} <= {
        one.replace("_", "-") for one in pages["grammar.html"].ids if one
    }
    # Words are spelled: of the tokens only those that the page explains keep their names.
    shown = pages["grammar.html"].text.partition("rulebook_file")[2]
    assert '"weak until"' in shown
    assert set(re.findall(r"\b[A-Z]{3,}\b", shown)) <= set(
        re.findall(r"^\| `([A-Z]+)`", (ROOT / "docs" / "grammar.md").read_text(), re.MULTILINE)
    )


def test_rulebooks_are_coloured(site):
    text = (site / "language.html").read_text(encoding="utf-8")
    assert re.search(r'<span class="kd">rulebook</span>', text)
