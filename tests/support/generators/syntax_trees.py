"""Hypothesis strategies for syntax trees: every node of the language."""

from hypothesis import strategies as st

from rulec.syntax import tree
from rulec.syntax.keywords import CONTEXTUAL, PRECEDENCE, RESERVED, UNARY_OPERATORS

letters = st.sampled_from("abpqrvxyzGFXURWMOHYS_éß車Ω09")
names = (
    st.text(letters, min_size=1, max_size=5)
    .filter(lambda text: text not in RESERVED and not text[0].isdigit())
    .map(tree.Name)
) | st.sampled_from(sorted(CONTEXTUAL)).map(tree.Name)
texts = st.text(
    st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp")).filter(
        lambda one: not ("\u202a" <= one <= "\u202e" or "\u2066" <= one <= "\u2069")
    )
    | st.sampled_from('"\\#{};\t'),
    max_size=12,
).map(tree.Text)


def _lists(of, least=0):
    return st.lists(of, min_size=least, max_size=3).map(tuple)


units = st.sampled_from(["m", "km/h", "m/s^2", "m^-1", "%", "°", "Nm", "µm", "steps", "step"])
figures = st.from_regex(r"[0-9]{1,4}(\.[0-9]{1,3})?([eE][+-]?[0-9]{1,2})?", fullmatch=True)
times = st.builds(tree.NumberLiteral, figures, units)
numbers = times | st.builds(tree.NumberLiteral, figures)
atoms = st.builds(tree.AtomUse, names, _lists(names))
parameters = _lists(st.builds(tree.Parameter, names, st.none() | names))
variable = st.builds(tree.Parameter, names, names)
variables = _lists(variable)
amounts = times | atoms
bounds = st.one_of(
    st.none(),
    st.builds(tree.BoundNode, st.none(), amounts),
    st.builds(tree.BoundNode, amounts, st.none()),
    st.builds(tree.BoundNode, amounts, amounts),
    amounts.map(lambda one: tree.BoundNode(one, one, exact=True)),
)
OVER_TIME = ("then", "until", "release", "weak until", "strong release", "since")


def _prefix(operator, operand, bound):
    return tree.Prefix(operator, operand, None if operator == "not" else bound)


def _infix(operator, left, right, bound):
    return tree.Infix(operator, left, right, bound if operator in OVER_TIME else None)


formulas = st.recursive(
    atoms | st.builds(tree.TruthLiteral, st.booleans()) | numbers,
    lambda inner: st.one_of(
        st.builds(_prefix, st.sampled_from(UNARY_OPERATORS), inner, bounds),
        st.builds(_infix, st.sampled_from(sorted(PRECEDENCE)), inner, inner, bounds),
        st.builds(tree.Compare, st.sampled_from(["<", "<=", "=", "!=", ">=", ">"]), inner, inner),
        st.builds(tree.Arithmetic, st.sampled_from("+-*/"), inner, inner),
        st.builds(tree.Minus, inner),
        st.builds(tree.Conditional, inner, inner, inner),
        st.builds(tree.Aggregate, st.sampled_from(["some", "every", "count"]), variable, inner),
    ),
    max_leaves=20,
)
"""Formulas and expressions; `print_formula` puts parentheses around all that needs them."""

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
        units,
        st.none() | st.floats(allow_nan=False, allow_infinity=False),
    ),
    st.builds(tree.FactItem, formulas),
    st.builds(tree.ConstantItem, _lists(names, 1)),
    st.builds(tree.PresumedItem, _lists(names, 1)),
)

days = st.dates().map(lambda day: day.isoformat())
in_force = st.builds(tree.InForce, days, st.just("") | days) | st.builds(
    tree.InForce, st.just(""), days
)
levels = st.none() | names
weights = st.none() | st.builds(tree.NumberLiteral, figures)

provisions = st.one_of(
    st.builds(tree.OptionItem, names, st.booleans()),
    st.builds(tree.ParamItem, names, st.none() | names, formulas, st.none() | in_force),
    st.builds(tree.SetItem, names, st.booleans()),
    st.builds(tree.SetItem, names, formulas, st.none() | in_force),
    st.builds(tree.DefineItem, names, parameters, formulas, st.booleans()),
    st.builds(tree.DropItem, names, texts),
    st.builds(tree.SoftenItem, names, levels, weights, st.none() | texts),
    st.builds(tree.SilentItem, names, texts),
)
values = numbers | numbers.map(tree.Minus)
literals = st.builds(tree.StateLiteral, atoms, st.booleans()) | st.builds(
    tree.StateLiteral, atoms, st.just(False), values
)
states = st.builds(tree.ExampleState, _lists(literals, 0))
examples = st.builds(
    tree.ExampleItem,
    st.booleans(),
    _lists(states, 1),
    texts.map(lambda text: text.value),
    variables,
)
scopes = st.sampled_from(["initially", "at start", "throughout", "at some point", "at end"])


@st.composite
def _rules(draw):
    """A rule; only one that overrides may lack its strength and its formula."""
    override = draw(st.booleans())
    if override and draw(st.booleans()):
        return tree.RuleItem(
            None,
            draw(names),
            cite=draw(texts),
            says=draw(st.none() | texts),
            examples=draw(_lists(examples)),
            override=True,
            source=draw(st.none() | texts),
            certainty=draw(st.sampled_from(["", "verified", "secondary"])),
            confirm=True,
        )
    nothing = st.none() if override else st.nothing()
    return tree.RuleItem(
        draw(nothing | st.sampled_from(["hard", "soft"])),
        draw(names),
        draw(variables),
        draw(nothing | formulas),
        draw(st.none() | texts),
        draw(st.none() | texts),
        draw(_lists(examples)),
        level=draw(levels),
        weight=draw(weights),
        override=override,
        unless=draw(_lists(st.builds(tree.Unless, formulas, st.none() | scopes))),
        when=draw(st.none() | formulas),
        source=draw(st.none() | texts),
        certainty=draw(st.sampled_from(["", "verified", "secondary", "unverified"])),
        in_force=draw(st.none() | in_force),
        topics=draw(_lists(names)),
    )


rules = _rules()
priorities = st.lists(names, min_size=2, max_size=4).flatmap(
    lambda some: st.builds(
        tree.PriorityLine,
        st.just(tuple(some)),
        st.tuples(*[st.sampled_from(">=")] * (len(some) - 1)),
    )
)


@st.composite
def _rulebooks(draw):
    """A rulebook with a rule, or one that extends another."""
    return tree.File(
        "rulebook",
        draw(names),
        draw(st.none() | st.builds(tree.TitleLine, texts)),
        draw(st.none() | st.builds(tree.LawLine, texts, st.just("") | days)),
        tuple(map(tree.UseLine, draw(st.lists(names, max_size=2, unique=True)))),
        (*draw(_lists(declarations | provisions | rules)), draw(rules)),
        extends=draw(st.none() | st.builds(tree.ExtendsLine, names)),
        traffic=draw(st.none() | st.builds(tree.TrafficLine, st.sampled_from(["left", "right"]))),
        semantics=draw(
            st.none() | st.builds(tree.SemanticsLine, st.sampled_from(["stutter", "finite"]))
        ),
        step=draw(st.none() | st.builds(tree.StepLine, numbers)),
        priorities=draw(_lists(priorities)),
    )


rulebooks = _rulebooks()
vocabularies = st.builds(
    lambda name, items: tree.File("vocabulary", name, items=items), names, _lists(declarations)
)
files = rulebooks | vocabularies
