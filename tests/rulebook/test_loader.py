"""Finding and reading: names, paths, vocabularies, kinds of files, what was read."""

import os
from hashlib import sha256
from pathlib import Path

import pytest

from rulec.diagnostics import RulecError, named
from rulec.logic.printing import formula_text
from rulec.resources import rulebooks_folder
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.rulebook.loader import load_vocabulary, parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook

MINE = "rulebook mine\nuse words\nhard rule r { require always p }\n"
WORDS = "vocabulary words { signal p }\n"


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def only(reference, search_path=()):
    with pytest.raises(RulecError) as caught:
        load_rulebook(reference, search_path)
    (one,) = caught.value.diagnostics
    return one


def test_a_name_is_found_on_the_search_path_first(tmp_path):
    mine = "rulebook esterle2019\nsignal p\nhard rule mine { require always p }\n"
    write(tmp_path / "esterle2019.rules", mine)
    assert load_rulebook("esterle2019").rules[0].name == "R1"
    assert load_rulebook("esterle2019", [tmp_path]).rules[0].name == "mine"


def test_a_name_may_be_a_folder_s(tmp_path):
    write(tmp_path / "mine" / "mine.rules", MINE)
    write(tmp_path / "vocabulary" / "words.rules", WORDS)
    assert load_rulebook("mine", [tmp_path]).name == "mine"
    assert load_rulebook(tmp_path / "mine").name == "mine"


def test_the_folders_come_in_their_order(tmp_path):
    for folder, rule in (("one", "first"), ("two", "second")):
        text = f"rulebook a\nsignal p\nhard rule {rule} {{ require always p }}\n"
        write(tmp_path / folder / "a.rules", text)
    folders = [tmp_path / "one", tmp_path / "two"]
    assert load_rulebook("a", folders).rules[0].name == "first"
    assert load_rulebook("a", folders[::-1]).rules[0].name == "second"


def test_a_vocabulary_is_found_beside_its_rulebook_first(tmp_path):
    path = write(tmp_path / "here" / "mine.rules", MINE)
    write(tmp_path / "here" / "words.rules", WORDS)
    write(tmp_path / "there" / "words.rules", "vocabulary words { signal q }\n")
    assert list(load_rulebook(path, [tmp_path / "there"]).vocabulary.declarations) == ["p"]


def test_a_rulebook_and_its_vocabulary_may_share_a_name(tmp_path):
    path = write(
        tmp_path / "paper.rules", "rulebook paper\nuse paper\nhard rule r {require always R_pc}\n"
    )
    assert "surface" in load_rulebook(path).vocabulary.declarations


def test_what_was_read_is_recorded(tmp_path):
    path = write(tmp_path / "mine.rules", MINE)
    write(tmp_path / "words.rules", WORDS)
    records = [(one.name, one.sha256) for one in load_rulebook(path).sources]
    assert records == [
        ("mine.rules", sha256(MINE.encode()).hexdigest()),
        ("words.rules", sha256(WORDS.encode()).hexdigest()),
    ]


def test_several_vocabularies_add_up(tmp_path):
    write(tmp_path / "words.rules", WORDS)
    text = MINE.replace("use words", "use paper\nuse words\nsignal own").replace("p }", "p & own }")
    names = load_rulebook(write(tmp_path / "mine.rules", text)).vocabulary.declarations
    assert list(names) == ["position", "surface", "CONGESTED", "p", "own"]


def test_an_unknown_name_lists_the_nearest_and_all(tmp_path):
    write(tmp_path / "mine.rules", MINE)
    write(tmp_path / "words.rules", WORDS)
    known = available_rulebooks([tmp_path])
    assert {"esterle2019", "mine"} <= set(known)
    assert list(known) == sorted(known)
    one = only("esterle2018", [tmp_path])
    assert one.code == "R0703"
    assert one.message == "there is no rulebook `esterle2018`"
    own_first = ["mine", *(name for name in known if name != "mine")]
    assert one.help == f"did you mean `esterle2019`? (available: {named(own_first)})"


@pytest.mark.parametrize(
    ("line", "way_out"),
    [
        ("extends road", "`road` is a vocabulary: `use road`"),
        ("use vienna", "`vienna` is a rulebook: `extends vienna`"),
    ],
)
def test_the_name_of_the_other_kind_leads_to_its_line(line, way_out, tmp_path):
    # A title that begins like the vocabulary is not what is meant.
    write(tmp_path / "other.rules", MINE.replace("\n", '\ntitle "Road traffic"\n', 1))
    one = only(
        write(
            tmp_path / "one.rules",
            f"rulebook one\n{line}\nsignal p\nhard rule r {{ require always p }}\n",
        )
    )
    assert (one.code, one.help) == ("R0703", way_out)
    assert only("road").help.startswith("`road` is a vocabulary, in whose words")


@pytest.mark.parametrize("name", ["", "..", "nothing\0here", "x" * 5000, "C:\\book", "*"])
def test_strange_names_are_not_found(name):
    assert only(name).code == "R0703"


@pytest.mark.parametrize("name", ["./none.rules", "none.rules", "a/b", "/", "a\0/b", "/dev/null/x"])
def test_paths_that_cannot_be_read(name):
    one = only(name)
    assert one.code == "R0701"
    assert one.place is not None


def test_a_folder_is_not_a_rulebook(tmp_path):
    assert "folder" in only(f"{tmp_path}/").message


def test_pipes_and_links_out_of_the_tree_are_not_read(tmp_path):
    (tmp_path / "endless.rules").symlink_to("/dev/zero")
    assert only(tmp_path / "endless.rules").code == "R0730"
    os.mkfifo(tmp_path / "pipe.rules")
    assert only(tmp_path / "pipe.rules").code == "R0731"


def test_mistakes_of_the_rulebook_and_of_its_vocabulary_come_together(tmp_path):
    write(tmp_path / "words.rules", "vocabulary words { signal p is x\n colour is one red }\n")
    path = write(tmp_path / "mine.rules", MINE.replace("require always p", "require p & & p"))
    with pytest.raises(RulecError) as caught:
        load_rulebook(path)
    places = [(Path(one.place.file).name, one.place.line) for one in caught.value.diagnostics]
    assert places == [("mine.rules", 3), ("words.rules", 1), ("words.rules", 2)]


def test_an_unreadable_vocabulary_costs_one_error(tmp_path):
    path = write(tmp_path / "mine.rules", MINE)
    (tmp_path / "words.rules").write_bytes(b"vocabulary words { signal p\xff }")
    one = only(path)
    assert (one.code, Path(one.place.file).name) == ("R0101", "words.rules")


def test_a_vocabulary_that_is_used_but_empty(tmp_path):
    path = write(tmp_path / "mine.rules", MINE)
    write(tmp_path / "words.rules", "")
    one = only(path)
    assert (one.code, Path(one.place.file).name) == ("R0103", "words.rules")


def test_text_at_hand_is_read_as_well():
    rulebook = parse_rulebook("rulebook a\nsignal p\nhard rule r { require always p }", "at hand")
    assert rulebook.sources[0].name == "at hand"
    with pytest.raises(RulecError) as caught:
        parse_rulebook("rulebook a\nhard rule r { require always q }", "at hand")
    assert caught.value.diagnostics[0].place.file == "at hand"


def test_the_vocabularies_that_ship():
    paper, road = load_vocabulary("paper"), load_vocabulary("road")
    assert paper.declarations["position"].values == ("b", "f", "l", "r")
    assert paper.declarations["position"].default is None
    assert paper.declarations["surface"].default == "R_cw"
    assert paper.declarations["CONGESTED"].default is False
    assert set(paper.types) == {"obstacle", "vehicle", "pedestrian", "cyclist", "rail_borne"}
    assert road.declarations["station"].values == ("behind", "beside", "in_front_of")
    assert road.declarations["lateral"].values == ("left_of", "same_lane", "right_of")
    assert road.declarations["surface"].default == "carriageway"
    assert road.declarations["congested"].default is False
    for name in ("car", "truck", "bus", "motorcycle"):
        assert road.is_subtype(name, "vehicle")
    assert not road.is_subtype("pedestrian", "vehicle")


def test_a_vocabulary_that_is_not_there():
    with pytest.raises(RulecError) as caught:
        load_vocabulary("raod")
    assert "did you mean `road`?" in caught.value.diagnostics[0].help


def test_every_file_that_ships_can_be_read():
    for path in sorted(rulebooks_folder().rglob("*.rules")):
        if path.parent.name != "vocabulary":
            assert load_rulebook(path.stem).name == path.stem
        elif path.stem == "believable":
            assert load_rulebook(path).name == path.stem  # no law: no name finds it
        else:
            assert load_vocabulary(path.stem).name == path.stem


def test_only_a_folder_of_the_files_name_has_others_beside_it(tmp_path):
    write(
        tmp_path / "vienna.rules", MINE.replace("use words", "signal p").replace("mine", "vienna")
    )
    own = write(tmp_path / "mine" / "mine.rules", "rulebook mine\nextends vienna\n")
    other = write(tmp_path / "mine" / "other.rules", "rulebook other\nextends vienna\n")
    assert [rule.name for rule in load_rulebook(own).rules] == ["r"]
    assert len(load_rulebook(other).rules) > 1  # the book that ships


BASE_OF_A_DAY = """rulebook day_base
law "Road act" as of 2010-01-01
quantity pace in km/h default 0
param top = 60 km/h in force until 2012-06-30
param top = 80 km/h in force from 2012-07-01
hard rule r { require always pace <= top accept { pace = 60 km/h } reject { pace = 61 km/h } }
"""


@pytest.mark.parametrize(
    ("law", "day", "limit"),
    [("", "2010-01-01", 60), ('law "Depot" as of 2015-01-01', "2015-01-01", 80)],
)
def test_a_variant_is_the_law_of_the_day_of_its_nearest_base_that_names_one(
    tmp_path, law, day, limit
):
    """A depot's book that changes nothing forbids what its base forbids, on its day."""
    write(tmp_path / "day_base.rules", BASE_OF_A_DAY)
    write(tmp_path / "depot.rules", "rulebook depot\nextends day_base\n")
    variant = write(tmp_path / "variant.rules", f"rulebook variant\nextends depot\n{law}\n")
    book = load_rulebook(variant, [tmp_path])
    assert (book.at, book.as_of) == (day, day)
    assert f"pace <= {limit} km/h" in formula_text(book.rules[0].formula)
    assert load_rulebook(variant, [tmp_path], "2013-01-01").at == "2013-01-01"
