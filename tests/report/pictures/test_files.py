"""Files: SVG that can be read, PNG that shows something, a page that fetches nothing."""

import io
import re
import sys
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import pytest

from rulec.diagnostics import RulecError
from rulec.report.pictures.drawing.canvas import Area, LabelText, Picture, Polyline, corners
from rulec.report.pictures.drawing.picture_formats import Drawing, as_bytes
from support.oracles.page_policy import check_policy

SVG = "{http://www.w3.org/2000/svg}"


def drawing(number=2):
    square = Area((corners((10, 10, 60, 50)), corners((20, 20, 30, 30))), "chosen", "a <cell>")
    line = Polyline(((0, 0), (100, 60)), "rejected")
    words = LabelText("b & $f$", (50, 30), "middle")
    turned = LabelText("up", (80, 30), "middle", turned=True)
    pictures = [
        Picture(f"{n} s to {n + 1} s", 120, 70, (square, line, words, turned))
        for n in range(number)
    ]
    return Drawing(
        "A title", pictures, Picture("", 120, 20, (LabelText("what it means", (0, 10)),))
    )


def test_a_halo_is_drawn_before_its_words_for_viewers_that_know_no_order_of_painting():
    words = LabelText("ego", (50, 30), style="name")
    svg = as_bytes(Drawing("", [Picture("", 120, 70, (words,))]), "svg", "f").decode()
    halo, above = [one for one in ET.fromstring(svg).iter(f"{SVG}text") if one.text == "ego"]
    assert (halo.get("class"), above.get("class")) == ("name halo", "name")
    assert halo.get("aria-hidden") == "true"
    rules = dict(re.findall(r"^(\.name\S*) \{ (.*) \}$", svg, re.MULTILINE))
    assert "stroke" in rules[".name.halo"]
    assert "stroke" not in rules[".name"]


@pytest.mark.parametrize("pictures", [1, 2])
def test_a_page_allows_its_own_style_and_script_alone(pictures):
    check_policy(as_bytes(drawing(pictures), "html", "f").decode())


def test_svg():
    root = ET.fromstring(as_bytes(drawing(), "svg", "f"))
    texts = [one.text for one in root.iter(f"{SVG}text")]
    assert texts == ["A title", "b & $f$", "up", "b & $f$", "up", "what it means"]
    paths = list(root.iter(f"{SVG}path"))
    assert [one.get("class") for one in paths] == ["chosen"] * 2
    assert paths[0].find(f"{SVG}title").text == "a <cell>"
    assert paths[0].get("d").count("M") == 2
    # The second picture stands below the first, all below the title.
    tops = [float(re.match(r"M[\d.]+,([\d.]+)", one.get("d"))[1]) for one in paths]
    assert tops[1] - tops[0] == 70
    assert root.get("height") == str(14 + 16 + 2 * 70 + 20)


@pytest.mark.parametrize("form", ["svg", "png", "html"])
def test_the_same_bytes_every_time(form):
    pytest.importorskip("matplotlib")
    assert as_bytes(drawing(), form, "f") == as_bytes(drawing(), form, "f")


def pixels(data):
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    return imread(io.BytesIO(data))


def test_png():
    image = pixels(as_bytes(drawing(1), "png", "f"))
    assert image.shape[:2] == (2 * (14 + 16 + 70 + 20), 2 * 120)
    white, chosen = (1, 1, 1), (0xA9 / 255, 0xD5 / 255, 0xF2 / 255)

    def at(x, y):
        return tuple(image[2 * (30 + y), 2 * x, :3])

    assert at(5, 60) == white
    assert at(15, 40) == pytest.approx(chosen, abs=0.01)
    assert at(22, 28) == white, "holes are not filled"


def test_any_letters_and_long_titles():
    pytest.importorskip("matplotlib")
    words = LabelText("漢字 \x07 \U0001f600", (10, 10))
    strange = Drawing("a title of many words " * 30, [Picture("", 400, 40, (words,))])
    assert as_bytes(strange, "png", "f.png")
    texts = [one.text for one in ET.fromstring(as_bytes(strange, "svg", "f")).iter(f"{SVG}text")]
    assert " ".join(texts[:-1]) == strange.title.strip()
    assert max(map(len, texts)) * 7.3 <= 400
    assert texts[-1] == "漢字 \\x07 \U0001f600"


def test_a_png_that_is_too_large_is_refused():
    pytest.importorskip("matplotlib")
    tall = Drawing("t", [Picture("", 100, 30_000, ())])
    with pytest.raises(RulecError) as caught:
        as_bytes(tall, "png", "f.png")
    assert caught.value.diagnostics[0].code == "R0707"
    assert as_bytes(tall, "svg", "f.svg")


def test_without_matplotlib_there_is_a_way_out(monkeypatch):
    drawing_room = as_bytes.__module__.rpartition(".")[0]
    monkeypatch.delitem(sys.modules, f"{drawing_room}.matplotlib_file", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(RulecError) as caught:
        as_bytes(drawing(), "png", "f.png")
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.place.file) == ("R0707", "f.png")
    assert "[pictures]'`" in problem.help
    assert as_bytes(drawing(), "html", "f.html")


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.open = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in ("meta", "input"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_a_page_is_whole_and_fetches_nothing():
    text = as_bytes(drawing(), "html", "f").decode()
    page = Page(text)
    assert page.open == []
    assert page.tags.count("figure") == 2
    assert page.tags.count("svg") == 3
    assert not {"src", "href", "srcset"} & {name for name, _ in page.attributes}
    assert not re.findall(r"url\(|@import|fetch\(|XMLHttp", text)
    assert set(re.findall(r"https?://[^\"' ]*", text)) == {"http://www.w3.org/2000/svg"}
    ids = [value for name, value in page.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    assert "prefers-color-scheme: dark" in text
    assert "@media print" in text


def test_a_single_picture_needs_no_slider():
    page = Page(as_bytes(drawing(1), "html", "f").decode())
    assert "input" not in page.tags
    assert "script" not in page.tags
