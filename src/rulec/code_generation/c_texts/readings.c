/* Reading: an input's values as digits. A digit is a number below 255: on which side of its limits
 * a value is, or which value it is. An unknown value has several digits: the lower byte is the
 * least of them, the upper byte the number of further ones. */

#define RULEC_KNOWN(digit) ((uint16_t)(digit))
#define RULEC_FROM_TO(low, high) \
    ((uint16_t)((uint16_t)(low) | (uint16_t)((uint16_t)((uint16_t)(high) - (uint16_t)(low)) << 8)))
#define RULEC_LEAST(digits) ((uint16_t)((digits) & 0xffu))
#define RULEC_GREATEST(digits) ((uint16_t)(((digits) & 0xffu) + ((uint16_t)(digits) >> 8)))
#define RULEC_MOST 9007199254740992.0 /* 2^53: numbers beyond it, infinity and NaN are unknown */

/* Truth values of S. C. Kleene, "Introduction to metamathematics", 1952 */
#define RULEC_NO ((uint8_t)0u)
#define RULEC_PERHAPS ((uint8_t)1u)
#define RULEC_YES ((uint8_t)2u)

typedef struct {
    const double *factors;
    const double *limits;
    const uint8_t *inclusive;
    const int64_t *whole_factors; /* NULL if they are too large */
    const int64_t *whole_limits;
    uint8_t n_terms;
    uint8_t n_limits;
} rulec_shape;

static inline bool rulec_is_number(double value)
{
    /* False for NaN, too */
    return (value >= -RULEC_MOST) && (value <= RULEC_MOST);
}

static inline uint16_t rulec_truth(uint8_t value)
{
    return (value <= 1u) ? RULEC_KNOWN(value) : RULEC_FROM_TO(0u, 1u);
}

static inline uint16_t rulec_value(uint8_t value, const uint8_t *digits, uint8_t n, uint8_t size)
{
    const uint8_t last = (uint8_t)(size - 1u);
    uint16_t found = RULEC_FROM_TO(0u, last);
    if (value < n) {
        found = RULEC_KNOWN(digits[value]);
    }
    return found;
}

static inline uint16_t rulec_number(double value, const double *floors, uint8_t n)
{
    uint16_t passed = 0u;
    uint8_t each;
    if (!rulec_is_number(value)) {
        return RULEC_FROM_TO(0u, n);
    }
    for (each = 0u; each < n; each++) {
        passed = (uint16_t)(passed + ((value >= floors[each]) ? 1u : 0u));
    }
    return RULEC_KNOWN(passed);
}

static inline uint8_t rulec_is(uint8_t value)
{
    uint8_t truth = RULEC_PERHAPS;
    if (value <= 1u) {
        truth = (value == 1u) ? RULEC_YES : RULEC_NO;
    }
    return truth;
}

static inline uint8_t rulec_has(uint8_t value, uint8_t asked, uint8_t n)
{
    uint8_t truth = RULEC_PERHAPS;
    if (value < n) {
        truth = (value == asked) ? RULEC_YES : RULEC_NO;
    }
    return truth;
}

static inline uint8_t rulec_not(uint8_t truth)
{
    return (uint8_t)(RULEC_YES - truth);
}

static inline uint8_t rulec_and(uint8_t left, uint8_t right)
{
    return (left < right) ? left : right;
}

static inline uint8_t rulec_or(uint8_t left, uint8_t right)
{
    return (left > right) ? left : right;
}

static inline uint8_t rulec_same(uint8_t left, uint8_t right)
{
    uint8_t truth = RULEC_PERHAPS;
    if ((left != RULEC_PERHAPS) && (right != RULEC_PERHAPS)) {
        truth = (left == right) ? RULEC_YES : RULEC_NO;
    }
    return truth;
}

/* Whether the digits are among some, given as bits. */
static inline uint8_t rulec_among(uint16_t digits, uint32_t some)
{
    const uint32_t high = RULEC_GREATEST(digits);
    bool all = true;
    bool any = false;
    uint32_t each;
    for (each = RULEC_LEAST(digits); each <= high; each++) {
        const bool is = (each < 32u) && (((some >> (each & 31u)) & 1u) != 0u);
        all = all && is;
        any = any || is;
    }
    if (all) {
        return RULEC_YES;
    }
    return any ? RULEC_PERHAPS : RULEC_NO;
}

/* An object's part of a count: lower half for sure, upper half perhaps. */
static inline uint32_t rulec_counts(const rulec_input *in, size_t one, uint8_t kind, uint8_t truth)
{
    uint32_t counts = 0u;
    const uint8_t type = in->objects[one].type;
    if ((type < RULEC_TYPES) && (rulec_fits[kind][type] != 0u)) {
        counts = ((truth == RULEC_YES) ? 1u : 0u) | ((truth != RULEC_NO) ? 0x10000u : 0u);
    }
    return counts;
}

static inline uint16_t rulec_counted(uint32_t counts, const uint32_t *limits, uint8_t n)
{
    uint16_t low = 0u;
    uint16_t high = 0u;
    uint8_t each;
    for (each = 0u; each < n; each++) {
        low = (uint16_t)(low + (((counts & 0xffffu) >= limits[each]) ? 1u : 0u));
        high = (uint16_t)(high + (((counts >> 16) >= limits[each]) ? 1u : 0u));
    }
    return RULEC_FROM_TO(low, high);
}

/* Which of two numbers is the greater; sides: 1 for at least, 2 for more. */
static inline uint16_t rulec_order(double first, double second, uint8_t sides)
{
    const bool known = rulec_is_number(first) && rulec_is_number(second);
    const uint16_t wide = (uint16_t)sides;
    const uint16_t least = (uint16_t)(wide & 1u);
    const uint16_t more = (uint16_t)(wide >> 1);
    uint16_t digits = RULEC_FROM_TO(0u, least + more);
    if (known) {
        digits = RULEC_KNOWN(((first >= second) ? least : 0u) + ((first > second) ? more : 0u));
    }
    return digits;
}

/* Eight times a number, if that is a whole number and the number is below 1e9. */
static inline bool rulec_eighths(double value, int64_t *eighths)
{
    bool is_whole = false;
    /* All comparisons are false for NaN; static analysers recognise it in the first one. */
    if ((value == value) && (value > -1e9) && (value < 1e9)) {
        const double exact = value * 8.0; /* only the exponent changes */
        *eighths = (int64_t)exact;
        is_whole = ((double)*eighths >= exact) && ((double)*eighths <= exact);
    }
    return is_whole;
}

/* A sum of factors times numbers, each between two bounds. Whole numbers of eighths are computed
 * exactly. Otherwise every factor, limit, product and sum, and every number as a decimal, has an
 * error of at most 2^-53 of its size: in all, less than (n + 8) 2^-53 times the sum of all sizes.
 * If that could matter, the digits on both sides are possible. */
static uint16_t rulec_weigh(const double *low, const double *high, const rulec_shape *shape)
{
    double least = 0.0;
    double most = 0.0;
    double size = 0.0;
    int64_t whole_least = 0;
    int64_t whole_most = 0;
    const uint8_t n_terms = shape->n_terms;
    bool is_whole = shape->whole_factors != NULL;
    uint16_t passed_least = 0u;
    uint16_t passed_most = 0u;
    uint8_t each;
    for (each = 0u; each < n_terms; each++) {
        const bool up = shape->factors[each] > 0.0;
        const double first = shape->factors[each] * (up ? low[each] : high[each]);
        const double last = shape->factors[each] * (up ? high[each] : low[each]);
        int64_t below = 0;
        int64_t above = 0;
        if (!rulec_is_number(low[each]) || !rulec_is_number(high[each])) {
            return RULEC_FROM_TO(0u, shape->n_limits);
        }
        least += first;
        most += last;
        size += ((first < 0.0) ? -first : first) + ((last < 0.0) ? -last : last);
        is_whole = is_whole && rulec_eighths(low[each], &below);
        if (high == low) {
            above = below;
        } else {
            is_whole = is_whole && rulec_eighths(high[each], &above);
        }
        if (is_whole) {
            whole_least += shape->whole_factors[each] * (up ? below : above);
            whole_most += shape->whole_factors[each] * (up ? above : below);
        }
    }
    for (each = 0u; each < shape->n_limits; each++) {
        const double limit = shape->limits[each];
        const double all = size + ((limit < 0.0) ? -limit : limit);
        const double error = (((double)n_terms + 8.0) * 0x1p-53 * all) + 0x1p-900;
        bool surely;
        bool perhaps;
        if (is_whole) {
            const int64_t bound = shape->whole_limits[each] + ((shape->inclusive[each] != 0u) ? 0 : 1);
            surely = whole_least >= bound;
            perhaps = whole_most >= bound;
        } else {
            surely = (least - limit) > error;
            perhaps = (most - limit) >= -error;
        }
        passed_least = (uint16_t)(passed_least + (surely ? 1u : 0u));
        passed_most = (uint16_t)(passed_most + (perhaps ? 1u : 0u));
    }
    return RULEC_FROM_TO(passed_least, passed_most);
}
