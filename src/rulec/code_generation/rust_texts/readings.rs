// Reading: an input's values as digits. A digit is a number below 255: on which side of its limits
// a value is, or which value it is. An unknown value has several digits: the lower byte is the
// least of them, the upper byte the number of further ones.

/// 2^53: numbers beyond it, infinity and NaN are unknown.
const MOST: f64 = 9_007_199_254_740_992.0;

/// Truth values of S. C. Kleene, "Introduction to metamathematics", 1952.
const NO: u8 = 0;
const PERHAPS: u8 = 1;
const YES: u8 = 2;

struct Shape {
    factors: &'static [f64],
    limits: &'static [f64],
    inclusive: &'static [u8],
    /// Empty if they are too large.
    whole_factors: &'static [i64],
    whole_limits: &'static [i64],
}

fn from_to(low: u16, high: u16) -> u16 {
    low | ((high - low) << 8)
}

fn is_number(value: f64) -> bool {
    // False for NaN, too
    (-MOST..=MOST).contains(&value)
}

fn truth(value: u8) -> u16 {
    if value <= 1 {
        u16::from(value)
    } else {
        from_to(0, 1)
    }
}

fn value(value: u8, digits: &[u8], _n: u8, size: u16) -> u16 {
    match digits.get(usize::from(value)) {
        Some(&digit) => u16::from(digit),
        None => from_to(0, size - 1),
    }
}

fn number(value: f64, floors: &[f64], n: u16) -> u16 {
    if !is_number(value) {
        return from_to(0, n);
    }
    floors.iter().map(|&floor| u16::from(value >= floor)).sum()
}

fn is(value: u8) -> u8 {
    match value {
        0 => NO,
        1 => YES,
        _ => PERHAPS,
    }
}

fn has(value: u8, asked: u8, n: u8) -> u8 {
    if value >= n {
        PERHAPS
    } else if value == asked {
        YES
    } else {
        NO
    }
}

fn not(truth: u8) -> u8 {
    YES - truth
}

fn and(left: u8, right: u8) -> u8 {
    left.min(right)
}

fn or(left: u8, right: u8) -> u8 {
    left.max(right)
}

fn same(left: u8, right: u8) -> u8 {
    if left == PERHAPS || right == PERHAPS {
        PERHAPS
    } else if left == right {
        YES
    } else {
        NO
    }
}

/// Whether the digits are among some, given as bits.
fn among(digits: u16, some: u32) -> u8 {
    let (low, more) = (digits & 0xff, digits >> 8);
    let is = |each: u16| (some >> each) & 1 != 0;
    if (low..=low + more).all(is) {
        YES
    } else if (low..=low + more).any(is) {
        PERHAPS
    } else {
        NO
    }
}

/// An object's part of a count: lower half for sure, upper half perhaps.
fn counts(input: &Input, one: usize, kind: usize, truth: u8) -> u32 {
    if fits(kind, input.objects[one].r#type) {
        u32::from(truth == YES) | (u32::from(truth != NO) << 16)
    } else {
        0
    }
}

fn counted(counts: u32, limits: &[u32], _n: u8) -> u16 {
    let passed = |count: u32| limits.iter().map(|&limit| u16::from(count >= limit)).sum();
    from_to(passed(counts & 0xffff), passed(counts >> 16))
}

/// Which of two numbers is the greater; sides: 1 for at least, 2 for more.
fn order(first: f64, second: f64, sides: u16) -> u16 {
    let (least, more) = (sides & 1, sides >> 1);
    if is_number(first) && is_number(second) {
        u16::from(first >= second) * least + u16::from(first > second) * more
    } else {
        from_to(0, least + more)
    }
}

/// Eight times a number, if that is a whole number and the number is below 1e9.
fn eighths(value: f64) -> Option<i64> {
    if !(value > -1e9 && value < 1e9) {
        return None;
    }
    let exact = value * 8.0; // only the exponent changes
    let whole = exact as i64;
    (whole as f64 == exact).then_some(whole)
}

fn size_of(number: f64) -> f64 {
    if number < 0.0 {
        -number
    } else {
        number
    }
}

/// A sum of factors times numbers, each between two bounds. Whole numbers of eighths are computed
/// exactly. Otherwise every factor, limit, product and sum, and every number as a decimal, has an
/// error of at most 2^-53 of its size: in all, less than (n + 8) 2^-53 times the sum of all sizes.
/// If that could matter, the digits on both sides are possible.
fn weigh(values: &[(f64, f64)], shape: &Shape) -> u16 {
    let (mut least, mut most, mut size) = (0.0, 0.0, 0.0);
    let mut whole = (!shape.whole_factors.is_empty()).then_some((0_i64, 0_i64));
    for (number, (&(low, high), &factor)) in values.iter().zip(shape.factors).enumerate() {
        if !is_number(low) || !is_number(high) {
            return from_to(0, shape.limits.len() as u16);
        }
        let (first, last) = if factor > 0.0 {
            (low, high)
        } else {
            (high, low)
        };
        least += factor * first;
        most += factor * last;
        size += size_of(factor * first) + size_of(factor * last);
        whole = match (whole, eighths(first), eighths(last)) {
            (Some((below, above)), Some(first), Some(last)) => {
                let factor = shape.whole_factors[number];
                Some((below + factor * first, above + factor * last))
            }
            _ => None,
        };
    }
    let (mut passed_least, mut passed_most) = (0, 0);
    for (number, &limit) in shape.limits.iter().enumerate() {
        let (surely, perhaps) = match whole {
            Some((below, above)) => {
                let bound = shape.whole_limits[number] + i64::from(shape.inclusive[number] == 0);
                (below >= bound, above >= bound)
            }
            None => {
                let two_to_the_minus_53 = 1.0 / MOST;
                let all = size + size_of(limit);
                let error = (values.len() as f64 + 8.0) * two_to_the_minus_53 * all + 1e-270;
                (least - limit > error, most - limit >= -error)
            }
        };
        passed_least += u16::from(surely);
        passed_most += u16::from(perhaps);
    }
    from_to(passed_least, passed_most)
}
