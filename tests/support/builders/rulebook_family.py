"""A family of three rulebooks in which everything happens that can happen to a rule."""

BASE = """\
rulebook mainland
title "Rules of the mainland"
law "Mainland Act" as of 2020-01-01
signal horn, siren, unused_word default false
quantity speed in km/h default 0

option strict = off
# What signs said.
param pace : speed = 30 km/h in force until 2021-12-31
param pace : speed = 25 km/h in force from 2022-01-01
define slow = speed <= pace
define never_used = speed > fastest
param fastest = 100 km/h

hard rule kept {
  cite "§ 9"
  says "Do not sound the horn."
  certainty verified
  require never horn
  accept { not horn }
  reject { horn }
}

hard rule changed {
  cite "§ 10"
  says "Be slow."
  source "a book"
  certainty secondary
  require always slow
  accept { speed = 20 km/h }
  reject { speed = 40 km/h }
}

hard rule softer { cite "§ 2" require never (horn and siren) certainty unverified }
hard rule agreed { cite "§ 3" says "Do not sound it twice." require never horn }
hard rule taken_out { require never siren }
hard rule left_open { require always siren }
"""

MIDDLE = """\
rulebook island
extends mainland
title "Rules of the island"
law "Island Act" as of 2024-01-01

provisions "https://example.org/island" { "§ 10a" "Slowness"; "§ 12" "Fees" }

set pace = 20 km/h
redefine slow = speed < pace

override rule changed {
  cite "§ 10a"
  certainty secondary
  require always[<= 3 s] slow
}

confirm rule agreed { cite "§ 11, custom" source "the Act" certainty verified accept { not horn } }
soften rule softer weight 2 because "only recommended"
drop rule taken_out because "there are no sirens"
silent on left_open because "nobody knows"
silent on parking because "left to the villages"
"""

TOP = """\
rulebook village
extends island

set strict = on

override rule changed { says "Be slow, please." }
hard rule own { require always not siren accept { siren } in force from 2024-06-01 }
hard rule expired { require always not siren in force until 2000-01-01 }
"""


def write(folder):
    """Write the three files into a folder, and return the path of the last."""
    for name, text in (("mainland", BASE), ("island", MIDDLE), ("village", TOP)):
        (folder / f"{name}.rules").write_text(text, encoding="utf-8")
    return folder / "village.rules"
