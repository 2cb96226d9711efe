"""Programs in C that give a generated monitor states of which nothing is known."""

from rulec.code_generation.monitor_layout import MonitorLayout
from rulec.vocabulary import Quantity

DRIVER = """\
#include "BOOK.h"
#define N_THERE MANYu
static volatile uint8_t any_byte;
static volatile uint32_t any_word;
static volatile double any_number;
int main(void)
{
    static BOOK_state monitor;
    BOOK_init(&monitor);
    while (any_byte != 0u) {
        static BOOK_object objects[N_THERE];
        static BOOK_input input;
        static BOOK_verdict verdict;
ARRAYS
        size_t each;
        const size_t n = any_word;
        for (each = 0u; each < N_THERE; each++) {
            BOOK_object_defaults(&objects[each], any_word, any_byte);
            BOOK_object_unknown(&objects[each], any_word, any_byte);
OBJECT
        }
        BOOK_input_defaults(&input);
        BOOK_input_unknown(&input);
WORLD
        input.n_objects = n;
        (void)BOOK_step(&monitor, &input, &verdict);
        input.objects = objects;
        input.n_objects = (n < N_THERE) ? n : N_THERE;
        (void)BOOK_step(&monitor, &input, &verdict);
        (void)BOOK_about(&monitor, any_word, any_word);
    }
    return 0;
}
"""
"""Any number of states, each with any number of objects up to one more than there are seats."""

NUMBERS = """\
rulebook numbers
type car
type person
signal stop default false
signal parked(o: car) default false
signal waits(o: person)
light is one of red, amber, green default green
quantity speed in km/h default 0
quantity limit in km/h default 50
quantity gap(o: car) in m
quantity between(o: car, p: car) in m default 100
fact not (red and stop)
hard rule stops { require always (stop implies eventually[<= 3 steps] green) }
hard rule crawls { require always (count c: car (parked(c)) >= 2 implies speed < 36 km/h) }
hard rule keeps { require always 2 * speed - limit <= 7 km/h }
soft rule apart (c: car, d: car) { require always (between(c, d) >= 8.3 m or gap(c) < gap(d)) }
soft rule told (c: car, p: person) { require always (gap(c) < 3 m implies next not waits(p)) }
"""
"""A rulebook with whatever C has code for: counts, sums, pairs, enumerations, facts."""


def driver(layout: MonitorLayout, name: str) -> str:
    """A program of which an analysis has to follow all that may be."""
    fields = layout.fields
    any_of = {True: "any_number", False: "any_byte"}

    def filled(about, of):
        return [
            f"        {of}{fields.identifiers[item.name]} = {any_of[isinstance(item, Quantity)]};"
            for item in fields.about(about)
        ]

    arrays, world = [], filled(0, "input.")
    for item in fields.about(2):
        field = fields.identifiers[item.name]
        kind = "double" if isinstance(item, Quantity) else "uint8_t"
        size = "N_THERE * N_THERE"
        arrays.append(f"        static {kind} all_{field}[{size}];")
        world += [
            f"        for (each = 0u; each < ({size}); each++) {{",
            f"            all_{field}[each] = {any_of[kind == 'double']};",
            "        }",
            f"        input.{field} = (any_byte != 0u) ? all_{field} : NULL;",
        ]
    parts = {
        "ARRAYS": "\n".join(arrays),
        "OBJECT": "\n".join(filled(1, "    objects[each].")),
        "WORLD": "\n".join(world),
        "MANY": str(layout.n_seats + 1),
        "BOOK": name,
    }
    text = DRIVER
    for what, instead in parts.items():
        text = text.replace(what, instead)
    return text


ANYTHING = """\
#include <math.h>
static uint32_t drawn = 1u;
static uint32_t any(uint32_t of)
{
    drawn = drawn * 1664525u + 1013904223u;
    return (drawn >> 8) % of;
}
#define any_byte ((uint8_t)(any(6u) == 0u ? 255u : any(6u)))
#define any_word any(N_THERE + 2u)
#define any_number (any(9u) == 0u ? (double)NAN : (any(9u) == 0u ? HUGE_VAL : any(400u) - 100.0))
"""


def random_driver(layout: MonitorLayout, name: str, n_states: int) -> str:
    """The same as a program that draws so many states by a linear congruence (Knuth, Lewis)."""
    text = driver(layout, name)
    for kind in ("uint8_t any_byte", "uint32_t any_word", "double any_number"):
        text = text.replace(f"static volatile {kind};\n", "")
    begin = "int main(void)\n{\n"
    loop = "while (any_byte != 0u) {"
    return text.replace(begin, f"{ANYTHING}{begin}    long left = {n_states};\n").replace(
        loop, "while (left-- > 0) {"
    )
