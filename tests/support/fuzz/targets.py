"""What is tried: for each kind of input, commands on an input with mistakes in it."""

import json
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import click

from rulec.cli.main import VERBS, main, rulec
from support.builders.compiled_files import sealed
from support.fuzz.mutators import STRANGE_WORDS, mutated_json, mutated_words

TOP = Path(__file__).resolve().parents[3]
LANE = """rulebook lane
use paper

hard rule no_passing (v: vehicle) {
  cite "Article 1"
  require always not (b(v) and eventually[<= 5 s] f(v)) unless CONGESTED
  accept  "stays"  { b(v); b(v) }
  reject  "passes" { b(v); l(v); f(v) }
}
soft rule calm weight 2 { require always not CONGESTED }
"""
SCENARIO = """horizon_s = 3
step_s = 1
[road]
s = [0, 60]
lanes = [-2, 2]
[ego]
s = 5
d = 0
[[obstacle]]
id = "1"
type = "vehicle"
length = 4
width = 2
s = 30
d = 0
speed = 2
"""
FORMULA = "(v: vehicle) always not (b(v) and eventually[<= 5 s] f(v))"


def in_words(verb, *arguments):
    """A command that has to succeed, since others are tried on what it makes."""
    status = main([verb, *map(str, arguments)])
    assert status in {0, 1}, (verb, arguments)


@dataclass(frozen=True)
class Workplace:
    """A folder with sound files of all kinds, to make mistakes in."""

    folder: Path

    def fill(self):
        """Write the files."""
        self.write("lane.rules", LANE)
        self.write("scenario.toml", SCENARIO)
        self.write("traces.jsonl", (TOP / "docs/samples/traces.jsonl").read_text())
        self.write("rulec.toml", 'search_path = ["books"]\n')
        (self.folder / "books").mkdir()
        in_words("compile", self.folder / "lane.rules", "--step", "1", "-o", self.folder / "out")
        findings = self.folder / "findings.jsonl"
        judged = self.folder / "traces.jsonl"
        in_words("verify", judged, "-r", "esterle2019", "--exposure", "-o", findings)
        return self

    def write(self, name, content):
        """Write a file, and return it."""
        file = self.folder / name
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(file)

    def text(self, name):
        """A sound file's text."""
        return (self.folder / name).read_text(encoding="utf-8")

    @cached_property
    def sources(self):
        """Programs in the language: good and bad ones, schemas and small books."""
        files = [*(TOP / "tests/programs").rglob("*.rules"), *(TOP / "rulebooks").rglob("*.rules")]
        texts = [file.read_bytes().decode("utf-8", "replace") for file in sorted(files)]
        return [LANE, *(text for text in texts if len(text) < 8_000)]


def sources(place, pick):
    """A rulebook or vocabulary."""
    text = mutated_words(pick.choice(place.sources), pick, place.sources)
    file = place.write("tried.rules", text)
    match pick.randrange(12):
        case 0:
            return ["tree", file]
        case 1:
            return ["show", file, "--output-format", "json"]
        case 2:
            return ["audit", file]
        case 3:
            return ["doc", file, "-o", str(place.folder / "doc.html")]
        case 4:
            return ["diff", file, str(place.folder / "lane.rules")]
        case 5 | 6:
            return ["fmt", "--diff", file]
        case _:
            return ["check", file]


def compiling(place, pick):
    """A rulebook that differs little from one that compiles."""
    file = place.write("tried.rules", mutated_words(LANE, pick, [LANE]))
    verb = pick.choice(("test", "analyze", "compile"))
    more = ["--step", "1", "-o", str(place.folder / "tried")] if verb == "compile" else []
    return [verb, file, *more]


def traces(place, pick):
    """Traces as JSON Lines."""
    file = place.write("tried.jsonl", mutated_json(place.text("traces.jsonl"), pick))
    return ["verify", file, "-r", "esterle2019", *pick.choice(([], ["--json"]))]


def compiled(place, pick):
    """A compiled rulebook."""
    text = mutated_json(place.text("out/lane.json"), pick)
    with suppress(ValueError, TypeError, AttributeError):
        # The digest is what all changes are found by, so most of them get one that fits.
        text = text if pick.random() < 0.2 else sealed(json.loads(text))
    file = place.write("tried.json", text)
    match pick.randrange(4):
        case 0:
            return ["verify-compiled", file]
        case 1:
            return ["show", file]
        case _:
            return ["verify", str(place.folder / "traces.jsonl"), "-r", file]


def scenarios(place, pick):
    """A scenario in TOML."""
    file = place.write("tried.toml", mutated_words(SCENARIO, pick, [SCENARIO]))
    drawn = str(place.folder / "scene.svg")
    return pick.choice((["draw", "scene", file, "-o", drawn], ["maneuvers", file]))


def settings(place, pick):
    """Settings of a project."""
    place.write("rulec.toml", mutated_words('search_path = ["books"]\n', pick, [SCENARIO]))
    return ["check", "lane.rules"]


def findings(place, pick):
    """Findings that rates are made of."""
    file = place.write("tried.jsonl", mutated_json(place.text("findings.jsonl"), pick))
    return ["rates", file]


def formulas(place, pick):
    """A formula that moments are sought for."""
    text = mutated_words(FORMULA, pick, [LANE])
    formula = text.decode("utf-8", "replace").replace("\0", "")
    return ["find", formula, str(place.folder / "traces.jsonl"), "-u", "paper"]


def arguments(place, pick):
    """Words after a verb."""
    verb = pick.choice(list(VERBS))
    command = rulec.get_command(click.Context(rulec), verb)
    options = [name for one in command.params for name in one.opts]
    files = ["lane.rules", "traces.jsonl", "out/lane.json", "scenario.toml", "books", "nowhere"]
    words = [*options, *(str(place.folder / name) for name in files), "esterle2019", "1", "-"]
    words += [word.replace("\0", "") for word in STRANGE_WORDS]
    return [verb, *(pick.choice(words) for _ in range(pick.randrange(6)))]


TARGETS = {
    of.__name__: of
    for of in (
        sources,
        compiling,
        traces,
        compiled,
        scenarios,
        settings,
        findings,
        formulas,
        arguments,
    )
}
