@head@
#ifndef RULEC_MONITOR_H
#define RULEC_MONITOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Verdicts, the best first (RV-LTL) */
#define RULEC_SATISFIED 0u    /* for good */
#define RULEC_HOLDS_SO_FAR 1u /* would be kept if this were the end */
#define RULEC_PENDING 2u      /* would be violated if this were the end */
#define RULEC_VIOLATED 3u     /* for good */

/* The status of a step; with any but the first, the state was refused. */
typedef uint8_t rulec_status;
#define RULEC_OK 0u
#define RULEC_NULL 1u              /* a pointer is NULL */
#define RULEC_BAD_TYPE 2u          /* an object's type is invalid */
#define RULEC_TWICE 3u             /* an object is given twice */
#define RULEC_TOO_MANY 4u          /* there are more than RULEC_MOST_OBJECTS objects */
#define RULEC_EXCLUDED_BY_FACTS 5u /* facts of the vocabulary exclude such a state */

/* An unknown signal (otherwise 0 or 1) or enumeration; invalid values count as unknown.
 * Unknown numbers are NaN, infinity and anything beyond 2^53. */
#define RULEC_UNKNOWN 255u
#define RULEC_UNKNOWN_NUMBER (0x1p+1000)
#define RULEC_RULES @rules@u
#define RULEC_TYPES @types@u
#define RULEC_SEATS @seats@u /* objects that can be watched at a time */
#define RULEC_MOST_OBJECTS 60000u
#define RULEC_N_SOURCES @sources@u
@step@

@rule_numbers@

/* Types of objects; give each object its most specific type. */
@type_numbers@
@value_numbers@

typedef struct {
    uint32_t id; /* constant for the same object */
    uint8_t type;
    @own_fields@
} rulec_object;

typedef struct {
    size_t n_objects;
    const rulec_object *objects; /* the objects that are present */
    @world_fields@
} rulec_input;

@sizes@
#define RULEC_OWN @own@u /* where digits of objects on seats begin */
#define RULEC_SHARED @shared@u /* and those about several objects */
#define RULEC_SOURCES 16u
#define RULEC_TOGETHER @together@u

/* A verdict; where values are unknown, the best and the worst that it can be. */
typedef struct {
    uint8_t best;
    uint8_t worst;
} rulec_range;

typedef struct {
    rulec_range book;               /* of all hard rules together */
    rulec_range rules[RULEC_RULES]; /* of each, soft ones included */
    uint32_t violations;            /* choices of objects that violated a rule for good */
    uint32_t left_out;              /* objects for which there was no seat */
} rulec_verdict;

/* A monitor of fixed size. Its fields are private: do not change them. */
typedef struct {
    uint32_t id[RULEC_SEATS];
    uint8_t type[RULEC_SEATS];
    uint16_t at[RULEC_INSTANCES];
    uint8_t verdict[RULEC_INSTANCES];
    uint32_t states[RULEC_WORDS + RULEC_STATE_WORDS];
    uint32_t about[RULEC_RULES][RULEC_VARIABLES];
    uint8_t flags[RULEC_RULES];
    uint32_t violations;
    uint8_t left_out[RULEC_TYPES]; /* types of objects for which there was no seat */
    /* Working memory of the current step */
    uint32_t next_id[RULEC_SEATS];
    uint8_t next_type[RULEC_SEATS];
    uint16_t seated[RULEC_SEATS];
    uint8_t stays[RULEC_SEATS];
    uint8_t earlier[RULEC_SEATS];
    uint8_t next_left_out[RULEC_TYPES];
    uint8_t crowded;
    uint8_t fitting_type;
    uint16_t n_taken;
    uint16_t n_changed;
    uint16_t n_fitting;
    uint16_t taken[RULEC_SEATS];
    uint16_t changed[RULEC_SEATS];
    uint16_t fitting[RULEC_SEATS];
    uint16_t digits[RULEC_DIGITS]; /* of no object, of the object on each seat, of several */
    uint32_t reached[RULEC_CELL_WORDS];
    uint32_t classes[RULEC_CLASS_WORDS];
    uint32_t following[RULEC_STATE_WORDS];
} rulec_state;

extern const char *const rulec_rule_names[RULEC_RULES];
extern const char *const rulec_rule_articles[RULEC_RULES];
extern const uint8_t rulec_rule_variables[RULEC_RULES]; /* the number of its variables */
extern const char *const rulec_sources[RULEC_N_SOURCES]; /* each with its SHA-256 */

/* Initialise an input or an object: every value its default, or every value unknown. */
void rulec_input_defaults(rulec_input *input);
void rulec_input_unknown(rulec_input *input);
void rulec_object_defaults(rulec_object *object, uint32_t id, uint8_t type);
void rulec_object_unknown(rulec_object *object, uint32_t id, uint8_t type);

/* The bytes of a monitor, for other languages. */
size_t rulec_state_size(void);

/* Call it before the first state of each drive. */
void rulec_init(rulec_state *state);

/* Takes the next state. An object that is missing has left; if it returns, or changes its type, it
 * is a new object. Objects for which there is no seat are counted in left_out; from then on the
 * worst verdict of every rule that could apply to them is violated. If one of them gets a seat
 * later, its past is unknown. The verdict is written only if the status is RULEC_OK. */
rulec_status rulec_step(rulec_state *state, const rulec_input *input, rulec_verdict *verdict);

/* The id of the object of a rule's variable (from 0) in the choice of objects with the worst
 * verdict, also if they have left. 0 if the rule has no such variable (a rule about ego alone has
 * none) or if there is no such choice. */
uint32_t rulec_about(const rulec_state *state, uint32_t rule, uint32_t variable);

#ifdef __cplusplus
}
#endif

#endif
