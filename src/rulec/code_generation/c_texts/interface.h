/* A verdict, or the best and the worst that it comes to, whatever is not known may be. */
typedef struct {
    uint8_t best;
    uint8_t worst;
} rulec_range;

typedef struct {
    rulec_range book;               /* of all hard rules together */
    rulec_range rules[RULEC_RULES]; /* of each, soft ones included */
    uint32_t violations;            /* choices of objects that have violated a rule for good */
    uint32_t left_out;              /* objects for which there was no seat */
} rulec_verdict;

/* A monitor. Its size is known; nothing in it is yours to change. */
typedef struct {
    uint32_t id[RULEC_SEATS];
    uint8_t type[RULEC_SEATS];
    uint16_t at[RULEC_INSTANCES];
    uint8_t verdict[RULEC_INSTANCES];
    uint32_t states[RULEC_WORDS + RULEC_STATE_WORDS];
    uint32_t about[RULEC_RULES][RULEC_VARIABLES];
    uint8_t flags[RULEC_RULES];
    uint32_t violations;
    /* Of the step under way */
    uint32_t next_id[RULEC_SEATS];
    uint8_t next_type[RULEC_SEATS];
    uint16_t seated[RULEC_SEATS];
    uint8_t stays[RULEC_SEATS];
    uint8_t absent[RULEC_TYPES];
    uint8_t crowded;
    uint8_t fitting_type;
    uint16_t n_taken;
    uint16_t n_changed;
    uint16_t n_fitting;
    uint16_t taken[RULEC_SEATS];
    uint16_t changed[RULEC_SEATS];
    uint16_t fitting[RULEC_SEATS];
    uint16_t digits[RULEC_DIGITS]; /* of nobody, of those on each seat, of several */
    uint32_t reached[RULEC_CELL_WORDS];
    uint32_t classes[RULEC_CLASS_WORDS];
    uint32_t following[RULEC_STATE_WORDS];
} rulec_state;

extern const char *const rulec_rule_names[RULEC_RULES];
extern const char *const rulec_rule_articles[RULEC_RULES];
extern const uint8_t rulec_rule_variables[RULEC_RULES]; /* how many objects each is about */
extern const char *const rulec_sources[RULEC_N_SOURCES]; /* each with its SHA-256 */

/* An input of which nothing is said but the defaults, or nothing at all; and an object. */
void rulec_input_defaults(rulec_input *input);
void rulec_input_unknown(rulec_input *input);
void rulec_object_defaults(rulec_object *object, uint32_t id, uint8_t type);
void rulec_object_unknown(rulec_object *object, uint32_t id, uint8_t type);

/* Before the first state, and again whenever a drive begins. */
void rulec_init(rulec_state *state);

/* Takes the next state. An object that is no longer there has left; if it comes back, or under
 * another type, it begins anew. Those for which there is no seat are counted in left_out, and every
 * rule that could speak of them is violated at worst from then on. The verdict is written if the
 * step has been taken. */
rulec_status rulec_step(rulec_state *state, const rulec_input *input, rulec_verdict *verdict);

/* The id of the object that a variable of a rule, from 0, stands for where its verdict is the worst.
 * 0 if the rule has no such variable, as one about ego alone has none, or if nobody is there. */
uint32_t rulec_about(const rulec_state *state, uint32_t rule, uint32_t variable);

#ifdef __cplusplus
}
#endif

#endif
