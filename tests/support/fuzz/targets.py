"""What is tried: for each kind of input, commands on an input with mistakes in it."""

import json
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import click
import pyarrow.csv
import pyarrow.parquet

from rulec.cli.main import main, rulec
from rulec.cli.verb_table import COMMANDS
from support.builders.compiled_files import sealed
from support.fuzz.mutators import STRANGE_WORDS, mutated_json, mutated_words
from support.fuzz.odd_worlds import odd_worlds
from support.fuzz.recorded_traffic import maps, recordings
from support.fuzz.signed_books import signatures
from support.generators.mutated_files import mutated_bytes

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
LAW = """# Road Act

## Article 1 Keeping right

(1) Drivers keep right. They do so, too, where Nr. 2 says so.
(2) Nobody passes
1. at zebras,
2. before bends.

## Article 2 Passing

(1) Who passes does so on the left.

## Annex 1 Signs

Sign 205 Give way
Sign 206 Stop
"""
BASE = """rulebook base
law "Treaty" as of 2020-01-01
signal p, q, r default false
topics { passing "Passing" of no_pass; lights "Lamps" }
hard rule no_pass { cite "Art. 2" require always (p implies q) unless r }
hard rule lamps { cite "Art. 1" topic lights require never (p then q then r) unless q at end }
"""
LISTED = """rulebook listed
law "Road Act" as of 2024-01-01
extends base
signal s default false
provisions "https://example.org/act" as of 2024-01-01 {
  "Article 1" "Keeping right" not machine-readable because "it asks for care";
  "Article 2" "Passing";
  "Annex 1" "Signs" silent because "no driving"
}
confirm rule lamps { cite "Article 1(1), (2) no. 1" certainty verified }
override rule no_pass { cite "Article 2(1) sentence 1" also unless s initially }
soft rule calm weight 2 { cite "Annex 1 sign 205" require always not p and q }
"""
TABLE = """trace,step,step_s,object,type,surface,position
a,0,1.0,,,R_cw,
a,0,1.0,v1,vehicle,,b
a,1,1.0,,,R_cw,
a,1,1.0,v1,vehicle,,f
"""
PAIRS = ("lamps=calm", "calm=lamps", "=", "a=b")
STATES = """{"objects": {"v": "vehicle"}, "state": {"surface": "R_cw", "position": {"v": "b"}}}
{"state": {"surface": "R_cw", "position": {"v": "f"}}}
"""
STANDARD_INPUT = "standard_input"
"""The file that stands for it, if a target writes one."""
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
        self.write("base.rules", BASE)
        self.write("listed.rules", LISTED)
        self.write("law.md", LAW)
        self.write("table.csv", TABLE)
        in_words("audit", self.folder / "listed.rules", "-o", self.folder / "audit.json")
        in_words("verify", self.folder / "table.csv", "-r", "esterle2019")
        in_words("monitor", "esterle2019", "--save", self.folder / "saved.json")
        rows = pyarrow.csv.read_csv(self.folder / "table.csv")
        pyarrow.parquet.write_table(rows, self.folder / "table.parquet", compression="none")
        in_words("compile", self.folder / "lane.rules", "--step", "1", "-o", self.folder / "out")
        findings = self.folder / "findings.jsonl"
        judged = self.folder / "traces.jsonl"
        in_words("verify", judged, "-r", "esterle2019", "--exposure", "-o", findings)
        table = self.folder / "findings.csv"
        in_words("verify", judged, "-r", "esterle2019", "--exposure", "-o", table)

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
            return ["show", "--tree", file]
        case 1:
            return ["show", file, "--output-format", "json"]
        case 2:
            return ["show", "--audit", file]
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
            return ["compile", "--check", file]
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


def laws(place, pick):
    """Texts of a law that a rulebook cites, and how it cites it."""
    file = place.write("tried.md", mutated_words(LAW, pick, [LAW, LISTED]))
    book = place.write("tried.rules", mutated_words(LISTED, pick, [LISTED, LAW]))
    book = pick.choice((book, str(place.folder / "listed.rules")))
    now = ["--law-now", str(place.folder / "law.md")] if pick.random() < 0.5 else []
    return ["show", "--audit", book, "--law", file, *now, *pick.choice(([], ["--json"]))]


def listings(place, pick):
    """Books that list topics and provisions, confirm rules, and add exceptions to others'."""
    file = place.write("tried.rules", mutated_words(LISTED, pick, [LISTED, BASE]))
    base = str(place.folder / "base.rules")
    match pick.randrange(8):
        case 0:
            return ["show", "--audit", file, "--json"]
        case 1:
            return [
                "diff",
                base,
                file,
                "--pair",
                pick.choice(("lamps=calm", "calm=lamps", "=", "a=b")),
            ]
        case 2:
            return ["doc", file, "-o", str(place.folder / "doc.html")]
        case 3:
            return ["check", "--fix", file]
        case 4:
            return ["analyze", file, "-j", "1"]
        case 5:
            return ["show", "--tree", file]
        case _:
            return ["check", file]


def saved_audits(place, pick):
    """Audits that new ones are compared with."""
    file = place.write("tried.json", mutated_json(place.text("audit.json"), pick))
    return ["show", "--audit", str(place.folder / "listed.rules"), "--compare", file]


def saved_monitors(place, pick):
    """Monitors that go on where they were."""
    file = place.write("tried.json", mutated_json(place.text("saved.json"), pick))
    if pick.random() < 0.3:
        scenario = str(place.folder / "scenario.toml")
        return ["maneuvers", scenario, "-r", "esterle2019", "--after", file]
    return ["monitor", "esterle2019", "--restore", file]


def state_lines(place, pick):
    """States of a running monitor."""
    place.write(STANDARD_INPUT, mutated_json(STATES, pick))
    return ["monitor", "esterle2019"]


def tables(place, pick):
    """Traces as tables, to judge, to look moments up in, and for many machines."""
    name = pick.choice(("table.csv", "table.csv", "table.parquet"))
    data = (place.folder / name).read_bytes()
    if name == "table.csv" and pick.random() < 0.7:
        data = mutated_words(data.decode(), pick, [TABLE, '"=1",@x,-0,1e999,nan'])
    else:
        data = mutated_bytes(data, pick)
    file = place.write(f"tried{Path(name).suffix}", data)
    match pick.randrange(6):
        case 0:
            return ["find", "surface = R_cw", file, "-u", "paper"]
        case 1 if name == "table.parquet":
            out = str(place.folder / "fleet")
            return ["fleet", file, "-r", "esterle2019", "-o", out, "-j", "1"]
        case _:
            return ["verify", file, "-r", "esterle2019", *pick.choice(([], ["--exposure"]))]


def several_steps(place, pick):
    """Steps that a rulebook is compiled for."""
    steps = ["1", "0.5", "0.1", "2", "5", "0", "-1", "1e-300", "1e300", "nan", "1/3", "0.30000001"]
    words = [word for _ in range(pick.randrange(1, 5)) for word in ("--step", pick.choice(steps))]
    return ["compile", str(place.folder / "lane.rules"), *words, "-o", str(place.folder / "some")]


def rate_tables(place, pick):
    """Findings as a table, and what rates are told by."""
    written = place.text("findings.csv")
    names = ("file", "trace", "rule", "opportunities", "violated", "duration_s", "distance_m")
    rows = [
        [pick.choice(("", "1", "-1", "1e308", "nan", "a", "=1+1")) for _ in names] for _ in "abc"
    ]
    text = "\n".join(map(",".join, [names, *rows]))
    data = mutated_words(text, pick, [text]) if pick.random() < 0.5 else text.encode()
    if pick.random() < 0.6:
        data = mutated_words(written, pick, [written, text])
    file = place.write("tried.csv", data)
    more = pick.choice(
        ([], ["--by", "file"], ["--confidence", pick.choice(("0", "nan", "1e-300"))])
    )
    return ["rates", file, *more]


def formulas(place, pick):
    """A formula that moments are sought for."""
    text = mutated_words(FORMULA, pick, [LANE])
    formula = text.decode("utf-8", "replace").replace("\0", "")
    return ["find", formula, str(place.folder / "traces.jsonl"), "-u", "paper"]


def arguments(place, pick):
    """Words after a verb."""
    verb = pick.choice(list(COMMANDS))
    command = rulec.get_command(click.Context(rulec), verb)
    # Who watches does so until somebody interrupts it.
    options = [name for one in command.params for name in one.opts if name != "--watch"]
    files = ["lane.rules", "traces.jsonl", "out/lane.json", "scenario.toml", "books", "nowhere"]
    words = [*options, *(str(place.folder / name) for name in files), "esterle2019", "1", "-"]
    words += [word.replace("\0", "") for word in STRANGE_WORDS]
    return [*verb.split(), *(pick.choice(words) for _ in range(pick.randrange(6)))]


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
        laws,
        listings,
        saved_audits,
        saved_monitors,
        state_lines,
        tables,
        several_steps,
        rate_tables,
        signatures,
        recordings,
        maps,
        odd_worlds,
        arguments,
    )
}
