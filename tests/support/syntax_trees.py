"""Hypothesis strategies for syntax trees, and a good rulebook to break."""

from hypothesis import strategies as st

from rulec.syntax import tree
from rulec.syntax.keywords import PRECEDENCE, RESERVED, UNARY_OPERATORS

letters = st.sampled_from("abpqrvxyzGFXURWMOHYS_éß車Ω09")
names = (
    st.text(letters, min_size=1, max_size=5)
    .filter(lambda text: text not in RESERVED and not text[0].isdigit())
    .map(tree.Name)
)
texts = st.text(
    st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp")).filter(
        lambda one: not ("\u202a" <= one <= "\u202e" or "\u2066" <= one <= "\u2069")
    )
    | st.sampled_from('"\\#{};\t'),
    max_size=12,
).map(tree.Text)

atoms = st.builds(tree.AtomUse, names, st.lists(names, max_size=2).map(tuple))
formulas = st.recursive(
    atoms | st.builds(tree.Truth, st.booleans()),
    lambda inner: (
        st.builds(tree.Prefix, st.sampled_from(UNARY_OPERATORS), inner)
        | st.builds(tree.Infix, st.sampled_from(sorted(PRECEDENCE)), inner, inner)
    ),
    max_leaves=25,
)


def _lists(of, least=0):
    return st.lists(of, min_size=least, max_size=3).map(tuple)


parameters = _lists(st.builds(tree.Parameter, names, st.none() | names))
variables = _lists(st.builds(tree.Parameter, names, names))
declarations = st.one_of(
    st.builds(tree.TypeItem, names, st.none() | names),
    st.builds(tree.EnumerationItem, names, parameters, _lists(names, 1), st.none() | names),
    st.builds(
        tree.SignalItem,
        _lists(st.builds(tree.SignalHead, names, parameters), 1),
        st.none() | st.booleans(),
    ),
    st.builds(
        tree.QuantityItem,
        names,
        parameters,
        st.sampled_from(["m", "km/h", "m/s^2", "%", "Nm", "µm"]),
        st.none() | st.floats(allow_nan=False, allow_infinity=False),
    ),
)
states = st.builds(tree.ExampleState, _lists(st.builds(tree.StateLiteral, atoms, st.booleans()), 1))
examples = st.builds(
    tree.Example, st.booleans(), _lists(states, 1), texts.map(lambda text: text.value)
)
rules = st.builds(
    tree.RuleItem,
    st.sampled_from(["hard", "soft"]),
    names,
    variables,
    formulas,
    st.none() | texts,
    st.none() | texts,
    _lists(examples),
)
dates = st.just("") | st.dates().map(lambda day: day.isoformat())
rulebooks = st.builds(
    lambda items, rule, *rest: tree.File("rulebook", *rest, items=(*items, rule)),
    _lists(declarations | rules),
    rules,
    names,
    st.none() | st.builds(tree.TitleLine, texts),
    st.none() | st.builds(tree.LawLine, texts, dates),
    st.lists(names, max_size=2, unique=True).map(lambda some: tuple(map(tree.UseLine, some))),
)
vocabularies = st.builds(
    lambda name, items: tree.File("vocabulary", name, items=items), names, _lists(declarations)
)
files = rulebooks | vocabularies
