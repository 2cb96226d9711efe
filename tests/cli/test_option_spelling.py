"""Options over all verbs: one thing has one name everywhere, and one name means one thing."""

from collections import defaultdict

import click
import pytest

from rulec.cli.main import main, rulec
from rulec.cli.options.output_options import RenamedOption
from rulec.cli.verb_table import COMMANDS


def options_in(group, *names):
    """Each option of each command below a group, with the command's name."""
    context = click.Context(group)
    for name in COMMANDS if group is rulec else group.list_commands(context):
        command = group.get_command(context, name)
        if isinstance(command, click.Group):
            yield from options_in(command, *names, name)
        for option in command.params:
            if isinstance(option, click.Option):
                yield " ".join((*names, name)), option


OPTIONS = [*options_in(rulec), *(("", one) for one in rulec.params)]


def by_name():
    found = defaultdict(list)
    for verb, option in OPTIONS:
        for name in (*option.opts, *option.secondary_opts):
            found[name].append((verb, option))
    return found


def meanings_of(key):
    """What is said of an option, as ``key`` has it -> the names by which it is called."""
    found = defaultdict(set)
    for _, option in OPTIONS:
        found[key(option)].add(max(option.opts, key=len))
    return found


FIELDS = {
    "--all": "each verb has all of something else: rules, codes, rulebooks",
    "--fail-on": "audit has kinds of findings, check and analyze two degrees",
    "--list": "maneuvers can list none, envelopes has one at least",
    "--output": "a file of an answer, several of these, or a folder",
    "--rulebook": "one, or several side by side",
    "--ego": "one, or several",
}
"""Names that programs know by several words, with the reason."""

KINDS = FIELDS | {
    "--step": "bounds in seconds are exact, times of predicted drives are not",
    "--input-format": "traces have other formats than recordings",
    "--output-format": "each verb has its formats",
    "--format": "each verb has its formats",
}
"""Names whose values differ from verb to verb, with the reason."""


def test_a_name_is_known_by_one_word_in_all_verbs():
    several = {
        name
        for name, found in by_name().items()
        if name.startswith("--") and len({option.name for _, option in found}) > 1
    }
    assert several <= FIELDS.keys()
    assert several >= FIELDS.keys(), "these have one word by now"


def test_a_name_takes_one_kind_of_value_in_all_verbs():
    def kind(option):
        choices = getattr(option.type, "choices", None)
        return option.metavar, option.type.name if choices is None else tuple(choices)

    several = {
        name
        for name, found in by_name().items()
        if name.startswith("--") and len({kind(option) for _, option in found}) > 1
    }
    assert several <= KINDS.keys()


def test_nothing_is_said_of_two_names():
    """Two options of which the help says the same are one."""
    for help_text, names in meanings_of(lambda option: option.help).items():
        assert len(names) == 1, (help_text, names)


def test_no_word_is_set_by_two_names():
    for word, names in meanings_of(lambda option: option.name).items():
        assert len(names) == 1 or word in ("number", "help"), (word, names)


def test_a_short_name_stands_for_one_long_one():
    for name, found in by_name().items():
        if not name.startswith("--"):
            assert len({max(option.opts, key=len) for _, option in found}) == 1, name


FORMER = {
    ("test", "--run"): "--rule",
    ("test", "--threshold"): "--fail-under",
    ("maneuvers --traces", "--limit"): "--first",
    ("fleet", "--engine"): "--on",
    ("verify", "--net"): "--map",
    ("maneuvers --traces", "--format"): "--output-format",
    ("verify", "--format"): "--input-format",
}


@pytest.mark.parametrize(("verb", "former"), FORMER)
def test_former_names_are_taken_and_nowhere_shown(verb, former, capsys):
    (option,) = [
        option
        for of, option in OPTIONS
        if of == verb and isinstance(option, RenamedOption) and former in option.former
    ]
    assert option.opts == [FORMER[verb, former]]
    assert main(["help", *verb.split()]) == 0
    assert f"{former} " not in capsys.readouterr().out
    parsed = rulec.get_command(click.Context(rulec), verb)
    context = click.Context(parsed, resilient_parsing=True)
    values, *_ = parsed.make_parser(context).parse_args([former, "1"])
    assert values[option.name] == (["1"] if option.multiple else "1")


@pytest.mark.parametrize("name", ["--fail-under", "--threshold"])
def test_what_is_wrong_is_said_of_the_name_that_was_typed(name, capsys):
    assert main(["test", "esterle2019", name, "101"]) == 2
    assert f"error: {name}: `101" in capsys.readouterr().err


def test_every_former_name_is_looked_at():
    found = {
        (name, option.opts[0])
        for _, option in OPTIONS
        if isinstance(option, RenamedOption)
        for name in option.former
    }
    assert found == {(former, present) for (_, former), present in FORMER.items()}
