"""No quick fix says another law than its title does."""

import re
from collections import Counter

import pytest
from lsprotocol import types as lsp

from rulec.language_server.names.renaming import changed_text
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.writing.quick_fixes import quick_fixes
from rulec.report.findings.code_registry import all_codes

NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?")
CLAUSE = re.compile(r"\b(?:unless|when|accept|reject|cite|says)\b")
HEAD = "rulebook sample\nsignal p, q, r, s default false\n"
ON_ROADS = "rulebook sample\nuse road\n"


@pytest.fixture(scope="module")
def fixed(tmp_path_factory):
    """The titles of the quick fixes for a text, each with the text that it makes."""
    folder = tmp_path_factory.mktemp("kept")
    editor, path = EditorWorkspace((folder,)), folder / "sample.rules"

    def fixes(text):
        path.write_text(text)
        document = editor.open(path.as_uri(), text)
        whole = lsp.Range(lsp.Position(0, 0), lsp.Position(text.count("\n") + 1, 0))
        found = quick_fixes(editor.check(document), document, whole, editor)
        mended = [(fix.title, changed_text(text, fix.changes)) for fix in found]
        assert len(mended) == len({*mended})
        return dict(mended)

    return fixes


def rule(formula, more="", head=HEAD):
    return f"{head}hard rule k {{ require {formula} {more}}}\n"


@pytest.mark.parametrize(
    "code", [code.code for code in all_codes().values() if code.kind == "rules" and code.bad]
)
def test_what_a_title_does_not_say_stays(code, fixed):
    """All numbers and clauses stay, and no number comes in."""
    text = all_codes()[code].bad
    for title, mended in fixed(text).items():
        if not title.startswith("Leave out"):
            assert not Counter(CLAUSE.findall(text)) - Counter(CLAUSE.findall(mended)), title
            before, after = (Counter(NUMBER.findall(one)) for one in (text, mended))
            assert after - before <= Counter(NUMBER.findall(title)), title
            assert not before - after or after - before, title


@pytest.mark.parametrize(
    ("wrong", "numbers"),
    [
        ("speed <= 50,5 km/h", ["50.5"]),
        ("lateral_gap(v) >= 1,5 m", ["1.5"]),
        ("lateral_gap(v) >= .5 m", ["0.5"]),
        ("speed <= 1.000,5 km/h", ["1000.5"]),
        ("speed <= 0,125 km/h", ["0.125"]),
        ("ego_mass <= 3,5t", ["3.5t"]),
        # Thousands or decimals: only the author knows
        ("ego_mass <= 3,500 kg", []),
        ("ego_mass <= 3,500kg", []),
        ("speed <= 1e3,5 km/h", []),
        ("speed <= 3.5,2 km/h", []),
        ("speed <= 1,2,3 km/h", []),
        # A list, or the two ends of a bound
        ("always[3,4 s] beside(v)", []),
        ("speed <= 1, 5 km/h", []),
    ],
)
def test_a_comma_in_a_number(wrong, numbers, fixed):
    text = f"{ON_ROADS}hard rule k (v: vehicle) {{ require always (beside(v) implies {wrong}) }}\n"
    assert fixed(text) == {
        f"Write `{number}`": re.sub(r"(?:\d[\d.]*,|\.)\d+t?(?= |\))", number, text)
        for number in numbers
    }


@pytest.mark.parametrize(
    ("text", "titles"),
    [
        # Each of these was replaced by what its help only quotes
        (rule("always speed", head=ON_ROADS), []),
        (rule("always (tunnel implies p)"), ["Use `road`"]),
        (rule("never p until q"), []),
        (rule("always (p))"), ["Leave out `)`"]),
        (rule("always p", "accept { p, q } "), ["Write `;`", "Write `and`"]),
        (
            rule("never p", "unless s ").replace("never p", "never (p then[<= 2 s] q then r)"),
            ["Put `at start` behind it", "Put `at end` behind it", "Put `at some point` behind it"],
        ),
        (
            rule("never kind", head=f"{HEAD}kind is one of car, bus default car\n"),
            ["Write `car`", "Write `bus`"],
        ),
        # Two of them: which is law, or whether both are, only the author knows
        (rule("always p", "when q when r "), []),
        (rule("always (p or q) require always r"), []),
        (rule("always p require always q"), ["Write `and`"]),
        (rule("always p", "unless q require always s "), []),
    ],
)
def test_only_what_the_help_says_is_offered(text, titles, fixed):
    assert [*fixed(text)] == titles


def test_a_backslash_keeps_its_letter(fixed):
    text = 'rulebook sample\ntitle "either\\or"\nsignal p\nhard rule r { require never p }\n'
    assert fixed(text) == {"Write `\\\\o`": text.replace("\\", "\\\\")}


def test_an_inherited_exception_is_not_left_out(fixed):
    text = "rulebook sample\nextends vienna\noverride rule keep_near_side { unless congested }\n"
    found = fixed(text)
    assert "Write `also`" in found
    assert all("unless congested" in mended for mended in found.values())


def test_one_variable_is_left_out_and_not_its_rule(fixed):
    text = all_codes()["R0262"].bad
    assert fixed(text) == {"Leave out `(v: car)`": text.replace(" (v: car)", "")}
