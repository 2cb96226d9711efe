"""R01: what is not written as the language has it."""

from rulec.diagnostics.explanations.explanation import Explanation

SYNTAX = {
    "R0101": Explanation(
        "a file is not a text in UTF-8",
        "Files are plain text in UTF-8, so that names and sentences in any language read the same "
        "everywhere. Save the file as UTF-8; a file from a word processor is not a plain text.",
        r"printf 'rulebook stra\337e signal p hard rule r { require p }' | rulec check -",
        r"printf 'rulebook stra\303\237e signal p hard rule r { require p }' | rulec check -",
        "command",
    ),
    "R0102": Explanation(
        "a file is too large",
        "A rulebook or a vocabulary may have 5,000,000 bytes. No law is that long; if a program "
        "wrote the file, split it into several rulebooks.",
        "{ echo 'rulebook a signal p hard rule r { require p }'\n"
        "  head -c 5000000 /dev/zero | tr '\\0' '#'; } | rulec check -",
        "{ echo 'rulebook a signal p hard rule r { require p }'\n"
        "  head -c 50000 /dev/zero | tr '\\0' '#'; } | rulec check -",
        "command",
    ),
    "R0103": Explanation(
        "a file is empty",
        "There is nothing in the file but blank space and comments. A rulebook begins with "
        "`rulebook NAME`, a vocabulary with `vocabulary NAME {`.",
        "# nothing yet\n",
        "# as short as can be\nrulebook shortest\nsignal p\nhard rule keep_it { require p }\n",
    ),
    "R0104": Explanation(
        "something stands where the language has no place for it",
        "Up to the underlined place the text can be read, and there it cannot go on. Beside the "
        "place stands what could have come; often an operator is spelt otherwise, a word is "
        "misspelt, or a separator is missing. Of two comparisons in a row each is written out: "
        "`1 m < gap(v) and gap(v) < 2 m`; a conditional inside a formula stands in parentheses; a "
        "bound's numbers have a unit.",
        "rulebook example\nsignal rain, wet\nhard rule r { require rain => wet }\n",
        "rulebook example\nsignal rain, wet\nhard rule r { require rain implies wet }\n",
    ),
    "R0105": Explanation(
        "a text has no closing quote",
        "A text stands in straight double quotes and ends on the line on which it begins. A long "
        'sentence stays on one line; a quote inside is written `\\"`.',
        'rulebook example\ntitle "An example\nsignal p\nhard rule r { require p }\n',
        'rulebook example\ntitle "An example"\nsignal p\nhard rule r { require p }\n',
    ),
    "R0106": Explanation(
        "a text holds an unknown escape",
        'In a text a backslash makes a quote (`\\"`) or a backslash (`\\\\`), and nothing else.',
        'rulebook example\ntitle "either\\or"\nsignal p\nhard rule r { require p }\n',
        'rulebook example\ntitle "either\\\\or"\nsignal p\nhard rule r { require p }\n',
    ),
    "R0107": Explanation(
        "a text holds a control character",
        "Texts are shown in terminals and in reports. Characters that drive a terminal, or turn "
        "the direction of the text around, could make a rule look like another one.",
        "printf 'rulebook a title \"\\033[2J\" signal p hard rule r { require p }' | rulec check -",
        "printf 'rulebook a title \"clear\" signal p hard rule r { require p }' | rulec check -",
        "command",
    ),
    "R0108": Explanation(
        "a brace is missing or closes nothing",
        "The clauses of a rule, the states of an example and the items of a vocabulary stand "
        "between `{` and `}`. The message names what was not begun or not ended.",
        "rulebook example\nsignal p\nhard rule a { require p\nhard rule b { require not p }\n",
        "rulebook example\nsignal p\nhard rule a { require p }\nhard rule b { require not p }\n",
    ),
    "R0109": Explanation(
        "something stands outside the braces that it belongs in",
        "A clause such as `cite` or `accept` belongs to a rule and stands between its braces; "
        "behind the `}` of a vocabulary nothing can stand.",
        "rulebook example\nsignal p\nhard rule r { require p }\naccept { p }\n",
        "rulebook example\nsignal p\nhard rule r { require p accept { p } }\n",
    ),
    "R0110": Explanation(
        "a date is not in the calendar",
        "A date is written `year-month-day` and has to exist, behind `as of` and in `in force`.",
        'rulebook example\nlaw "A law" as of 2023-02-29\nsignal p\nhard rule r { require p }\n',
        'rulebook example\nlaw "A law" as of 2024-02-29\nsignal p\nhard rule r { require p }\n',
    ),
    "R0111": Explanation(
        "a formula is too deep or too long",
        "A formula may be nested 200 levels deep and have 10,000 words and signs. Nobody can read "
        "more, and such a formula comes from a program; say its parts in rules of their own.",
        f"rulebook example\nsignal p\nhard rule r {{\n  require\n{'    ' + '!' * 67}\n"
        f"{'    ' + '!' * 67}\n{'    ' + '!' * 67} p\n}}\n",
        "rulebook example\nsignal p\nhard rule r { require not p }\n",
    ),
    "R0112": Explanation(
        "a number is too large or too long",
        "Numbers reach to about 1.8e308, as in nearly all programs, and have at most 400 digits.",
        "rulebook example\nquantity speed in km/h default 1e999\nsignal p\n"
        "hard rule r { require p }\n",
        "rulebook example\nquantity speed in km/h default 130\nsignal p\n"
        "hard rule r { require p }\n",
    ),
    "R0113": Explanation(
        "a word of the language is used as a name",
        "Words such as `rule`, `always` and `G` have a meaning of their own wherever they stand. "
        "Letters' case makes names different: `g` can be a name.",
        "rulebook example\nsignal always\nhard rule r { require true }\n",
        "rulebook example\nsignal at_all_times\nhard rule r { require true }\n",
    ),
    "R0114": Explanation(
        "something that must be there is missing",
        "A file says first what it is; a rulebook has a rule, or extends another; every rule has "
        "one `require`, but for those that override another and leave it as it is.",
        'rulebook example\nhard rule r { says "Drive with care." }\n',
        "rulebook example\nsignal careful\n"
        'hard rule r { says "Drive with care." require always careful }\n',
    ),
    "R0115": Explanation(
        "a line stands in the wrong part of a file",
        "Header lines (`title`, `law`, `use`, `extends`, `traffic`, `semantics`, `step`, "
        "`priority`) stand between `rulebook NAME` and the first item; a vocabulary holds "
        "declarations only; a file holds one rulebook or one vocabulary.",
        "vocabulary town {\n  signal fog\n  hard rule r { require not fog }\n}\n",
        "rulebook town\nsignal fog\nhard rule r { require not fog }\n",
    ),
    "R0116": Explanation(
        "something is given twice",
        "A rulebook has one title, one law, and extends one other; a rule has one `require`, "
        "`cite`, `says` and `when`, and as many `unless` and examples as it needs. Two demands are "
        "joined by `and`, or stand in two rules.",
        "rulebook example\nsignal p, q\nhard rule r { require p require q }\n",
        "rulebook example\nsignal p, q\nhard rule r { require p and q }\n",
    ),
    "R0117": Explanation(
        "a file is no rulebook",
        "Hardly anything in the file can be read as a rulebook or a vocabulary, so it is probably "
        "another file than was meant.",
        "Dear all,\nplease find the rules attached.\n",
        "rulebook attached\nsignal p\nhard rule r { require p }\n",
    ),
}
