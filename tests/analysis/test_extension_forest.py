"""Who extends whom."""

from hypothesis import given
from hypothesis import strategies as st

from rulec.analysis.lineage.rule_lineage import BookHeader, ExtensionTree, extension_forest


def book(name, extends=""):
    return BookHeader(name, extends=extends)


def test_children_hang_below_their_base():
    a, b, c, d = book("a"), book("b", "a"), book("c", "a"), book("d", "c")
    assert extension_forest([d, c, b, a, c]) == (
        ExtensionTree(a, (ExtensionTree(b), ExtensionTree(c, (ExtensionTree(d),)))),
    )


def test_a_base_that_is_not_there():
    lonely = book("lonely", "nowhere")
    assert extension_forest([lonely]) == (ExtensionTree(lonely),)


def test_a_circle_is_cut():
    a, b, c = book("a", "b"), book("b", "a"), book("c", "c")
    assert extension_forest([b, a, c]) == (ExtensionTree(a, (ExtensionTree(b),)), ExtensionTree(c))


names = st.sampled_from("abcdef")


def names_in(branches):
    return [name for one in branches for name in (one.book.name, *names_in(one.children))]


@given(st.dictionaries(names, names))
def test_every_book_is_there_once(extends):
    members = [book(name, base) for name, base in extends.items()]
    found = names_in(extension_forest(members))
    assert sorted(found) == sorted(extends)
