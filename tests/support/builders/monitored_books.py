"""Small rulebooks of which monitors are generated."""

NARROW = """\
rulebook narrow
type car
signal stop, standing default false
light is one of red, amber, green default green
quantity speed in km/h default 0
quantity limit in km/h default 50
quantity gap(o: car) in m
signal parked(o: car) default false

hard rule stops { require always (stop implies eventually[<= 3 steps] standing) }
hard rule waits { require always (red implies speed <= 5 km/h) }
hard rule crawls { require always (count c: car (parked(c)) >= 2 implies speed < 36 km/h) }
hard rule keeps { require always speed - limit <= 0 km/h }
soft rule keeps_away (c: car) {
  require always (gap(c) < 8.3 m implies next (gap(c) >= 8.3 m or parked(c)))
}
"""
"""Each kind of word, and rules that take few states."""

WATCHED = """\
rulebook watched
type car
signal stop, standing default false
light is one of red, amber, green
quantity speed in km/h default 0
quantity gap(o: car) in m
quantity between(o: car, p: car) in m default 100
hard rule stops { require always (stop implies eventually[<= 2 steps] standing) }
hard rule waits { require always (red implies speed <= 5 km/h) }
soft rule keeps_away (c: car) { require always gap(c) >= 2.5 m }
soft rule lets_in (c: car, d: car) { require always (between(c, d) >= 10 m or gap(c) >= 2.5 m) }
"""
"""Rules of none, of one and of two objects."""

SINCE = """\
rulebook since
type car
signal beside(c: car) default true
hard rule begins_beside (c: car) { require always once beside(c) }
"""
"""A rule that the first state of each object decides."""

BLAMED = """\
rulebook blamed
type car
signal p, q(c: car)
hard rule owed (c: car) { require always (p implies eventually q(c)) }
"""
NO, YES, UNKNOWN = 0, 1, 255
WHO_IS_BLAMED = (
    (YES, {7: NO}, 7),
    (NO, {7: YES, 8: YES}, 7),
    # Both have left, having kept the rule
    (NO, {}, 0),
    (UNKNOWN, {9: NO}, 9),
    # It has left, and may have owed something; no other may
    (NO, {5: YES}, 9),
    (YES, {5: NO}, 9),
    (NO, {}, 5),
    (YES, {6: NO}, 5),
)
"""States of that rulebook: p, q of each car, and the car with the worst verdict from then on."""
