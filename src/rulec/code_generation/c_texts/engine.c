/* The machines. A rule has an instance for each choice of seats that its variables may stand for;
 * an instance is in one state of the rule's machine, or in one of several, if not all is known. */

#define RULEC_NOBODY ((uint8_t)RULEC_TYPES) /* the type of who sits on an empty seat */
#define RULEC_EMPTY 0xffffu   /* no object of the input */
#define RULEC_SEVERAL 0xffffu /* several states, or several classes of letters */
#define RULEC_LEAF 0x8000u
#define RULEC_EXCLUDED 0xffffu
#define RULEC_EXACTLY(verdict) ((uint8_t)((uint8_t)(verdict) * 5u)) /* best, and worst times 4 */
#define RULEC_WITHIN(best, worst) ((uint8_t)((uint8_t)(best) | (uint8_t)((uint8_t)(worst) << 2)))

#define RULEC_LOST ((uint8_t)1u)    /* violated for good */
#define RULEC_DOUBTED ((uint8_t)2u) /* perhaps violated by who has left */

/* Where an instance stands during a step. */
typedef struct {
    uint32_t number;
    uint16_t turns[RULEC_VARIABLES]; /* among the seats that are taken, or were */
    uint16_t seats[RULEC_VARIABLES];
    const uint16_t *digits[RULEC_SOURCES];
} rulec_instance;

/* Seats: objects keep theirs as long as they are there, others get those that are free. */
static rulec_status rulec_seat(rulec_state *state, const rulec_input *in, uint32_t *left_out)
{
    size_t one;
    uint16_t seat;
    *left_out = 0u;
    state->crowded = 0u;
    for (seat = 0u; seat < RULEC_TYPES; seat++) {
        state->absent[seat] = 0u;
    }
    for (seat = 0u; seat < RULEC_SEATS; seat++) {
        state->seated[seat] = RULEC_EMPTY;
    }
    for (one = 0u; one < in->n_objects; one++) {
        const rulec_object *object = &in->objects[one];
        if (object->type >= RULEC_TYPES) {
            return RULEC_BAD_TYPE;
        }
        for (seat = rulec_first[object->type]; seat < rulec_end[object->type]; seat++) {
            if ((state->id[seat] == object->id) && (state->type[seat] == object->type)) {
                if (state->seated[seat] != RULEC_EMPTY) {
                    return RULEC_TWICE;
                }
                state->seated[seat] = (uint16_t)one;
                break;
            }
        }
    }
    for (seat = 0u; seat < RULEC_SEATS; seat++) {
        const bool stays = state->seated[seat] != RULEC_EMPTY;
        state->stays[seat] = stays ? 1u : 0u;
        state->next_id[seat] = state->id[seat];
        state->next_type[seat] = stays ? state->type[seat] : RULEC_NOBODY;
    }
    for (one = 0u; one < in->n_objects; one++) {
        const rulec_object *object = &in->objects[one];
        uint16_t free = RULEC_EMPTY;
        bool has_seat = false;
        for (seat = rulec_first[object->type]; seat < rulec_end[object->type]; seat++) {
            if (state->seated[seat] == (uint16_t)one) {
                has_seat = true;
                break;
            }
            if (state->seated[seat] == RULEC_EMPTY) {
                free = (free == RULEC_EMPTY) ? seat : free;
            } else if ((in->objects[state->seated[seat]].id == object->id)
                    && (in->objects[state->seated[seat]].type == object->type)) {
                return RULEC_TWICE;
            } else {
                /* somebody else's seat */
            }
        }
        if (!has_seat && (free != RULEC_EMPTY)) {
            state->seated[free] = (uint16_t)one;
            state->next_id[free] = object->id;
            state->next_type[free] = object->type;
        } else if (!has_seat) {
            *left_out += 1u;
            state->crowded = 1u;
            state->absent[object->type] = 1u;
        } else {
            /* sits already */
        }
    }
    return RULEC_OK;
}

/* The class of the letter that an instance reads, if what is not known cannot decide. */
static inline uint16_t rulec_class(const rulec_rule *rule, const uint16_t *const *digits)
{
    const uint16_t *const cells = &rulec_cells[rule->first_cell];
    uint16_t at = cells[0];
    while (at < RULEC_LEAF) {
        const uint16_t read = cells[at];
        const uint16_t digit = digits[read >> 12][read & 0xfffu];
        const uint16_t low = digit & 0xffu;
        if (low != (uint16_t)(digit >> 8)) {
            return RULEC_SEVERAL;
        }
        at = cells[at + 1u + low];
    }
    return (uint16_t)(at & 0x7fffu);
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

/* Where a cell leads: a node to be looked at later, for cells lead onward, or a class. */
static void rulec_lead(rulec_state *state, uint16_t cell)
{
    if (cell < RULEC_LEAF) {
        rulec_set(state->reached, cell);
    } else if (cell != RULEC_EXCLUDED) {
        rulec_set(state->classes, (uint32_t)cell & 0x7fffu);
    } else {
        /* no state of the world is such */
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
            const uint16_t digit = digits[read >> 12][read & 0xfffu];
            uint16_t each;
            for (each = digit & 0xffu; each <= (uint16_t)(digit >> 8); each++) {
                rulec_lead(state, cells[at + 1u + each]);
            }
        }
        at = (uint16_t)(at + 1u + rulec_sizes[rulec_sizes_of[read >> 12] + (read & 0xfffu)]);
    }
    for (word = 0u; word <= ((uint32_t)rule->n_classes >> 5); word++) {
        any = any || (state->classes[word] != 0u);
    }
    return any;
}

/* A step where not all is known: from each possible state by each possible class. */
static void rulec_advance_all(rulec_state *state, const rulec_rule *rule, uint32_t instance)
{
    uint32_t *const states = &state->states[rule->first_word
        + ((instance - rule->first_instance) * (((uint32_t)rule->n_states >> 5) + 1u))];
    uint8_t best = RULEC_VIOLATED;
    uint8_t worst = RULEC_SATISFIED;
    uint16_t last = 0u;
    uint32_t found = 0u;
    uint16_t from;
    uint16_t by;
    uint32_t word;
    if (state->at[instance] != RULEC_SEVERAL) {
        rulec_clear(states, rule->n_states);
        rulec_set(states, state->at[instance]);
    }
    rulec_clear(state->following, rule->n_states);
    for (from = 0u; from < rule->n_states; from++) {
        if (rulec_is_set(states, from)) {
            for (by = 0u; by < rule->n_classes; by++) {
                if (rulec_is_set(state->classes, by)) {
                    const uint16_t entry = rulec_entries[rule->first_entry
                        + ((uint32_t)from * rule->n_classes) + by];
                    const uint8_t verdict = (uint8_t)(entry & 3u);
                    last = (uint16_t)(entry >> 2);
                    found += rulec_is_set(state->following, last) ? 0u : 1u;
                    rulec_set(state->following, last);
                    best = (verdict < best) ? verdict : best;
                    worst = (verdict > worst) ? verdict : worst;
                }
            }
        }
    }
    for (word = 0u; word <= ((uint32_t)rule->n_states >> 5); word++) {
        states[word] = state->following[word];
    }
    state->at[instance] = (found == 1u) ? last : (uint16_t)RULEC_SEVERAL;
    state->verdict[instance] = RULEC_WITHIN(best, worst);
}

static inline void rulec_advance(rulec_state *state, const rulec_rule *rule, const rulec_instance *one)
{
    const uint16_t by = rulec_class(rule, one->digits);
    const uint16_t from = state->at[one->number];
    if ((by != RULEC_SEVERAL) && (from != RULEC_SEVERAL)) {
        const uint16_t entry = rulec_entries[rule->first_entry + ((uint32_t)from * rule->n_classes) + by];
        state->at[one->number] = (uint16_t)(entry >> 2);
        state->verdict[one->number] = RULEC_EXACTLY(entry & 3u);
    } else {
        if (by == RULEC_SEVERAL) {
            (void)rulec_classes(state, rule, one->digits);
        } else {
            rulec_clear(state->classes, rule->n_classes);
            rulec_set(state->classes, by);
        }
        rulec_advance_all(state, rule, one->number);
    }
}

/* The rule is violated for good by the objects of an instance. */
static void rulec_lose(rulec_state *state, uint16_t number, const rulec_instance *one,
    const uint32_t *ids)
{
    uint16_t variable;
    state->violations += 1u;
    state->flags[number] |= RULEC_LOST;
    for (variable = 0u; variable < RULEC_VARIABLES; variable++) {
        state->about[number][variable] = ids[one->seats[variable]];
    }
}

/* Objects part: what is pending is violated, what is open stays open. */
static void rulec_part(rulec_state *state, uint16_t number, const rulec_instance *one)
{
    const uint8_t verdict = state->verdict[one->number];
    const uint8_t best = verdict & 3u;
    const uint8_t worst = (uint8_t)(verdict >> 2);
    if ((best != RULEC_VIOLATED) && (best >= RULEC_PENDING)) {
        rulec_lose(state, number, one, state->id);
    } else if ((best != RULEC_VIOLATED) && (worst >= RULEC_PENDING)) {
        state->flags[number] |= RULEC_DOUBTED;
    } else {
        /* kept, or violated before */
    }
}

/* What the digits of an instance are, and whether its objects were and are there. */
static void rulec_look(rulec_state *state, const rulec_input *in, const rulec_rule *rule,
    rulec_instance *one)
{
    uint16_t each;
    uint16_t variable;
    for (variable = 0u; variable < rule->n_variables; variable++) {
        one->digits[variable + 1u] = state->own[one->seats[variable]];
    }
    for (each = 0u; each < rule->n_together; each++) {
        size_t who[RULEC_VARIABLES];
        const uint16_t read = rulec_together[rule->first_together + each];
        for (variable = 0u; variable < rule->n_variables; variable++) {
            who[variable] = state->seated[one->seats[variable]];
        }
        state->shared[read] = rulec_read_together(in, who, read);
    }
}

/* Go on to the next choice of seats; false after the last one. */
static bool rulec_turn(const rulec_state *state, const rulec_rule *rule, rulec_instance *one)
{
    uint16_t variable = rule->n_variables;
    bool carry = true;
    while (carry && (variable > 0u)) {
        variable--;
        one->turns[variable]++;
        carry = one->turns[variable] >= state->n_taken;
        if (carry) {
            one->turns[variable] = 0u;
        }
    }
    return !carry;
}

typedef struct {
    bool was;   /* all objects were there in the state before */
    bool stays; /* and all still are */
    bool is;    /* all are there now */
} rulec_presence;

/* The best verdict of the worst so far, and the worst, with its best: as verdicts are kept. */
typedef struct {
    uint8_t best;
    uint8_t worst;
} rulec_tally;

/* Find the instance of a choice of seats; each object stands for one variable alone. */
static rulec_presence rulec_there(const rulec_state *state, const rulec_rule *rule,
    rulec_instance *one)
{
    static const rulec_presence never = {false, false, false};
    rulec_presence found = {true, true, true};
    uint32_t number = 0u;
    uint16_t variable;
    uint16_t other;
    for (variable = 0u; variable < rule->n_variables; variable++) {
        const uint16_t seat = state->taken[one->turns[variable]];
        const uint8_t *const fits = rulec_fits[rule->types[variable]];
        if ((seat < rule->seats_first[variable]) || (seat >= rule->seats_end[variable])) {
            return never;
        }
        for (other = 0u; other < variable; other++) {
            if (one->seats[other] == seat) {
                return never;
            }
        }
        one->seats[variable] = seat;
        number *= (uint32_t)rule->seats_end[variable] - rule->seats_first[variable];
        number += (uint32_t)seat - rule->seats_first[variable];
        found.was = found.was && (fits[state->type[seat]] != 0u);
        found.is = found.is && (fits[state->next_type[seat]] != 0u);
        found.stays = found.stays && (state->stays[seat] != 0u);
    }
    one->number = rule->first_instance + number;
    return found;
}

static void rulec_begin(const rulec_state *state, const rulec_rule *rule, rulec_instance *one)
{
    uint16_t each;
    one->number = rule->first_instance;
    one->digits[0] = state->world;
    one->digits[RULEC_SOURCES - 1u] = state->shared;
    for (each = 0u; each < RULEC_VARIABLES; each++) {
        one->turns[each] = 0u;
        one->seats[each] = 0u;
    }
}

/* Whether facts exclude what a rule reads of some objects. */
static bool rulec_is_excluded(rulec_state *state, const rulec_input *in, const rulec_rule *rule)
{
    rulec_instance one;
    bool excluded = false;
    bool more = (rule->n_variables == 0u) || (state->n_taken > 0u);
    rulec_begin(state, rule, &one);
    while (more) {
        if (rulec_there(state, rule, &one).is) {
            rulec_look(state, in, rule, &one);
            excluded = excluded || !rulec_classes(state, rule, one.digits);
        }
        more = rulec_turn(state, rule, &one);
    }
    return excluded;
}

/* A step of one instance: it ends, begins, or goes on. */
static inline void rulec_visit(rulec_state *state, uint16_t number, const rulec_instance *one,
    rulec_presence there, rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    if (there.was && !there.stays) {
        rulec_part(state, number, one);
    }
    if (there.is) {
        uint8_t before;
        uint8_t now;
        if (!there.was || !there.stays) {
            state->at[one->number] = 0u;
            state->verdict[one->number] = RULEC_EXACTLY(rule->start);
        }
        before = state->verdict[one->number];
        rulec_advance(state, rule, one);
        now = state->verdict[one->number];
        if ((now == RULEC_EXACTLY(RULEC_VIOLATED)) && (before != now)) {
            rulec_lose(state, number, one, state->next_id);
        }
        tally->best = ((now & 3u) > tally->best) ? (uint8_t)(now & 3u) : tally->best;
        /* Worse at worst, or as bad at worst and worse at best, in one number */
        if (now > tally->worst) {
            tally->worst = now;
            if ((state->flags[number] & RULEC_LOST) == 0u) {
                uint16_t variable;
                for (variable = 0u; variable < rule->n_variables; variable++) {
                    state->about[number][variable] = state->next_id[one->seats[variable]];
                }
            }
        }
    }
}

static void rulec_visit_all(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_tally *tally)
{
    const rulec_rule *const rule = &rulec_rules[number];
    rulec_instance one;
    bool more = state->n_taken > 0u;
    rulec_begin(state, rule, &one);
    if (rule->n_variables == 0u) {
        const rulec_presence always = {true, true, true};
        rulec_visit(state, number, &one, always, tally);
    } else {
        while (more) {
            const rulec_presence there = rulec_there(state, rule, &one);
            if (there.is) {
                rulec_look(state, in, rule, &one);
            }
            if (there.is || there.was) {
                rulec_visit(state, number, &one, there, tally);
            }
            more = rulec_turn(state, rule, &one);
        }
    }
}

static void rulec_judge(rulec_state *state, const rulec_input *in, uint16_t number,
    rulec_range *said)
{
    const rulec_rule *const rule = &rulec_rules[number];
    rulec_tally tally = {0u, 0u};
    uint16_t kind;
    rulec_visit_all(state, in, number, &tally);
    said->best = tally.best;
    said->worst = (uint8_t)(tally.worst >> 2);
    if ((rule->n_variables > 0u) && (rule->start != RULEC_SATISFIED)) {
        said->best = (said->best == RULEC_SATISFIED) ? (uint8_t)RULEC_HOLDS_SO_FAR : said->best;
        said->worst = (said->worst == RULEC_SATISFIED) ? (uint8_t)RULEC_HOLDS_SO_FAR : said->worst;
        for (kind = 0u; (state->crowded != 0u) && (kind < RULEC_TYPES); kind++) {
            uint16_t variable;
            for (variable = 0u; variable < rule->n_variables; variable++) {
                if ((state->absent[kind] != 0u)
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

void rulec_init(rulec_state *state)
{
    uint32_t each;
    uint16_t variable;
    for (each = 0u; each < RULEC_SEATS; each++) {
        state->id[each] = 0u;
        state->type[each] = RULEC_NOBODY;
    }
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
            state->verdict[rule->first_instance] = RULEC_EXACTLY(rule->start);
        }
    }
    state->violations = 0u;
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
    for (each = 0u; each < RULEC_SEATS; each++) {
        if ((state->type[each] != RULEC_NOBODY) || (state->next_type[each] != RULEC_NOBODY)) {
            state->taken[state->n_taken] = each;
            state->n_taken++;
        }
    }
    rulec_read_world(input, state->world);
    for (each = 0u; each < RULEC_SEATS; each++) {
        if (state->seated[each] != RULEC_EMPTY) {
            rulec_read_own(input, state->seated[each], state->own[each]);
        }
    }
    for (each = 0u; each < RULEC_RULES; each++) {
        if ((rulec_rules[each].facts != 0u) && rulec_is_excluded(state, input, &rulec_rules[each])) {
            return RULEC_EXCLUDED_BY_FACTS;
        }
    }
    /* A state that is refused has changed nothing so far. */
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
    verdict->violations = state->violations;
    return RULEC_OK;
}

uint32_t rulec_about(const rulec_state *state, uint32_t rule, uint32_t variable)
{
    const bool is = (rule < RULEC_RULES) && (variable < RULEC_VARIABLES);
    return is ? state->about[rule][variable] : 0u;
}
