"""A rulebook with every temporal operator: of the future, of the past, and of both."""

ALL_KINDS = """
rulebook kinds
{semantics}
place is one of on, off, beyond default off
signal horn, wet default false
quantity speed in km/h default 0
fact wet implies speed <= 90 km/h

hard rule future {{
  require always[<= 3 s] (on implies next (horn weak until[2 s .. 4 s] wet)) xor eventually wet
}}
hard rule past {{
  require always (speed > 100 km/h implies once[1 s .. 3 s] horn or not (on since wet))
}}
hard rule both {{
  require always (on implies once (horn and eventually[<= 2 s] (beyond release wet)))
}}
"""
