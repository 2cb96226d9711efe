@head@
#![no_std]
// Not every rulebook uses all of this, and fields have its vocabulary's names.
#![allow(dead_code, non_snake_case)]

/// An unknown signal (otherwise 0 or 1) or enumeration.
pub const UNKNOWN: u8 = 255;
/// An unknown number, as are infinity and anything beyond 2^53.
pub const UNKNOWN_NUMBER: f64 = f64::NAN;
/// The most objects at a time.
pub const MOST_OBJECTS: usize = 60_000;
@sizes@
/// The number of variables of each rule.
static VARIABLES_OF: [usize; RULES] = [@variables@];

/// The numbers of rules, of types of objects, and of the values of enumerations.
pub mod names {
    @names@
}

/// The names of the rules, the articles that they cite, and the sources' digests.
@texts@

/// An object, with an id that stays the same while it is present.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Object {
    pub id: u32,
    pub r#type: u8,
    @own_fields@
}

/// The state of the world, and the objects that are present.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    pub objects: &'a [Object],
    @world_fields@
}

impl Object {
    /// An object with every value its default.
    #[must_use]
    pub const fn defaults(id: u32, r#type: u8) -> Self {
        Self { id, r#type@own_defaults@ }
    }
    /// An object with every value unknown.
    #[must_use]
    pub const fn unknown(id: u32, r#type: u8) -> Self {
        Self { id, r#type@own_unknown@ }
    }
}

impl<'a> Input<'a> {
    /// A state with every value its default.
    #[must_use]
    pub const fn defaults(objects: &'a [Object]) -> Self {
        Self { objects@world_defaults@ }
    }
    /// A state with every value unknown.
    #[must_use]
    pub const fn unknown(objects: &'a [Object]) -> Self {
        Self { objects@world_unknown@ }
    }
}

fn has_all_pairs(input: &Input) -> bool {
    @pairs@
    true
}

/// The input in C.
#[repr(C)]
struct CInput {
    n_objects: usize,
    objects: *const Object,
    @c_fields@
}

impl CInput {
    fn of(input: &Input) -> Self {
        Self {
            n_objects: input.objects.len(),
            objects: input.objects.as_ptr(),
            @c_values@
        }
    }
}

/// A verdict, the best first (RV-LTL).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// For good.
    Satisfied,
    /// Would be kept if this were the end.
    HoldsSoFar,
    /// Would be violated if this were the end.
    Pending,
    /// For good.
    Violated,
}

/// The best and the worst that a verdict can be where values are unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    pub best: Verdict,
    pub worst: Verdict,
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said {
    /// Of all hard rules together.
    pub book: Range,
    /// Of each rule, soft ones included.
    pub rules: [Range; RULES],
    /// Choices of objects that violated a rule for good.
    pub violations: u32,
    /// Objects for which there was no seat.
    pub left_out: u32,
}

/// Why a state was refused; the monitor is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// An object's type is invalid.
    BadType,
    /// An object is given twice.
    Twice,
    /// There are more than `MOST_OBJECTS` objects, or a slice about several is too short.
    TooMany,
    /// Facts of the vocabulary exclude such a state.
    ExcludedByFacts,
}

/// The state of the monitor in C, field by field as in its header.
#[repr(C)]
#[derive(Clone)]
struct State {
    id: [u32; SEATS],
    kind: [u8; SEATS],
    at: [u16; INSTANCES],
    verdict: [u8; INSTANCES],
    states: [u32; WORDS + STATE_WORDS],
    about: [[u32; VARIABLES]; RULES],
    flags: [u8; RULES],
    violations: u32,
    left_out: [u8; TYPES],
    next_id: [u32; SEATS],
    next_kind: [u8; SEATS],
    seated: [u16; SEATS],
    stays: [u8; SEATS],
    earlier: [u8; SEATS],
    next_left_out: [u8; TYPES],
    crowded: u8,
    fitting_kind: u8,
    n_taken: u16,
    n_changed: u16,
    n_fitting: u16,
    taken: [u16; SEATS],
    changed: [u16; SEATS],
    fitting: [u16; SEATS],
    digits: [u16; DIGITS],
    reached: [u32; CELL_WORDS],
    classes: [u32; CLASS_WORDS],
    following: [u32; STATE_WORDS],
}

/// A verdict in C: the best and the worst of the rulebook, and of each rule.
#[repr(C)]
struct CVerdict {
    book: [u8; 2],
    rules: [[u8; 2]; RULES],
    violations: u32,
    left_out: u32,
}

extern "C" {
    fn rulec_state_size() -> usize;
    fn rulec_init(state: *mut State);
    fn rulec_step(state: *mut State, input: *const CInput, verdict: *mut CVerdict) -> u8;
    fn rulec_about(state: *const State, rule: u32, variable: u32) -> u32;
}

/// A monitor. A clone is independent.
#[derive(Clone)]
pub struct Monitor {
    state: State,
}

impl Default for Monitor {
    fn default() -> Self {
        Self::new()
    }
}

impl Monitor {
    /// A monitor before the first state.
    ///
    /// # Panics
    /// If the C compiler lays out the state differently from Rust.
    #[must_use]
    pub fn new() -> Self {
        // SAFETY: the size is the one of the C code, which initialises all of it.
        unsafe {
            assert_eq!(rulec_state_size(), core::mem::size_of::<State>());
            let mut state = core::mem::MaybeUninit::zeroed();
            rulec_init(state.as_mut_ptr());
            Self { state: state.assume_init() }
        }
    }

    /// The id of the object that a variable of a rule, counted from 0, stands for in the choice of
    /// objects with the worst verdict, also if they have left; 0 if there is no such choice.
    /// `None` if the rule has no such variable.
    #[must_use]
    pub fn about(&self, rule: usize, variable: usize) -> Option<u32> {
        if variable >= *VARIABLES_OF.get(rule)? {
            return None;
        }
        // SAFETY: the C code only reads the state; both numbers are small.
        Some(unsafe { rulec_about(&self.state, rule as u32, variable as u32) })
    }

    /// Takes the next state. An object that is missing has left; if it returns, or changes its
    /// type, it is a new object. Objects for which there is no seat are counted; from then on the
    /// worst verdict of every rule that could apply to them is violated. If one of them gets a seat
    /// later, its past is unknown.
    ///
    /// # Errors
    ///
    /// If the state is refused; the monitor is unchanged.
    pub fn step(&mut self, input: &Input) -> Result<Said, Refusal> {
        if input.objects.len() > MOST_OBJECTS || !has_all_pairs(input) {
            return Err(Refusal::TooMany);
        }
        let given = CInput::of(input);
        let mut found = CVerdict {
            book: [0; 2],
            rules: [[0; 2]; RULES],
            violations: 0,
            left_out: 0,
        };
        // SAFETY: the slices of the input have the lengths that the C code reads.
        match unsafe { rulec_step(&mut self.state, &given, &mut found) } {
            0 => Ok(Said {
                book: range(found.book),
                rules: found.rules.map(range),
                violations: found.violations,
                left_out: found.left_out,
            }),
            2 => Err(Refusal::BadType),
            3 => Err(Refusal::Twice),
            5 => Err(Refusal::ExcludedByFacts),
            _ => Err(Refusal::TooMany),
        }
    }
}

fn range(ends: [u8; 2]) -> Range {
    let [best, worst] = ends.map(|number| match number {
        0 => Verdict::Satisfied,
        1 => Verdict::HoldsSoFar,
        2 => Verdict::Pending,
        _ => Verdict::Violated,
    });
    Range { best, worst }
}
