"""Each code has a quick fix, or there is a reason why no edit can be made of its help."""

from collections import Counter
from dataclasses import replace

import pytest
from lsprotocol import types as lsp

from rulec.diagnostics import Source
from rulec.language_server.names.renaming import changed_text
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.language_server.writing.quick_fixes import quick_fixes
from rulec.report.findings.code_registry import all_codes
from rulec.syntax import parse

HEAD = "rulebook sample\nsignal p, q\n"
RULE = "hard rule r { require always p }\n"

TEXTS = {
    "R0114": "signal p\n" + RULE,
    "R0118": HEAD + "# a\u202eb\n" + RULE,
    "R0120": 'rulebook sample\nextends base\nconfirm rule r {\n  cite "s. 1"\n  unless q\n}\n',
    "R0206": "rulebook sample\nextends words\n" + RULE,
    "R0212": 'rulebook sample\nextends vienna\ndrop rule red_lihgt because "it is not law here"\n',
    "R0215": HEAD + "priority safety > legal\nhard rule r in legl { require always p }\n",
    "R0213": "rulebook sample\nextends sample\nsignal p\n" + RULE,
    "R0407": HEAD
    + "step 0.5 s\nhard rule r { require always (q implies eventually[<= 5.2 s] p) "
    + "accept { p and q } reject { q and not p } }\n",
}
"""Texts with a mistake that has a fix, where what `explain` shows is no text, or has none."""

FOR_AUTHORS = {
    "R0103": "what an empty file is to say; `rulec new` writes one to start from",
    "R0111": "how a rule is split",
    "R0112": "which number is meant",
    "R0115": "which file the line belongs in",
    "R0117": "which file was meant; nothing is written into what may be no text of ours",
    "R0310": "which of the other values it has",
    "R0313": "with which number it is compared",
    "R0314": "by which number is to be divided",
    "R0316": "what the name means",
    "R0320": "which day the law holds from, and what it says then",
    "R0328": "what the word means",
    "R0323": "how the rule is said more simply",
    "R0363": "whether the fact or the rule says too much",
    "R0364": "whether the second exception takes something back from the first",
    "R0365": "whether the point parts decimals or thousands",
    "R0409": "which of the facts says too much",
    "R0326": "which objects are counted in place of named",
}
"""What only the author of a text can say."""

NO_TEXT = {
    "command": "it is about what a command is given, reads or writes",
    "circumstance": "it is about the machine, or about files of other tools",
    "scenario": "it is about a scenario",
    "trace": "it is about recorded data, in which nothing is to be changed",
    "python": "it is about a call from Python",
    "maneuvers": "two rulebooks' words do not go together",
    "compiled": "the compiler says it, when the editor's check is over",
    "examples": "a lens above the rule writes the missing example",
    "analyzed": "which of the rules that do not go together is wrong, their author knows",
}
"""By what shows a code's mistake, why it is not mended where rulebooks are edited."""


def is_fixed(code):
    return code.code in TEXTS or (code.kind == "rules" and code.code not in FOR_AUTHORS)


CODES = list(all_codes().values())
FIXED = [code.code for code in CODES if is_fixed(code)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An editor of a folder with a vocabulary, and the path of what is edited there."""
    folder = tmp_path_factory.mktemp("edited")
    (folder / "words.rules").write_text("vocabulary words { signal p }\n")
    (folder / "base.rules").write_text(HEAD.replace("sample", "base") + RULE)
    return EditorWorkspace((folder,)), folder / "sample.rules"


def found(text, folder):
    """How often each code is found in a text, and the quick fixes."""
    editor, path = folder
    path.write_text(text)
    document = editor.open(path.as_uri(), text)
    checked = editor.check(document)
    whole = lsp.Range(lsp.Position(0, 0), lsp.Position(text.count("\n") + 1, 0))
    codes = Counter(one.code for one in checked.findings)
    return codes, quick_fixes(checked, document, whole, editor)


def test_each_code_has_a_fix_or_a_reason():
    reasons = {code.code: FOR_AUTHORS.get(code.code) or NO_TEXT.get(code.kind) for code in CODES}
    assert [code for code, why in reasons.items() if why is None and code not in FIXED] == []
    assert not FOR_AUTHORS.keys() & {*FIXED}
    assert {code.kind for code in CODES} == {"rules", *NO_TEXT}
    assert len(FIXED) == 56


@pytest.mark.parametrize("code", FIXED)
def test_its_fix_mends_it(code, folder):
    text = TEXTS.get(code) or all_codes()[code].bad
    codes, fixes = found(text, folder)
    own = [fix for fix in fixes if fix.finding.code == code]
    assert own, text
    for fix in own:
        after, _ = found(changed_text(text, fix.changes), folder)
        assert after[code] < codes[code], fix.title


@pytest.mark.parametrize("code", FIXED)
def test_its_fix_is_in_no_wording(code, folder):
    """What is offered is data of the message, and not read from its texts."""
    text = TEXTS.get(code) or all_codes()[code].bad
    editor, path = folder
    path.write_text(text)
    document = editor.open(path.as_uri(), text)
    checked = editor.check(document)
    reworded = replace(
        checked, findings=tuple(replace(one, help="", message="") for one in checked.findings)
    )
    whole = lsp.Range(lsp.Position(0, 0), lsp.Position(text.count("\n") + 1, 0))
    said, unsaid = (quick_fixes(one, document, whole, editor) for one in (checked, reworded))
    assert [(one.title, one.changes) for one in said] == [
        (one.title, one.changes) for one in unsaid
    ]


def test_many_mistakes_offer_little():
    """None repeats all of a text that is long."""
    text = HEAD + RULE + "accept { p }\n" * 2000
    mistakes = parse(Source("sample", text))[1]
    offered = (fix.text for one in mistakes for offer in one.offers for fix in offer.fixes)
    assert sum(map(len, offered)) < 10 * len(text)


@pytest.mark.parametrize("code", FOR_AUTHORS)
def test_what_only_an_author_can_mend_has_none(code, folder):
    codes, fixes = found(all_codes()[code].bad, folder)
    assert codes[code] == 1
    assert not [fix for fix in fixes if fix.finding.code == code]


@pytest.mark.parametrize(
    ("wrong", "titles", "mended"),
    [
        (
            HEAD + "hard rule r { require always p }\naccept { p }\n",
            ["Put it inside the braces"],
            HEAD + "hard rule r { require always p \naccept { p }\n}\n",
        ),
        (
            HEAD + "hard rule r {\n  require always p }\n  accept { p }\n}\n",
            ["Leave out the `}` before it"],
            HEAD + "hard rule r {\n  require always p \n  accept { p }\n}\n",
        ),
        (
            HEAD + RULE + RULE,
            ["Call it `r_2`"],
            HEAD + RULE + RULE.replace("rule r", "rule r_2"),
        ),
        (
            # Of two that are required neither is left out: it would be another law.
            HEAD + 'hard rule r { says "One." require always p says "Two." }\n',
            ["Leave out this `says`"],
            HEAD + 'hard rule r { says "One." require always p }\n',
        ),
        (
            "rulebook sample\nsignal stop, wet\nhard rule r { require never (ѕtop and wet) }\n",
            ["Write `stop`"],
            "rulebook sample\nsignal stop, wet\nhard rule r { require never (stop and wet) }\n",
        ),
        (
            HEAD + "hard rule r { require always (p or q) accept { p } }\n",
            ["Say `not q` in this state", "Say `q` in this state"],
            HEAD + "hard rule r { require always (p or q) accept { p and not q } }\n",
        ),
        (
            TEXTS["R0407"],
            ["Write `5 s`"],
            TEXTS["R0407"].replace("5.2 s", "5 s"),
        ),
        (
            HEAD + "type car\nsignal near(c: car) default false\n"
            "hard rule r { require every c: car (always not near(c)) }\n",
            ["Put `always` around it"],
            HEAD + "type car\nsignal near(c: car) default false\n"
            "hard rule r { require always every c: car (not near(c)) }\n",
        ),
        (
            HEAD + "hard rule r { require never (p unless q) }\n",
            ["Write `and not`"],
            HEAD + "hard rule r { require never (p and not q) }\n",
        ),
        (
            HEAD + "hard rule r { require always (not p unless q) }\n",
            ["Write `or`"],
            HEAD + "hard rule r { require always (not p or q) }\n",
        ),
        (
            HEAD + "hard rule r { require never (p when q) }\n",
            ["Write `and`"],
            HEAD + "hard rule r { require never (p and q) }\n",
        ),
        (
            "rulebook sample\nquantity a in km/h\nhard rule r { require never a > ५० km/h }\n",
            ["Write `50`"],
            "rulebook sample\nquantity a in km/h\nhard rule r { require never a > 50 km/h }\n",
        ),
        (
            # Which of the two is law, only the author knows.
            HEAD + "hard rule r { require always (p until q or\n  p) }\n",
            ["Write `(p until q) or p`", "Write `p until (q or p)`"],
            HEAD + "hard rule r { require always ((p until q) or p) }\n",
        ),
    ],
)
def test_what_a_help_describes(wrong, titles, mended, folder):
    _, fixes = found(wrong, folder)
    shown = dict.fromkeys(fix.title for fix in fixes)
    assert [title for title in shown if title in titles] == titles, shown
    first = next(fix for fix in fixes if fix.title == titles[0])
    assert changed_text(wrong, first.changes) == mended


@pytest.mark.parametrize(
    ("wrong", "mended"),
    [
        ("always (q implies eventually[4 s .. 1 s] p)", "[1 s .. 4 s]"),
        ("always (q implies eventually[<= 0.3 s] p)", None),
        ("if p then q", None),
        ("always p in force from 01.01.2026", "in force from 2026-01-01"),
        ("never p unless q, p", None),
    ],
)
def test_no_edit_makes_another_law(wrong, mended, folder):
    """What is offered says what the help says, and what a help only shows is not offered."""
    _, fixes = found(f"{HEAD}step 1 s\nhard rule r {{ require {wrong} }}\n", folder)
    texts = [fix.changes[0].text for fix in fixes if fix.finding.severity == "error"]
    assert texts == ([] if mended is None else texts[:1])
    assert mended is None or texts[0] in mended


ON_ROADS = "rulebook sample\nextends vienna\nhard rule r (v: vehicle) {{ {} }}\n"


@pytest.mark.parametrize(
    ("wrong", "texts"),
    [
        # Two percent more is not that much beside the limit itself
        ("require always (speed <= limit + 10 %)", []),
        ("require always (speed <= 50 m)", []),
        ("require always (ego_mass <= 3.5 T)", ["3.5 t"]),
        ("require always beside(v) certainty sure", ["unverified"]),
        ("require always (every v: vehicle (beside(v)))", []),
        # Which of the two is meant, only the author knows
        ("require always (behind(v) implies gap(v) >= 2 s)", ["2 m", "2 s * speed"]),
    ],
)
def test_no_edit_on_roads_makes_another_law(wrong, texts, folder):
    _, fixes = found(ON_ROADS.format(wrong), folder)
    assert [fix.changes[0].text for fix in fixes if fix.finding.severity == "error"] == texts


def test_a_head_is_completed_in_either_strength(folder):
    wrong = HEAD + "rule r { require always p }\n"
    _, fixes = found(wrong, folder)
    mended = [changed_text(wrong, fix.changes) for fix in fixes]
    assert mended == [wrong.replace("rule r", f"{word} rule r") for word in ("hard", "soft")]


def test_a_rule_of_a_list_is_not_chosen(folder):
    wrong = "rulebook sample\nextends vienna\noverride rule fartsgrense { unless ego_on_call }\n"
    assert found(wrong, folder)[1] == []


def test_of_words_that_may_mean_it_each_is_offered(folder):
    wrong = ON_ROADS.format("require always beside(v) unless wlkng_pace_flw")
    _, fixes = found(wrong, folder)
    assert "walking_pace_flow" in [fix.changes[0].text for fix in fixes]


@pytest.mark.parametrize("formula", ["never (p unless q and p)", "never (p unless not q)"])
def test_an_exception_of_several_operands_is_not_rewritten(formula, folder):
    """`and not q and p` would be another formula."""
    _, fixes = found(HEAD + f"hard rule r {{ require {formula} }}\n", folder)
    assert "Write `and not`" not in {fix.title for fix in fixes}
