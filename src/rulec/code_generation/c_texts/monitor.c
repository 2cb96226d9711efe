@head@
#include "@name@.h"

#ifdef __FAST_MATH__
#error "numbers that are not known (NaN) take a compiler that keeps to IEEE 754"
#endif

/* By type, and the type of an object; nobody fits none. */
static const uint8_t rulec_fits[RULEC_TYPES][RULEC_TYPES + 1u] = {
    @fits@
};
static const uint16_t rulec_first[RULEC_TYPES] = {@first@};
static const uint16_t rulec_end[RULEC_TYPES] = {@end@};

@cells@
/* The state reached times 4, and the verdict: by state and class of letters. */
@entries@
static const uint16_t rulec_together[@n_together@u] = {
    @together@
};
static const uint8_t rulec_sizes[@n_sizes@u] = {
    @sizes@
};
static const uint16_t rulec_sizes_of[RULEC_SOURCES] = {@sizes_of@};

typedef struct {
    uint32_t first_cell;
    uint32_t first_entry;
    uint32_t first_instance;
    uint32_t n_instances;
    uint32_t first_word; /* of the sets of states */
    uint16_t n_cells;
    uint16_t n_classes;
    uint16_t n_states;
    uint16_t n_variables;
    uint16_t last; /* variable, if there are any */
    uint16_t first_together;
    uint16_t n_together;
    uint16_t seats_first[RULEC_VARIABLES];
    uint16_t seats_end[RULEC_VARIABLES];
    uint8_t types[RULEC_VARIABLES];
    uint8_t start; /* the verdict before the first state */
    uint8_t hard;
    uint8_t facts; /* facts exclude some letters */
} rulec_rule;

static const rulec_rule rulec_rules[RULEC_RULES] = {
    @rules@
};

const char *const rulec_rule_names[RULEC_RULES] = {
    @rule_names@
};
const char *const rulec_rule_articles[RULEC_RULES] = {
    @rule_articles@
};
const char *const rulec_sources[RULEC_N_SOURCES] = {
    @sources@
};
const uint8_t rulec_rule_variables[RULEC_RULES] = {@rule_variables@};

@readings@

@reading@

/* The machines. A rule has an instance for each choice of seats for its variables; an instance is
 * in one state of the rule's machine, or in one of several, if values are unknown.
 *
 * No access is outside of a table or an array, whatever these contain: a number read from a table
 * is bounded before it is used as an index, or the indexed table is padded. */

#define RULEC_NOBODY ((uint8_t)RULEC_TYPES) /* the type on an empty seat */
#define RULEC_EMPTY 0xffffu   /* no object of the input */
#define RULEC_SEVERAL 0xffffu /* not one entry of the table, or several classes of letters */
#define RULEC_LEAF 0x8000u
#define RULEC_EXCLUDED 0xffffu
#define RULEC_EXACTLY(verdict) ((uint8_t)((uint8_t)(verdict) * 5u)) /* best, and worst times 4 */
#define RULEC_WITHIN(best, worst) ((uint8_t)((uint8_t)(best) | (uint8_t)((uint8_t)(worst) << 2)))

#define RULEC_LOST ((uint8_t)1u)    /* violated for good */
#define RULEC_DOUBTED ((uint8_t)2u) /* perhaps violated by objects that have left */
#define RULEC_GONE ((uint8_t)4u)    /* `about` has some that have left, and perhaps violated it */

/* An instance's position: the entry that it took last, or RULEC_SEVERAL: then its states are a set,
 * and its verdict is stored separately. */
static inline uint8_t rulec_said(const rulec_state *state, uint32_t instance)
{
    const uint16_t at = state->at[instance];
    return (at == RULEC_SEVERAL) ? state->verdict[instance] : RULEC_EXACTLY(at & 3u);
}

/* The position of an instance during a step. */
typedef struct {
    uint32_t number;
    uint16_t turns[RULEC_VARIABLES]; /* among the seats that are or were taken */
    uint16_t seats[RULEC_VARIABLES];
    uint16_t start; /* the first cell that depends on objects */
    uint32_t first; /* the instance with the first seat for the last variable */
    const uint16_t *digits[RULEC_SOURCES];
} rulec_instance;

/* The seat that an object had; a likely one is tried first. */
static uint16_t rulec_seat_of(const rulec_state *state, uint32_t id, uint8_t type, uint16_t likely)
{
    uint16_t seat = likely;
    if ((seat < RULEC_SEATS) && (state->id[seat] == id) && (state->type[seat] == type)) {
        return seat;
    }
    for (seat = rulec_first[type]; seat < rulec_end[type]; seat++) {
        if ((state->id[seat] == id) && (state->type[seat] == type)) {
            return seat;
        }
    }
    return RULEC_EMPTY;
}

/* Whether an object is also at an earlier place of the input. */
static bool rulec_is_repeated(const rulec_input *in, size_t one)
{
    size_t other;
    for (other = 0u; other < one; other++) {
        if ((in->objects[other].id == in->objects[one].id)
            && (in->objects[other].type == in->objects[one].type)) {
            return true;
        }
    }
    return false;
}

/* Seats: objects keep theirs while they are present, others get free seats. Nothing is kept about
 * objects without a seat: if a type had some, any object of it that now gets one may be of them. */
static rulec_status rulec_seat(rulec_state *state, const rulec_input *in, uint32_t *left_out)
{
    size_t one;
    uint16_t seat;
    size_t n_new = 0u;
    uint16_t next = 0u; /* the next object's seat, if objects are in the order of their seats */
    *left_out = 0u;
    state->crowded = 0u;
    for (seat = 0u; seat < RULEC_TYPES; seat++) {
        state->next_left_out[seat] = 0u;
    }
    for (seat = 0u; seat < RULEC_SEATS; seat++) {
        state->seated[seat] = RULEC_EMPTY;
    }
    for (one = 0u; one < in->n_objects; one++) {
        const uint8_t type = in->objects[one].type;
        if (type >= RULEC_TYPES) {
            return RULEC_BAD_TYPE;
        }
        seat = rulec_seat_of(state, in->objects[one].id, type, next);
        if (seat < RULEC_SEATS) {
            if (state->seated[seat] != RULEC_EMPTY) {
                return RULEC_TWICE;
            }
            state->seated[seat] = (uint16_t)one;
            next = (uint16_t)(seat + 1u);
        }
        n_new += (seat < RULEC_SEATS) ? 0u : 1u;
    }
    for (seat = 0u; seat < RULEC_SEATS; seat++) {
        const bool stays = state->seated[seat] != RULEC_EMPTY;
        state->stays[seat] = stays ? 1u : 0u;
        state->earlier[seat] = state->stays[seat];
        state->next_id[seat] = state->id[seat];
        state->next_type[seat] = stays ? state->type[seat] : RULEC_NOBODY;
    }
    for (one = 0u; (n_new > 0u) && (one < in->n_objects); one++) {
        const uint32_t id = in->objects[one].id;
        const uint8_t type = in->objects[one].type;
        uint16_t free = RULEC_EMPTY;
        bool has_seat = false;
        if (type >= RULEC_TYPES) {
            return RULEC_BAD_TYPE;
        }
        for (seat = rulec_first[type]; seat < rulec_end[type]; seat++) {
            const uint16_t other = state->seated[seat];
            if (other == (uint16_t)one) {
                has_seat = true;
                break;
            }
            if (other >= in->n_objects) {
                free = (free == RULEC_EMPTY) ? seat : free; /* it is free */
            } else if ((in->objects[other].id == id) && (in->objects[other].type == type)) {
                return RULEC_TWICE;
            } else {
                /* another object's seat */
            }
        }
        if (!has_seat && (free < RULEC_SEATS)) {
            state->seated[free] = (uint16_t)one;
            state->next_id[free] = id;
            state->next_type[free] = type;
            state->earlier[free] = state->left_out[type];
        } else if (!has_seat) {
            if (rulec_is_repeated(in, one)) {
                return RULEC_TWICE;
            }
            *left_out += 1u;
            state->crowded = 1u;
            state->next_left_out[type] = 1u;
        } else {
            /* has a seat already */
        }
    }
    return RULEC_OK;
}

/* The class of the letter that is read, from a cell on, if no unknown value matters. */
static inline uint16_t rulec_class(const uint16_t *cells, uint16_t start,
    const uint16_t *const *digits)
{
    uint16_t at = start;
    while (at < RULEC_NODES) {
        const uint16_t read = cells[at];
        const uint16_t digit = digits[read >> 12][read & RULEC_PLACES];
        if (digit > RULEC_MOST_DIGIT) {
            return RULEC_SEVERAL;
        }
        at = cells[at + 1u + digit];
    }
    return (uint16_t)(at & 0x7fffu);
}

/* The first cell that reads objects, after the reads of no object; a class if there is none. */
static uint16_t rulec_start(const uint16_t *cells, const uint16_t *world)
{
    uint16_t at = cells[0];
    while (at < RULEC_NODES) {
        const uint16_t read = cells[at];
        const uint16_t digit = world[read & RULEC_PLACES];
        if ((read >= 0x1000u) || (digit > RULEC_MOST_DIGIT)) {
            break;
        }
        at = cells[at + 1u + digit];
    }
    return at;
}

static inline void rulec_set(uint32_t *bits, uint32_t place)
{
    bits[place >> 5] |= (uint32_t)1u << (place & 31u);
}

static inline bool rulec_is_set(const uint32_t *bits, uint32_t place)
{
    return ((bits[place >> 5] >> (place & 31u)) & 1u) != 0u;
}

static void rulec_clear(uint32_t *bits, uint32_t n)
{
    uint32_t word;
    for (word = 0u; word <= (n >> 5); word++) {
        bits[word] = 0u;
    }
}

/* The target of a cell: a class, or a node to be visited later, since cells only lead onward. */
static void rulec_lead(rulec_state *state, uint16_t cell)
{
    const uint32_t by = (uint32_t)cell & 0x7fffu;
    if (cell < RULEC_NODES) {
        rulec_set(state->reached, cell);
    } else if (by < (RULEC_CLASS_WORDS * 32u)) {
        rulec_set(state->classes, by);
    } else {
        /* facts exclude such a state */
    }
}

/* All classes of letters that an instance may read; false if there is none. */
static bool rulec_classes(rulec_state *state, const rulec_rule *rule, const uint16_t *const *digits)
{
    const uint16_t *const cells = &rulec_cells[rule->first_cell];
    uint16_t at = 1u;
    bool any = false;
    uint32_t word;
    rulec_clear(state->reached, rule->n_cells);
    rulec_clear(state->classes, rule->n_classes);
    rulec_lead(state, cells[0]);
    while (at < rule->n_cells) {
        const uint16_t read = cells[at];
        if (rulec_is_set(state->reached, at)) {
            const uint16_t digit = digits[read >> 12][read & RULEC_PLACES];
            uint16_t each;
            for (each = RULEC_LEAST(digit);
                 (each <= RULEC_MOST_DIGIT) && (each <= RULEC_GREATEST(digit)); each++) {
                rulec_lead(state, cells[at + 1u + each]);
            }
        }
        at = (uint16_t)(at + 1u + rulec_sizes[rulec_sizes_of[read >> 12] + (read & RULEC_PLACES)]);
    }
    for (word = 0u; word <= ((uint32_t)rule->n_classes >> 5); word++) {
        any = any || (state->classes[word] != 0u);
    }
    return any;
}

/* The entry for a state and a class of letters. */
static inline uint16_t rulec_entry(const rulec_rule *rule, uint32_t from, uint32_t by)
{
    const uint32_t place = rule->first_entry + (from * rule->n_classes) + by;
    return rulec_entries[(place < RULEC_ENTRIES) ? place : 0u];
}

/* The set of states of an instance. */
static uint32_t *rulec_states_of(rulec_state *state, const rulec_rule *rule, uint32_t instance)
{
    const uint32_t first = rule->first_word
        + ((instance - rule->first_instance) * (((uint32_t)rule->n_states >> 5) + 1u));
    return &state->states[(first < RULEC_WORDS) ? first : 0u];
}

/* The past of an instance is unknown: it may be in any state. */
static void rulec_forget(rulec_state *state, const rulec_rule *rule, uint32_t instance)
{
    uint32_t *const states = rulec_states_of(state, rule, instance);
    uint32_t word;
    for (word = 0u; word <= ((uint32_t)rule->n_states >> 5); word++) {
        states[word] = UINT32_MAX;
    }
    state->at[instance] = RULEC_SEVERAL;
    state->verdict[instance] = RULEC_WITHIN(RULEC_SATISFIED, RULEC_VIOLATED);
}

/* A step with unknown values: from each possible state by each possible class. */
static void rulec_advance_all(rulec_state *state, const rulec_rule *rule, uint32_t instance)
{
    uint32_t *const states = rulec_states_of(state, rule, instance);
    uint8_t best = RULEC_VIOLATED;
    uint8_t worst = RULEC_SATISFIED;
    uint16_t last = 0u;
    uint32_t found = 0u;
    uint16_t from;
    uint16_t by;
    uint32_t word;
    if (state->at[instance] != RULEC_SEVERAL) {
        const uint16_t only = (uint16_t)(state->at[instance] >> 2);
        rulec_clear(states, rule->n_states);
        if (only < rule->n_states) {
            rulec_set(states, only);
        }
    }
    rulec_clear(state->following, rule->n_states);
    for (from = 0u; from < rule->n_states; from++) {
        if (rulec_is_set(states, from)) {
            for (by = 0u; by < rule->n_classes; by++) {
                if (rulec_is_set(state->classes, by)) {
                    const uint16_t entry = rulec_entry(rule, from, by);
                    const uint8_t verdict = (uint8_t)(entry & 3u);
                    const uint16_t next = (uint16_t)(entry >> 2);
                    if (next < rule->n_states) {
                        last = next;
                        found += rulec_is_set(state->following, next) ? 0u : 1u;
                        rulec_set(state->following, next);
                    }
                    best = (verdict < best) ? verdict : best;
                    worst = (verdict > worst) ? verdict : worst;
                }
            }
        }
    }
    for (word = 0u; word <= ((uint32_t)rule->n_states >> 5); word++) {
        states[word] = state->following[word];
    }
    if ((found == 1u) && (best == worst)) {
        state->at[instance] = (uint16_t)((uint16_t)(last << 2) | best);
    } else {
        state->at[instance] = RULEC_SEVERAL;
    }
    state->verdict[instance] = RULEC_WITHIN(best, worst);
}

/* A step by the input's values. */
static void rulec_advance(rulec_state *state, const rulec_rule *rule, const rulec_instance *one)
{
    const uint16_t by = rulec_class(&rulec_cells[rule->first_cell], one->start, one->digits);
    const uint16_t from = state->at[one->number];
    if ((by != RULEC_SEVERAL) && (from != RULEC_SEVERAL)) {
        state->at[one->number] = rulec_entry(rule, (uint32_t)from >> 2, by);
    } else {
        if (by == RULEC_SEVERAL) {
            (void)rulec_classes(state, rule, one->digits);
        } else {
            rulec_clear(state->classes, rule->n_classes);
            rulec_lead(state, (uint16_t)(by | RULEC_LEAF));
        }
        rulec_advance_all(state, rule, one->number);
    }
}

/* Remember the objects of an instance as those with the worst verdict. */
static void rulec_tell(rulec_state *state, uint16_t number, const rulec_instance *one,
    const uint32_t *ids)
{
    uint16_t variable;
    for (variable = 0u; variable < RULEC_VARIABLES; variable++) {
        state->about[number][variable] = ids[one->seats[variable]];
    }
}

/* Whether the objects with the worst verdict are those of an earlier step. */
static bool rulec_is_told(const rulec_state *state, uint16_t number)
{
    return (state->flags[number] & (RULEC_LOST | RULEC_GONE)) != 0u;
}

/* Before a step: no objects have the worst verdict, unless some of an earlier step do. */
static void rulec_tell_nobody(rulec_state *state, uint16_t number)
{
    uint16_t variable;
    for (variable = 0u; (variable < RULEC_VARIABLES) && !rulec_is_told(state, number); variable++) {
        state->about[number][variable] = 0u;
    }
}

/* The rule is violated for good by the objects of an instance. */
static void rulec_lose(rulec_state *state, uint16_t number, const rulec_instance *one,
    const uint32_t *ids)
{
    state->violations += 1u;
    state->flags[number] |= RULEC_LOST;
    rulec_tell(state, number, one, ids);
}

/* Objects leave: a pending verdict becomes violated, an open one stays open. */
static void rulec_part(rulec_state *state, uint16_t number, const rulec_instance *one)
{
    const uint8_t verdict = rulec_said(state, one->number);
    const uint8_t best = verdict & 3u;
    const uint8_t worst = (uint8_t)(verdict >> 2);
    if ((best != RULEC_VIOLATED) && (best >= RULEC_PENDING)) {
        rulec_lose(state, number, one, state->id);
    } else if ((best != RULEC_VIOLATED) && (worst >= RULEC_PENDING)) {
        if (!rulec_is_told(state, number)) {
            rulec_tell(state, number, one, state->id);
            state->flags[number] |= RULEC_GONE;
        }
        state->flags[number] |= RULEC_DOUBTED;
    } else {
        /* kept, or violated before */
    }
}

/* The digits that an instance reads about several objects together. */
static void rulec_look(rulec_state *state, const rulec_input *in, const rulec_rule *rule,
    const rulec_instance *one)
{
    uint16_t each;
    uint16_t variable;
    for (each = 0u; each < rule->n_together; each++) {
        size_t who[RULEC_VARIABLES];
        bool are_seated = true;
        const uint16_t read = rulec_together[rule->first_together + each];
        for (variable = 0u; variable < RULEC_VARIABLES; variable++) {
            const bool is = variable < rule->n_variables;
            const size_t own = is ? state->seated[one->seats[variable]] : 0u;
            are_seated = are_seated && (own < in->n_objects);
            who[variable] = (own < in->n_objects) ? own : 0u;
        }
        if (are_seated) {
            state->digits[RULEC_SHARED + read] = rulec_read_together(in, who, read);
        }
    }
}

typedef struct {
    bool was;     /* all objects were present in the state before */
    bool stays;   /* and all are still present */
    bool is;      /* all are present now */
    bool earlier; /* all that are present now were so in the state before, or may have been */
} rulec_presence;

/* The worst of the best verdicts so far, and the worst one as stored (best, and worst times 4). */
typedef struct {
    uint8_t best;
    uint8_t worst;
} rulec_tally;

/* Bind a variable to the object on a seat; false if another variable has it. */
static inline bool rulec_bind(const rulec_state *state, uint16_t variable, uint16_t seat,
    rulec_instance *one)
{
    uint16_t other;
    for (other = 0u; other < variable; other++) {
        if (one->seats[other] == seat) {
            return false;
        }
    }
    one->seats[variable] = seat;
    one->digits[variable + 1u] = &state->digits[RULEC_OWN + (seat * RULEC_OWN_READS)];
    return true;
}

/* Go on to the next choice of seats for all variables but the last; false after the last one. */
static bool rulec_turn(const rulec_state *state, const rulec_rule *rule, rulec_instance *one)
{
    uint16_t variable = rule->last;
    bool carry = true;
    while (carry && (variable > 0u)) {
        uint16_t turn;
        variable--;
        turn = (uint16_t)(one->turns[variable] + 1u);
        if (turn < state->n_taken) {
            one->turns[variable] = turn;
            carry = false;
        } else {
            one->turns[variable] = 0u;
        }
    }
    return !carry;
}

/* Bind all variables but the last for this turn; whether their objects are or were present. */
static bool rulec_there(const rulec_state *state, const rulec_rule *rule, rulec_instance *one,
    rulec_presence *found)
{
    const uint16_t last = rule->last;
    uint16_t variable;
    one->first = 0u;
    found->was = true;
    found->stays = true;
    found->is = true;
    found->earlier = true;
    for (variable = 0u; variable < last; variable++) {
        const uint16_t turn = one->turns[variable];
        const uint16_t seat = state->taken[(turn < RULEC_SEATS) ? turn : 0u];
        const uint8_t *const fits = rulec_fits[rule->types[variable]];
        if ((seat < rule->seats_first[variable]) || (seat >= rule->seats_end[variable])
            || !rulec_bind(state, variable, seat, one)) {
            return false;
        }
        one->first *= (uint32_t)rule->seats_end[variable] - rule->seats_first[variable];
        one->first += (uint32_t)seat - rule->seats_first[variable];
        found->was = found->was && (fits[state->type[seat]] != 0u);
        found->is = found->is && (fits[state->next_type[seat]] != 0u);
        found->stays = found->stays && (state->stays[seat] != 0u);
        found->earlier = found->earlier && (state->earlier[seat] != 0u);
    }
    one->first *= (uint32_t)rule->seats_end[last] - rule->seats_first[last];
    one->first += rule->first_instance;
    one->first -= rule->seats_first[last];
    return found->was || found->is;
}

/* Move to the instance whose last variable has the object on a seat. */
static inline void rulec_stand(rulec_instance *one, uint16_t seat)
{
    const uint32_t number = one->first + seat;
    one->number = (number < RULEC_INSTANCES) ? number : 0u;
}

static void rulec_begin(const rulec_state *state, const rulec_rule *rule, rulec_instance *one)
{
    uint16_t each;
    one->first = rule->first_instance;
    one->start = rulec_start(&rulec_cells[rule->first_cell], state->digits);
    rulec_stand(one, 0u);
    for (each = 0u; each < RULEC_SOURCES; each++) {
        one->digits[each] = state->digits;
    }
    one->digits[RULEC_TOGETHER] = &state->digits[RULEC_SHARED];
    for (each = 0u; each < RULEC_VARIABLES; each++) {
        one->turns[each] = 0u;
        one->seats[each] = 0u;
    }
}

/* Add an instance's verdict to its rule's; `before` is its verdict one step ago. */
static void rulec_hear(rulec_state *state, uint16_t number, const rulec_instance *one,
    uint8_t before, rulec_tally *tally)
{
    const uint8_t now = rulec_said(state, one->number);
    if ((now == RULEC_EXACTLY(RULEC_VIOLATED)) && (before != now)) {
        rulec_lose(state, number, one, state->next_id);
    }
    tally->best = ((now & 3u) > tally->best) ? (uint8_t)(now & 3u) : tally->best;
    /* Compares the worst verdict first, then the best one, as a single number */
    if (now > tally->worst) {
        tally->worst = now;
        if (!rulec_is_told(state, number)) {
            rulec_tell(state, number, one, state->next_id);
        }
    }
}

/* A step of one instance: it ends, begins, or goes on. */
static void rulec_visit(rulec_state *state, const rulec_input *in, uint16_t number,
    const rulec_instance *one, rulec_presence there, rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    if (there.was && !there.stays) {
        rulec_part(state, number, one);
    }
    if (there.is) {
        uint8_t before;
        if (there.earlier && !there.stays) {
            rulec_forget(state, rule, one->number);
        } else if (!there.stays) {
            state->at[one->number] = rule->start;
        } else {
            /* goes on */
        }
        rulec_look(state, in, rule, one);
        before = rulec_said(state, one->number);
        rulec_advance(state, rule, one);
        rulec_hear(state, number, one, before, tally);
    }
}

/* Some seats in turn for the last variable of a rule; `there`: presence of the others' objects. */
static void rulec_visit_each(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_instance *one, const rulec_presence *there, const uint16_t *seats, uint16_t n_seats,
    rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    const uint16_t last = rule->last;
    const uint8_t *const fits = rulec_fits[rule->types[last]];
    uint16_t each;
    for (each = 0u; each < n_seats; each++) {
        const uint16_t seat = seats[each];
        rulec_presence all;
        all.is = there->is && (fits[state->next_type[seat]] != 0u);
        all.was = there->was && (fits[state->type[seat]] != 0u);
        all.stays = there->stays && (state->stays[seat] != 0u);
        all.earlier = there->earlier && (state->earlier[seat] != 0u);
        if ((all.is || all.was) && rulec_bind(state, last, seat, one)) {
            rulec_stand(one, seat);
            rulec_visit(state, in, number, one, all, tally);
        }
    }
}

/* The seats of the objects of a type that stay. */
static void rulec_find_fitting(rulec_state *state, uint8_t type)
{
    const uint8_t *const fits = rulec_fits[type];
    uint16_t each;
    uint16_t n = 0u;
    for (each = 0u; (each < state->n_taken) && (n < RULEC_SEATS); each++) {
        const uint16_t seat = state->taken[each];
        state->fitting[n] = seat;
        n = (uint16_t)(n + (state->stays[seat] & fits[state->type[seat]]));
    }
    state->n_fitting = n;
    state->fitting_type = type;
}

/* The next entry of an instance, by a class of letters; its verdict is added if it changed. */
static inline void rulec_enter(rulec_state *state, uint16_t number, rulec_instance *one,
    uint16_t entry, rulec_tally *tally)
{
    const uint8_t verdict = (uint8_t)(entry & 3u);
    const uint8_t before = (uint8_t)(state->at[one->number] & 3u);
    state->at[one->number] = entry;
    if ((verdict > tally->best) || ((verdict == RULEC_VIOLATED) && (before != RULEC_VIOLATED))) {
        rulec_hear(state, number, one, RULEC_EXACTLY(before), tally);
    }
}

/* The objects that stay, in turn for the last variable of a rule whose others stay, too. If all
 * values are known, the entry is looked up; if its verdict has not changed, nothing else needs to
 * be done. */
static void rulec_visit_fitting(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_instance *one, rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    const uint16_t *const cells = &rulec_cells[rule->first_cell];
    const uint16_t last = rule->last;
    const uint16_t n_fitting = state->n_fitting;
    const uint16_t start = one->start;
    uint16_t each;
    for (each = 0u; each < n_fitting; each++) {
        const uint16_t seat = state->fitting[each];
        if (rulec_bind(state, last, seat, one)) {
            const uint16_t by = rulec_class(cells, start, one->digits);
            uint16_t from;
            rulec_stand(one, seat);
            from = state->at[one->number];
            if ((by != RULEC_SEVERAL) && (from != RULEC_SEVERAL)) {
                rulec_enter(state, number, one, rulec_entry(rule, (uint32_t)from >> 2, by), tally);
            } else {
                const rulec_presence always = {true, true, true, true};
                rulec_visit(state, in, number, one, always, tally);
            }
        }
    }
}

/* A rule about no object. */
static void rulec_visit_world(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_instance *one, rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    const uint16_t from = state->at[one->number];
    if ((one->start >= RULEC_LEAF) && (from != RULEC_SEVERAL)) {
        rulec_enter(state, number, one,
            rulec_entry(rule, (uint32_t)from >> 2, (uint32_t)one->start & 0x7fffu), tally);
    } else {
        const rulec_presence always = {true, true, true, true};
        rulec_visit(state, in, number, one, always, tally);
    }
}

/* All objects in turn for the last variable of a rule; `there`: presence of the others' objects. */
static void rulec_visit_last(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_instance *one, const rulec_presence *there, rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    const uint8_t type = rule->types[rule->last];
    if (there->is && there->stays && (rule->n_together == 0u)) {
        if (state->fitting_type != type) {
            rulec_find_fitting(state, type);
        }
        rulec_visit_fitting(state, in, number, one, tally);
        rulec_visit_each(state, in, number, one, there, state->changed, state->n_changed, tally);
    } else {
        rulec_visit_each(state, in, number, one, there, state->taken, state->n_taken, tally);
    }
}

static void rulec_visit_all(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    rulec_instance one;
    rulec_presence there = {true, true, true, true};
    bool more = state->n_taken > 0u;
    rulec_begin(state, rule, &one);
    if (rule->n_variables == 0u) {
        rulec_visit_world(state, in, number, &one, tally);
    } else {
        while (more) {
            if (rulec_there(state, rule, &one, &there)) {
                rulec_visit_last(state, in, number, &one, &there, tally);
            }
            more = rulec_turn(state, rule, &one);
        }
    }
}

/* Whether facts exclude the values that a rule reads about some objects. */
static bool rulec_is_excluded(rulec_state *state, const rulec_input *in, const rulec_rule *rule)
{
    rulec_instance one;
    rulec_presence there;
    bool excluded = false;
    bool more = state->n_taken > 0u;
    rulec_begin(state, rule, &one);
    if (rule->n_variables == 0u) {
        return !rulec_classes(state, rule, one.digits);
    }
    while (more) {
        uint16_t turn;
        const bool is = rulec_there(state, rule, &one, &there) && there.is;
        const uint16_t last = rule->last;
        for (turn = 0u; is && (turn < state->n_taken); turn++) {
            const uint16_t seat = state->taken[turn];
            if ((seat >= rule->seats_first[last]) && (seat < rule->seats_end[last])
                && (rulec_fits[rule->types[last]][state->next_type[seat]] != 0u)
                && rulec_bind(state, last, seat, &one)) {
                rulec_look(state, in, rule, &one);
                excluded = excluded || !rulec_classes(state, rule, one.digits);
            }
        }
        more = rulec_turn(state, rule, &one);
    }
    return excluded;
}

static void rulec_judge(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_range *said)
{
    const rulec_rule *const rule = &rulec_rules[number];
    rulec_tally tally = {0u, 0u};
    uint16_t kind;
    rulec_tell_nobody(state, number);
    rulec_visit_all(state, in, number, &tally);
    said->best = tally.best;
    said->worst = (uint8_t)(tally.worst >> 2);
    if ((rule->n_variables > 0u) && (rule->start != RULEC_SATISFIED)) {
        said->best = (said->best == RULEC_SATISFIED) ? (uint8_t)RULEC_HOLDS_SO_FAR : said->best;
        said->worst = (said->worst == RULEC_SATISFIED) ? (uint8_t)RULEC_HOLDS_SO_FAR : said->worst;
        for (kind = 0u; (state->crowded != 0u) && (kind < RULEC_TYPES); kind++) {
            uint16_t variable;
            for (variable = 0u; variable < rule->n_variables; variable++) {
                if ((state->next_left_out[kind] != 0u)
                    && (rulec_fits[rule->types[variable]][kind] != 0u)) {
                    state->flags[number] |= RULEC_DOUBTED;
                }
            }
        }
    }
    if (state->flags[number] != 0u) {
        said->worst = RULEC_VIOLATED;
    }
    if ((state->flags[number] & RULEC_LOST) != 0u) {
        said->best = RULEC_VIOLATED;
    }
}

size_t rulec_state_size(void)
{
    return sizeof(rulec_state);
}

void rulec_init(rulec_state *state)
{
    uint32_t each;
    uint16_t variable;
    for (each = 0u; each < RULEC_SEATS; each++) {
        state->id[each] = 0u;
        state->type[each] = RULEC_NOBODY;
        state->next_id[each] = 0u;
        state->next_type[each] = RULEC_NOBODY;
        state->seated[each] = RULEC_EMPTY;
        state->stays[each] = 0u;
        state->earlier[each] = 0u;
        state->taken[each] = 0u;
        state->changed[each] = 0u;
        state->fitting[each] = 0u;
    }
    for (each = 0u; each < RULEC_DIGITS; each++) {
        state->digits[each] = 0u;
    }
    for (each = 0u; each < (RULEC_WORDS + RULEC_STATE_WORDS); each++) {
        state->states[each] = 0u;
    }
    rulec_clear(state->reached, (RULEC_CELL_WORDS * 32u) - 1u);
    rulec_clear(state->classes, (RULEC_CLASS_WORDS * 32u) - 1u);
    rulec_clear(state->following, (RULEC_STATE_WORDS * 32u) - 1u);
    for (each = 0u; each < RULEC_INSTANCES; each++) {
        state->at[each] = 0u;
        state->verdict[each] = 0u;
    }
    for (each = 0u; each < RULEC_RULES; each++) {
        const rulec_rule *const rule = &rulec_rules[each];
        state->flags[each] = 0u;
        for (variable = 0u; variable < RULEC_VARIABLES; variable++) {
            state->about[each][variable] = 0u;
        }
        if (rule->n_variables == 0u) {
            state->at[rule->first_instance] = rule->start;
        }
    }
    state->violations = 0u;
    for (each = 0u; each < RULEC_TYPES; each++) {
        state->left_out[each] = 0u;
    }
    state->crowded = 0u;
    state->fitting_type = RULEC_NOBODY;
    state->n_taken = 0u;
    state->n_changed = 0u;
    state->n_fitting = 0u;
}

rulec_status rulec_step(rulec_state *state, const rulec_input *input, rulec_verdict *verdict)
{
    rulec_status status;
    uint32_t left_out = 0u;
    uint16_t each;
    if ((state == NULL) || (input == NULL) || (verdict == NULL)
        || ((input->objects == NULL) && (input->n_objects > 0u))) {
        return RULEC_NULL;
    }
    if (input->n_objects > RULEC_MOST_OBJECTS) {
        return RULEC_TOO_MANY;
    }
    status = rulec_seat(state, input, &left_out);
    if (status != RULEC_OK) {
        return status;
    }
    state->n_taken = 0u;
    state->n_changed = 0u;
    state->fitting_type = RULEC_NOBODY;
    for (each = 0u; (each < RULEC_SEATS) && (state->n_taken < RULEC_SEATS)
         && (state->n_changed < RULEC_SEATS); each++) {
        if ((state->type[each] != RULEC_NOBODY) || (state->next_type[each] != RULEC_NOBODY)) {
            state->taken[state->n_taken] = each;
            state->n_taken++;
            if (state->stays[each] == 0u) {
                state->changed[state->n_changed] = each;
                state->n_changed++;
            }
        }
    }
    rulec_read_world(input, state->digits);
    for (each = 0u; each < RULEC_SEATS; each++) {
        const uint16_t one = state->seated[each];
        if (one < input->n_objects) {
            rulec_read_own(input, one, &state->digits[RULEC_OWN + (each * RULEC_OWN_READS)]);
        }
    }
    for (each = 0u; each < RULEC_RULES; each++) {
        if ((rulec_rules[each].facts != 0u) && rulec_is_excluded(state, input, &rulec_rules[each])) {
            return RULEC_EXCLUDED_BY_FACTS;
        }
    }
    /* Up to here a refused state has changed nothing. */
    verdict->left_out = left_out;
    verdict->book.best = RULEC_SATISFIED;
    verdict->book.worst = RULEC_SATISFIED;
    for (each = 0u; each < RULEC_RULES; each++) {
        const rulec_range *const said = &verdict->rules[each];
        rulec_judge(state, input, each, &verdict->rules[each]);
        if (rulec_rules[each].hard != 0u) {
            verdict->book.best = (said->best > verdict->book.best) ? said->best : verdict->book.best;
            verdict->book.worst = (said->worst > verdict->book.worst) ? said->worst : verdict->book.worst;
        }
    }
    for (each = 0u; each < RULEC_SEATS; each++) {
        state->id[each] = state->next_id[each];
        state->type[each] = state->next_type[each];
    }
    for (each = 0u; each < RULEC_TYPES; each++) {
        state->left_out[each] = state->next_left_out[each];
    }
    verdict->violations = state->violations;
    return RULEC_OK;
}

uint32_t rulec_about(const rulec_state *state, uint32_t rule, uint32_t variable)
{
    uint32_t id = 0u;
    if ((rule < RULEC_RULES) && (variable < rulec_rule_variables[rule])) {
        id = state->about[rule][variable];
    }
    return id;
}
