"""Every construct of the language, laid out in several ways, and ways to get it wrong."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Construct:
    """Layouts of one tree; and texts with one mistake each."""

    right: tuple[str, ...]
    wrong: tuple[str, ...] = ()


HEADER = [
    Construct(
        ('title "Germany"', 'title\n  "Germany"'),
        ("title Germany", 'title = "Germany"', 'titel "Germany"', 'title "Germany'),
    ),
    Construct(
        ('law "StVO" as of 2022-01-28', 'law\n"StVO"\nas of\n2022-01-28'),
        ('law "StVO" as of', 'law "StVO" of 2022-01-28', 'law "StVO" as of 28.1.2022'),
    ),
    Construct(
        ("extends vienna", "extends\n  vienna"),
        ("extends", 'extends "vienna"', "extends a, b", "extnds vienna", "extends 2go"),
    ),
    Construct(
        ("traffic left", "traffic\n  left"),
        ("traffic", "traffic near", "traffic: left", 'traffic "left"', "trafic left"),
    ),
    Construct(
        ("semantics finite", "semantics\nfinite"),
        ("semantics", "semantics ltlf", "semantics = finite", "semantic finite"),
    ),
    Construct(
        ("step 0.5 s", "step\n0.5 s", "step 0.5s"),
        ("step", "step s", "step = 0.5 s", "step -1 s", "step 0.5 s s"),
    ),
    Construct(
        (
            "priority safety > legal = courtesy",
            "priority safety > legal\n         = courtesy",
            "priority\n  safety >\n  legal =\n  courtesy",
        ),
        (
            "priority",
            "priority safety",
            "priority safety >",
            "priority a < b",
            "priority a, b",
            "priority a > b c > d",
            "priority a >= b",
            "priorty a > b",
        ),
    ),
]

ITEMS = [
    Construct(
        ("fact not (p and q)", "fact\n  not (p and q)", "fact not (p\n  and\n  q)"),
        ("fact", "fact p q", 'fact "p"', "fakt p", "fact (p and q", "fact p and"),
    ),
    Construct(
        ("constant p, q", "constant\n  p, q", "constant p,\n  q"),
        ("constant", "constant p q", 'constant "p"', "constnat p", "constant p,", "constant p = 5"),
    ),
    Construct(
        ("presumed p, q", "presumed\n  p, q", "presumed p,\n  q"),
        ("presumed", "presumed p q", "presumed not p", "presume p", "presumed p default false"),
    ),
    Construct(
        (
            "option zipper = on",
            "option\n  zipper = on",
            "option zipper\n  = on",
            "option zipper =\non",
        ),
        (
            "option zipper",
            "option zipper on",
            "option zipper =",
            "option zipper = true",
            "option zipper : on",
            "option = on",
            "optoin zipper = on",
            "option a b = on",
        ),
    ),
    Construct(
        (
            "param pace : speed = 7 km/h in force from 2020-04-28 until 2024-12-31",
            "param pace : speed = 7 km/h\n  in force from 2020-04-28 until 2024-12-31",
            "param pace : speed = 7 km/h in force\n  from 2020-04-28\n  until 2024-12-31",
            (
                "param pace\n  : speed\n  = 7 km/h\n  in force\n  from\n"
                "  2020-04-28\n  until\n  2024-12-31"
            ),
            "param pace:speed=7km/h in force from 2020-04-28 until 2024-12-31",
        ),
        (
            "param pace 7 km/h",
            "param pace : speed 7 km/h",
            "param pace : = 7 km/h",
            "param pace := 7 km/h",
            "param pace =",
            "param = 7 km/h",
            "param pace = 7 km/h from 2020-04-28",
            "param pace = 7 km/h in force",
            "param pace = 7 km/h\n  in force 2020-04-28",
            "param pace = 7 km/h in force\n  from 28.4.2020",
            "param pace = 7 km/h in force since 2020-04-28",
            "param pace = 7 km/h in force until 2024-12-31 from 2020-04-28",
            "param pace = 7 km/h in force from 2020-04-31",
            "param pace = 7 7",
            "parameter pace = 7 km/h",
        ),
    ),
    Construct(
        (
            "param gap = 1.5 m if built_up else 2 m",
            "param gap =\n  1.5 m if built_up\n  else 2 m",
            "param gap = 1.5 m\n  if built_up\n  else\n  2 m",
            "param gap = (1.5 m if built_up else 2 m)",
        ),
        (
            "param gap = 1.5 m if built_up",
            "param gap = 1.5 m if else 2 m",
            "param gap = 1.5 m if built_up else",
            "param gap = if built_up then 1.5 m else 2 m",
            "param gap = built_up ? 1.5 m : 2 m",
            "param gap = 1,5 m",
        ),
    ),
    Construct(
        (
            "define overtakes(v: vehicle, side) = behind(v) then beside(v) and side(v)",
            "define overtakes(v: vehicle, side) =\n  behind(v) then beside(v) and side(v)",
            "define overtakes(v: vehicle,\n  side) =\n  behind(v)\n  then beside(v) and\n  side(v)",
            (
                "define\n  overtakes (\n    v : vehicle,\n    side\n  )\n  =\n  behind(v) then\n"
                "  beside(v)\n  and side(v)"
            ),
        ),
        (
            "define overtakes(v: vehicle) { behind(v) }",
            "define overtakes(v: vehicle) {\n  behind(v)\n}",
            "define overtakes(v: vehicle): behind(v)",
            "define overtakes(v: vehicle) := behind(v)",
            "define overtakes(v: vehicle) behind(v)",
            "define overtakes(v: vehicle",
            "define overtakes(v vehicle) = behind(v)",
            "define overtakes(v: vehicle) =",
            "define overtakes() = p",
            "define = p",
            "define overtakes = p q",
            "define overtakes =\n  p q",
            "define overtakes = p and\n  q r",
            "define overtakes = p and",
            "define overtakes = (p and",
            "defin overtakes(v: vehicle) = behind(v)",
            "define until = p",
            "define rule = p",
        ),
    ),
    Construct(
        ("redefine near = gap < 3 m", "redefine near =\n  gap\n  < 3 m"),
        (
            "redefine near",
            "redefine near = gap <",
            "redefine near = gap < 3 m < 4 m",
            "redefin near = p",
        ),
    ),
    Construct(
        ("set zipper = off", "set zipper\n  = off", "set\n  zipper =\n  off"),
        ("set zipper", "set zipper off", "set zipper to off", "set zipper == off", "set = off"),
    ),
    Construct(
        (
            "set pace = 6 km/h in force from 2021-01-01",
            "set pace = 6 km/h\n  in force from 2021-01-01",
        ),
        (
            "set pace = 6 km/h force from 2021-01-01",
            "set pace = 6 km / ",
            "set pace = 6 km/h in force",
        ),
    ),
    Construct(
        (
            'drop rule queue_weave because "StVO has no such duty"',
            'drop rule queue_weave\n  because "StVO has no such duty"',
            'drop\n  rule\n  queue_weave\n  because\n  "StVO has no such duty"',
        ),
        (
            "drop queue_weave",
            'drop queue_weave because "no"',
            "drop rule queue_weave",
            "drop rule queue_weave because",
            "drop rule queue_weave because no duty",
            'drop rule queue_weave "no"',
            'drop rule because "no"',
            'drop rule a, b because "no"',
            'drop hard rule a because "no"',
            'dorp rule a because "no"',
            'remove rule a because "no"',
            'drop rule a because "no',
        ),
    ),
    Construct(
        (
            'soften rule signal_early in courtesy weight 2 because "custom"',
            'soften rule signal_early\n  in courtesy\n  weight 2\n  because "custom"',
            'soften\n  rule signal_early in\n  courtesy weight\n  2 because\n  "custom"',
        ),
        (
            "soften signal_early",
            "soften rule",
            "soften rule signal_early in",
            "soften rule signal_early weight",
            "soften rule signal_early weight two",
            "soften rule signal_early weight 2 in courtesy",
            'soften rule signal_early because "custom" weight 2',
            'soften rule signal_early "custom"',
            "sofen rule signal_early",
        ),
    ),
    Construct(
        (
            'topics { zebra "Zebra" of r, s; lights "Lamps" }',
            'topics {\n  zebra "Zebra" of r,\n    s;\n  lights "Lamps";\n}',
        ),
        (
            'topics { zebra "Zebra" lights "Lamps" }',
            'topics { zebra "Zebra"; "Lamps" }',
            "topics { zebra }",
            "topics { }",
            'topics zebra "Zebra"',
            'topics { zebra "Zebra" of rule r }',
            'topisc { zebra "Zebra" }',
        ),
    ),
    Construct(
        (
            'provisions "https://a" as of 2021-07-12 { "§ 1" "Care" to do; "§ 2" "R" }',
            'provisions "https://a"\n  as of 2021-07-12 {\n "§ 1" "Care"\n; "§ 2" "R" to\n do;\n}',
        ),
        (
            'provisions { "§ 1" "Care" }',
            'provisions "https://a" { § 1 "Care" }',
            'provisions "https://a" { "§ 1" }',
            'provisions "https://a" { "§ 1" "Care" done }',
            'provisions "https://a" { "§ 1" "Care" silent }',
            'provisions "https://a" of 2021-07-12 { "§ 1" "Care" }',
            'provisions "https://a" as of 2021-07-12 "§ 1" "Care"',
        ),
    ),
    Construct(
        (
            'provisions "https://a" as of 2021-07-12 certainty verified { "§ 1" "Care" }',
            'provisions "https://a"\n  as of\n2021-07-12 certainty verified {\n "§ 1" "Care"\n}',
        ),
        (
            'provisions "https://a" certainty sure { "§ 1" "Care" }',
            'provisions "https://a" certainty verified as of 2021-07-12 { "§ 1" "Care" }',
        ),
    ),
    Construct(
        (
            'provisions "a" { "1" "C" silent because "b"; "2" "" not machine-readable because "" }',
            (
                'provisions "a" {\n"1" "C"\nsilent\nbecause "b"; '
                '"2" ""\nnot\nmachine-readable\nbecause "" }'
            ),
        ),
        (
            'provisions "https://a" { "§ 2" "D" not machine readable because "c" }',
            'provisions "https://a" { "§ 2" "D" silent on "c" }',
        ),
    ),
    Construct(
        (
            'silent on zipper because "it leaves this open"',
            'silent\n  on zipper\n  because "it leaves this open"',
            'silent on\n  zipper because\n  "it leaves this open"',
        ),
        (
            "silent zipper",
            "silent on",
            "silent on zipper",
            "silent on zipper because open",
            'silent zipper because "open"',
            'silent on rule zipper because "open"',
            'silnt on zipper because "open"',
        ),
    ),
    Construct(
        (
            "quantity gap(v: vehicle) in m default 100",
            "quantity gap(v: vehicle)\n  in m\n  default 100",
        ),
        (
            "quantity gap(v: vehicle) m",
            "quantity gap(v: vehicle) in",
            "quantity gap(v: vehicle) in m default",
            "quantity gap(v: vehicle) in m default 100 m",
            "quantity in m",
        ),
    ),
]

HEADS = [
    Construct(
        (
            "hard rule keep_away (v: vehicle, p: pedestrian) in safety weight 2.5 {",
            "hard rule keep_away (v: vehicle, p: pedestrian)\n  in safety\n  weight 2.5 {",
            (
                "hard\nrule\nkeep_away\n(\nv\n:\nvehicle\n,\n"
                "p : pedestrian)\nin\nsafety\nweight\n2.5\n{"
            ),
        ),
        (
            "hard rule keep_away (v: vehicle) in {",
            "hard rule keep_away (v: vehicle) weight {",
            "hard rule keep_away (v: vehicle) weight two {",
            "hard rule keep_away (v: vehicle) weight 2 in safety {",
            "hard rule keep_away in safety (v: vehicle) {",
            "hard rule keep_away (v: vehicle) in a, b {",
            "hard keep_away in safety {",
            "hard rule in safety {",
            "hard rule keep_away (v: vehicle) in safety",
            "hard override rule keep_away {",
        ),
    ),
    Construct(
        ("override rule keep_away (v: vehicle) {", "override\n  rule keep_away\n  (v: vehicle) {"),
        (
            "override keep_away {",
            "override hard keep_away {",
            "overide rule keep_away {",
            "override rule {",
        ),
    ),
    Construct(
        ("override soft rule keep_away {", "override soft\n  rule\n  keep_away {"),
        ("override soft keep_away {", "override softly rule keep_away {"),
    ),
    Construct(("hard rule in_a_level_called_force in force {",)),
]

CONFIRMATIONS = [
    Construct(
        ("confirm rule keep_away {", "confirm\n  rule\n  keep_away {"),
        (
            "confirm keep_away {",
            "confirm hard rule keep_away {",
            "confirm rule keep_away (v: vehicle) {",
            "confirm rule keep_away in safety {",
            "confrim rule keep_away {",
            "confirm rule {",
        ),
    ),
]

CLAUSES = [
    Construct(
        ("topic zebra, lights", "topic\n    zebra,\n    lights"),
        ("topic", 'topic "zebra"', "topic zebra lights", "topics zebra", "topic zebra and lights"),
    ),
    Construct(
        ('source "StVO"', 'source\n    "StVO"'),
        ("source StVO", "source", 'souce "StVO"', 'source "StVO', 'source: "StVO"'),
    ),
    Construct(
        ("certainty secondary", "certainty\n    secondary"),
        ("certainty", "certainty sure", 'certainty "secondary"', "certanty secondary"),
    ),
    Construct(
        (
            "in force from 2020-01-01 until 2021-12-31",
            "in force\n    from 2020-01-01\n    until 2021-12-31",
            "in\n    force from\n    2020-01-01 until\n    2021-12-31",
        ),
        (
            "in force",
            "in force 2020-01-01",
            "in force since 2020-01-01",
            "in force from 1.1.2020",
            "in force from 2020-13-01",
            "in force from 2020-01-01 to 2021-12-31",
            "in froce from 2020-01-01",
            "from 2020-01-01",
        ),
    ),
    Construct(
        (
            "when built_up and rain",
            "when\n    built_up\n    and rain",
            "when built_up and\n    rain",
        ),
        ("when", "when built_up rain", "when built_up and", "wen built_up", "if built_up"),
    ),
    Construct(
        (
            "unless dense throughout",
            "unless dense\n    throughout",
            "unless\n    dense\n    throughout",
        ),
        (
            "unless",
            "unless throughout",
            "unless throughout dense",
            "unless dense during",
            "unless dense\n    throught",
            "unless dense throughout throughout",
            "unles dense throughout",
        ),
    ),
    Construct(
        (
            "unless dense or rain at some point",
            "unless dense or rain\n    at some point",
            "unless dense\n    or rain at\n    some point",
        ),
        (
            "unless dense at the end",
            "unless dense at any point",
            "unless dense at",
            "unless dense at some",
            "unless dense or at end",
        ),
    ),
    Construct(("unless dense at start", "unless dense\n    at start")),
    Construct(("unless dense at end", "unless dense\n    at\n    end")),
    Construct(("unless dense initially", "unless dense\n    initially")),
    Construct(("unless dense",)),
    Construct(
        (
            "require always[<= 3 s] gap(v) >= 2 s * speed",
            "require always[<= 3 s]\n    gap(v)\n    >= 2 s\n    * speed",
            "require always[\n    <= 3 s\n    ] gap(v) >=\n    2 s * speed",
        ),
        (
            "require always[< 3 s] p",
            "require always[<= 3] p",
            "require always[<= 3 s p",
            "require always[3 s, 4 s] p",
            "require always[\n    3 s, 4 s\n    ] p",
            "require not[<= 3 s] p",
            "require gap(v) >=",
            "require gap(v) >= 2 s speed",
            "require gap(v) >= 1,5 m",
            "require 1 m < gap(v) < 2 m",
            "require gap(v) == 2 m",
            "require gap(v) 2 m",
            "require gap(v) >\n    2 m m",
        ),
    ),
    Construct(
        (
            "require count x: vehicle (near(x) and not fast(x)) >= 8",
            "require count x: vehicle (\n      near(x)\n      and not fast(x)\n    ) >= 8",
            (
                "require\n    count\n    x : vehicle\n    (near(x) and\n"
                "    not fast(x))\n    >=\n    8"
            ),
        ),
        (
            "require count x in vehicle (near(x)) >= 8",
            "require count x: vehicle near(x) >= 8",
            "require count x: vehicle {\n      near(x)\n    } >= 8",
            "require count(x: vehicle (near(x))) >= 8",
            "require count x: vehicle (\n      near(x) >= 8",
            "require count x, y: vehicle (near(x)) >= 8",
            "require exists x: vehicle (near(x))",
            "require some x: vehicle",
            "require every: vehicle (p)",
        ),
    ),
    Construct(
        (
            "require gap(v) > (1.5 m if built_up else 2 m)",
            "require gap(v) > (\n      1.5 m\n      if built_up\n      else 2 m\n    )",
        ),
        (
            "require gap(v) > 1.5 m if built_up else 2 m",
            "require gap(v) > (1.5 m if built_up)",
            "require gap(v) > (built_up ? 1.5 m : 2 m)",
            "require if p then q",
        ),
    ),
    Construct(
        (
            'accept "slow" (v: vehicle) { speed = 3.5 km/h and p; gap(v) = -1 m }',
            (
                'accept "slow"\n    (v: vehicle) {\n      speed = 3.5 km/h\n'
                "      and p;\n      gap(v) =\n      -1 m\n    }"
            ),
            (
                'accept "slow" (v: vehicle)\n  {\n    speed\n'
                "    = 3.5 km/h and\n    p\n    ;\n    gap(v) = -1 m\n  }"
            ),
        ),
        (
            'accept "slow" (v vehicle) { p }',
            'accept "slow" (v: vehicle { p }',
            'accept (v: vehicle) "slow" { p }',
            'accept "slow" (v: vehicle) { speed > 3 km/h }',
            'accept "slow" { speed == 3 km/h }',
            'accept "slow" { speed 3 km/h }',
            'accept "slow" { speed = }',
            'accept "slow" { speed = fast }',
            'accept "slow" { speed = 3 km/h, p }',
            'accept "slow" { not speed = 3 km/h }',
            'accept "slow" { 3 km/h }',
            'accept "slow" (v: vehicle) speed = 3 km/h }',
        ),
    ),
    Construct(
        ("reject { true; p; true }", "reject {\n  true\n  ;\n  p; true }"),
        (
            "reject { true and p }",
            "reject { p and true }",
            "reject { not true }",
            "reject { false }",
            "reject { true true }",
        ),
    ),
]
