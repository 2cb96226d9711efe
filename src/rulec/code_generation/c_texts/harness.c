/* The functions that a proof calls; appended to a monitor's source. */

/* The part of a state that lasts from one step to the next. */
size_t rulec_kept_size(void);
size_t rulec_kept_size(void)
{
    return offsetof(rulec_state, next_id);
}

/* The numbers in a rule's tables. */
void rulec_numbers(uint32_t number, uint16_t *cells, uint16_t *entries);
void rulec_numbers(uint32_t number, uint16_t *cells, uint16_t *entries)
{
    const rulec_rule *const rule = &rulec_rules[number];
    uint32_t each;
    for (each = 0u; each < rule->n_cells; each++) {
        cells[each] = rulec_cells[rule->first_cell + each];
    }
    for (each = 0u; each < ((uint32_t)rule->n_states * rule->n_classes); each++) {
        entries[each] = rulec_entries[rule->first_entry + each];
    }
}

/* The classes of all letters of a rule, the first read counting ones. */
void rulec_all_classes(uint32_t number, const uint32_t *reads, const uint32_t *sizes, uint32_t n,
    uint16_t *classes);
void rulec_all_classes(uint32_t number, const uint32_t *reads, const uint32_t *sizes, uint32_t n,
    uint16_t *classes)
{
    static uint16_t digits[RULEC_SOURCES][0x1000];
    const uint16_t *const cells = &rulec_cells[rulec_rules[number].first_cell];
    const uint16_t *sources[RULEC_SOURCES];
    uint32_t each;
    uint32_t letter = 0u;
    bool more = true;
    for (each = 0u; each < RULEC_SOURCES; each++) {
        sources[each] = digits[each];
    }
    for (each = 0u; each < n; each++) {
        digits[reads[each] >> 12][reads[each] & 0xfffu] = RULEC_KNOWN(0u);
    }
    while (more) {
        classes[letter] = rulec_class(cells, cells[0], sources);
        letter++;
        more = false;
        for (each = 0u; (each < n) && !more; each++) {
            uint16_t *digit = &digits[reads[each] >> 12][reads[each] & 0xfffu];
            const uint16_t next = (uint16_t)((*digit & 0xffu) + 1u);
            more = next < sizes[each];
            *digit = more ? RULEC_KNOWN(next) : RULEC_KNOWN(0u);
        }
    }
}

/* The classes, as bits, of the letters that reads with several digits have. */
void rulec_some_classes(uint32_t number, const uint32_t *reads, const uint16_t *given, uint32_t n,
    uint32_t *classes);
void rulec_some_classes(uint32_t number, const uint32_t *reads, const uint16_t *given, uint32_t n,
    uint32_t *classes)
{
    static uint16_t digits[RULEC_SOURCES][0x1000];
    static rulec_state state;
    const uint16_t *sources[RULEC_SOURCES];
    uint32_t each;
    for (each = 0u; each < RULEC_SOURCES; each++) {
        sources[each] = digits[each];
    }
    for (each = 0u; each < n; each++) {
        digits[reads[each] >> 12][reads[each] & 0xfffu] = given[each];
    }
    (void)rulec_classes(&state, &rulec_rules[number], sources);
    for (each = 0u; each < RULEC_CLASS_WORDS; each++) {
        classes[each] = state.classes[each];
    }
}

/* The state reached and the verdict from each state by each class, taken as a set of one. */
void rulec_all_steps(uint32_t number, uint16_t *reached, uint8_t *verdicts, uint16_t *by_sets);
void rulec_all_steps(uint32_t number, uint16_t *reached, uint8_t *verdicts, uint16_t *by_sets)
{
    static rulec_state state;
    const rulec_rule *const rule = &rulec_rules[number];
    uint32_t from;
    uint32_t by;
    for (from = 0u; from < rule->n_states; from++) {
        for (by = 0u; by < rule->n_classes; by++) {
            const uint32_t place = (from * rule->n_classes) + by;
            const uint16_t entry = rulec_entries[rule->first_entry + place];
            reached[place] = (uint16_t)(entry >> 2);
            verdicts[place] = (uint8_t)(entry & 3u);
            state.at[rule->first_instance] = (uint16_t)(from << 2);
            rulec_clear(state.classes, rule->n_classes);
            rulec_set(state.classes, by);
            rulec_advance_all(&state, rule, rule->first_instance);
            by_sets[place] = state.at[rule->first_instance];
        }
    }
}

/* The digits read from an input: about no object, about one, about several. */
void rulec_digits(const rulec_input *in, const size_t *who, uint32_t source, uint16_t *digits);
void rulec_digits(const rulec_input *in, const size_t *who, uint32_t source, uint16_t *digits)
{
    uint16_t read;
    if (source == 0u) {
        rulec_read_world(in, digits);
    } else if (source == RULEC_TOGETHER) {
        for (read = 0u; read < RULEC_SHARED_READS; read++) {
            digits[read] = rulec_read_together(in, who, read);
        }
    } else {
        rulec_read_own(in, who[source - 1u], digits);
    }
}

/* Steps through all states of a drive and returns how many were accepted. After each, the verdict
 * of every instance (the best, and the worst times 4) and the object on each seat (0 for none). */
uint32_t rulec_run(rulec_state *state, const rulec_input *inputs, uint32_t n, uint8_t *verdicts,
    uint32_t *ids);
uint32_t rulec_run(rulec_state *state, const rulec_input *inputs, uint32_t n, uint8_t *verdicts,
    uint32_t *ids)
{
    uint32_t taken;
    rulec_init(state);
    for (taken = 0u; taken < n; taken++) {
        rulec_verdict verdict;
        uint32_t each;
        if ((rulec_step(state, &inputs[taken], &verdict) != RULEC_OK) || (verdict.left_out > 0u)) {
            return taken;
        }
        for (each = 0u; each < RULEC_INSTANCES; each++) {
            verdicts[(taken * RULEC_INSTANCES) + each] = rulec_said(state, each);
        }
        for (each = 0u; each < RULEC_SEATS; each++) {
            ids[(taken * RULEC_SEATS) + each] = (state->type[each] < RULEC_TYPES) ? state->id[each] : 0u;
        }
    }
    return taken;
}
