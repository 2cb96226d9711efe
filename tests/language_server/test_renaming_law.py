"""Whatever of Germany's rulebook is called otherwise, its tables stay the same."""

import shutil

import pytest

import rulec
from rulec.language_server.names.document_names import names_in_document
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
    thing = next(one.thing for one in names.all() if one.thing.name == name)
    for uri, changes in renamed(thing, NEW, names, law[1]).items():
        document = law[1].document(uri)
        copy = folder / document.path.relative_to(law[0])
        copy.write_text(changed_text(document.text, changes), encoding="utf-8")
    return folder / path.relative_to(law[0])


def by_name(rules, name):
    return {name if rule.name == NEW else rule.name: rule for rule in rules}


@pytest.mark.parametrize("name", ["following_distance", "slightly_faster"])
def test_a_few_names(law, name, tmp_path):
    _, names = opened(law)
    was = names.checked.resolved.rulebook
    now = rulec.load_rulebook(after_renaming(law, name, tmp_path / "law"))
    mine, theirs = (
        {
            rule: (one.formula, parts_of(one), one.topics)
            for rule, one in by_name(rules, name).items()
        }
        for rules in (was.rules, now.rules)
    )
    assert mine == theirs
    assert was.vocabulary == now.vocabulary


@pytest.mark.long
def test_every_name(law, tmp_path):
    _, names = opened(law)
    book = rulec.compile(names.checked.resolved.rulebook)
    tables = {rule.name: rule.machine for rule in book.rules}
    for number, name in enumerate(own_names(names)):
        again = rulec.compile(after_renaming(law, name, tmp_path / str(number)))
        found = {rule: one.machine for rule, one in by_name(again.rules, name).items()}
        assert found == tables, name
        shutil.rmtree(tmp_path / str(number))
