"""Whatever of Germany's rulebook is called otherwise, its tables stay the same."""

import re
import shutil
from dataclasses import replace

import pytest

import rulec
from rulec.language_server.names.name_occurrences import names_in_document
from rulec.language_server.names.renaming import changed_text, renamed
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.resources import rulebooks_folder
from rulec.rulebook.rulebook_model import parts_of
from rulec.syntax import tree

NEW = "called_otherwise"


@pytest.fixture(scope="module")
def law(tmp_path_factory):
    """The folder with Germany's rulebook and all that it builds upon, and an editor of it."""
    folder = tmp_path_factory.mktemp("law")
    for name in ("schemas", "vienna", "de", "vocabulary"):
        shutil.copytree(rulebooks_folder() / name, folder / name)
    return folder, EditorWorkspace((folder,))


def opened(law):
    folder, editor = law
    path = folder / "de" / "de.rules"
    document = editor.open(path.as_uri(), path.read_text(encoding="utf-8"))
    return path, names_in_document(editor.check(document))


def own_names(names):
    """Every rule, definition and parameter that the rulebook writes, inherited or not."""
    kinds = tree.RuleItem | tree.DefineItem | tree.ParamItem
    return dict.fromkeys(item.name.text for item in names.file.items if isinstance(item, kinds))


def after_renaming(law, name, folder):
    """A copy of the books in which a name is another one."""
    path, names = opened(law)
    shutil.copytree(law[0], folder)
    kinds = ("rule", "definition", "parameter")  # a word of a vocabulary may be called so, too
    things = (one.symbol for one in names.all() if one.symbol.name == name)
    thing = next(one for one in things if one.kind in kinds)
    for uri, changes in renamed(thing, NEW, names, law[1]).items():
        document = law[1].document(uri)
        copy = folder / document.path.relative_to(law[0])
        copy.write_text(changed_text(document.text, changes), encoding="utf-8")
    return folder / path.relative_to(law[0])


def by_name(rules, name):
    return {name if rule.name == NEW else rule.name: rule for rule in rules}


def meanings(rulebook, name):
    return {
        rule: (one.formula, parts_of(one), one.topics)
        for rule, one in by_name(rulebook.rules, name).items()
    }


@pytest.mark.parametrize("name", ["following_distance", "slightly_faster"])
def test_a_few_names(law, name, tmp_path):
    _, names = opened(law)
    was = names.checked.resolved.rulebook
    now = rulec.load_rulebook(after_renaming(law, name, tmp_path / "law"))
    assert meanings(was, name) == meanings(now, name)
    assert was.vocabulary == now.vocabulary


def reading(names, name):
    """The rules of the rulebook in which a name stands, their own among them."""
    return {
        item.name.text
        for item in names.file.items
        if isinstance(item, tree.RuleItem) and re.search(rf"\b{name}\b", item.span.text)
    }


def tables(rulebook, name, wanted):
    """The tables of these rules, whatever one of them is called now."""
    rules = tuple(one for rule, one in by_name(rulebook.rules, name).items() if rule in wanted)
    book = rulec.compile(replace(rulebook, rules=rules))
    return {name if rule.name == NEW else rule.name: rule.machine for rule in book.rules}


@pytest.mark.long
def test_every_name(law, tmp_path):
    """All rules mean the same; those in which the name stands are compiled anew."""
    _, names = opened(law)
    was = names.checked.resolved.rulebook
    known = tables(was, "", {rule.name for rule in was.rules})
    for number, name in enumerate(own_names(names)):
        now = rulec.load_rulebook(after_renaming(law, name, tmp_path / str(number)))
        assert meanings(was, name) == meanings(now, name), name
        assert was.vocabulary == now.vocabulary, name
        wanted = reading(names, name)
        assert tables(now, name, wanted) == {rule: known[rule] for rule in wanted}, name
        shutil.rmtree(tmp_path / str(number))
