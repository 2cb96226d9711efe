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

const VERDICTS: [Verdict; 4] = [
    Verdict::Satisfied,
    Verdict::HoldsSoFar,
    Verdict::Pending,
    Verdict::Violated,
];

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

struct Rule {
    cells: &'static [u16],
    /// The state reached times 4, and the verdict: by state and class of letters.
    entries: &'static [u16],
    n_classes: usize,
    first_instance: usize,
    first_word: usize,
    /// For each variable: its type, the first seat and the one after the last.
    variables: &'static [(usize, usize, usize)],
    together: &'static [u16],
    start: u8,
    hard: bool,
    facts: bool,
}

impl Rule {
    fn n_states(&self) -> usize {
        self.entries.len() / self.n_classes
    }

    /// The place of an instance's set of states.
    fn words(&self, instance: usize) -> core::ops::Range<usize> {
        let n_words = self.n_states() / 32 + 1;
        let first = self.first_word + (instance - self.first_instance) * n_words;
        first..first + n_words
    }
}

const NOBODY: u8 = TYPES as u8;
const EMPTY: usize = usize::MAX;
const SEVERAL: u16 = 0xffff;
const LEAF: u16 = 0x8000;
const EXCLUDED: u16 = 0xffff;
const LOST: u8 = 1;
const DOUBTED: u8 = 2;
const GONE: u8 = 4;

fn fits(kind: usize, own: u8) -> bool {
    own < NOBODY && FITS[kind][usize::from(own)]
}

fn exactly(verdict: u8) -> u8 {
    verdict * 5
}

fn range(best: u8, worst: u8) -> Range {
    Range {
        best: VERDICTS[usize::from(best)],
        worst: VERDICTS[usize::from(worst)],
    }
}

/// The state kept from one step to the next.
#[derive(Clone)]
struct Kept {
    id: [u32; SEATS],
    kind: [u8; SEATS],
    /// The entry that an instance took last, or SEVERAL: then its states are a set.
    at: [u16; INSTANCES],
    /// For an instance with a set of states: the best verdict, and the worst times 4.
    verdict: [u8; INSTANCES],
    states: [u32; WORDS],
    about: [[u32; VARIABLES]; RULES],
    flags: [u8; RULES],
    violations: u32,
    /// Types of objects for which there was no seat.
    left_out: [bool; TYPES],
}

/// The working memory of a step.
#[derive(Clone)]
struct Work {
    next_id: [u32; SEATS],
    next_kind: [u8; SEATS],
    seated: [usize; SEATS],
    stays: [bool; SEATS],
    earlier: [bool; SEATS],
    next_left_out: [bool; TYPES],
    crowded: bool,
    taken: [usize; SEATS],
    n_taken: usize,
    world: [u16; WORLD_READS],
    own: [[u16; OWN_READS]; SEATS],
    shared: [u16; SHARED_READS],
    reached: [u32; CELL_WORDS],
    classes: [u32; CLASS_WORDS],
    following: [u32; STATE_WORDS],
}

/// A monitor. A clone is independent.
#[derive(Clone)]
pub struct Monitor {
    kept: Kept,
    work: Work,
}

struct Instance {
    number: usize,
    turns: [usize; VARIABLES],
    seats: [usize; VARIABLES],
}

#[derive(Clone, Copy)]
struct Presence {
    was: bool,
    stays: bool,
    is: bool,
    /// All that are present now were so in the state before, or may have been.
    earlier: bool,
}

fn set(bits: &mut [u32], place: usize) {
    bits[place / 32] |= 1 << (place % 32);
}

fn is_set(bits: &[u32], place: usize) -> bool {
    (bits[place / 32] >> (place % 32)) & 1 != 0
}

/// The class of the letter that is read, if no unknown value matters.
fn class(cells: &[u16], digit: impl Fn(u16) -> u16) -> u16 {
    let mut at = cells[0];
    while at < LEAF {
        let found = digit(cells[usize::from(at)]);
        if found > 0xff {
            return SEVERAL;
        }
        at = cells[usize::from(at) + 1 + usize::from(found)];
    }
    at & 0x7fff
}

/// All classes of letters that may be read, as bits; false if there is none.
fn classes(
    cells: &[u16],
    digit: impl Fn(u16) -> u16,
    reached: &mut [u32],
    found: &mut [u32],
) -> bool {
    reached.fill(0);
    found.fill(0);
    let mut lead = |reached: &mut [u32], cell: u16| {
        if cell < LEAF {
            set(reached, usize::from(cell));
        } else if cell != EXCLUDED {
            set(found, usize::from(cell & 0x7fff));
        }
    };
    lead(reached, cells[0]);
    let mut at = 1;
    while at < cells.len() {
        if is_set(reached, at) {
            let digits = usize::from(digit(cells[at]));
            for each in digits & 0xff..=(digits & 0xff) + (digits >> 8) {
                lead(reached, cells[at + 1 + each]);
            }
        }
        at += 1 + usize::from(size_of_read(cells[at]));
    }
    found.iter().any(|&word| word != 0)
}

fn size_of_read(read: u16) -> u8 {
    let place = usize::from(read & 0xfff);
    match read >> 12 {
        0 => WORLD_SIZES[place],
        7 => SHARED_SIZES[place],
        _ => OWN_SIZES[place],
    }
}

impl Work {
    fn digit(&self, one: &Instance, read: u16) -> u16 {
        let place = usize::from(read & 0xfff);
        match read >> 12 {
            0 => self.world[place],
            7 => self.shared[place],
            source => self.own[one.seats[usize::from(source) - 1]][place],
        }
    }

    fn look(&mut self, input: &Input, rule: &Rule, one: &Instance) {
        for &read in rule.together {
            let mut who = [0; VARIABLES];
            for (place, &seat) in who.iter_mut().zip(&one.seats) {
                *place = self.seated[seat];
            }
            self.shared[usize::from(read)] = read_together(input, &who, read);
        }
    }

    fn classes(&mut self, rule: &Rule, one: &Instance) -> bool {
        let (mut reached, mut found) = (self.reached, self.classes);
        let any = classes(
            rule.cells,
            |read| self.digit(one, read),
            &mut reached,
            &mut found,
        );
        (self.reached, self.classes) = (reached, found);
        any
    }
}

impl Kept {
    fn said(&self, instance: usize) -> u8 {
        match self.at[instance] {
            SEVERAL => self.verdict[instance],
            entry => exactly((entry & 3) as u8),
        }
    }

    fn lose(&mut self, number: usize, one: &Instance, ids: &[u32; SEATS]) {
        self.violations = self.violations.wrapping_add(1);
        self.flags[number] |= LOST;
        self.tell(number, one, ids);
    }

    /// Whether the objects with the worst verdict are those of an earlier step.
    fn is_told(&self, number: usize) -> bool {
        self.flags[number] & (LOST | GONE) != 0
    }

    fn tell(&mut self, number: usize, one: &Instance, ids: &[u32; SEATS]) {
        for variable in 0..RULE_TABLE[number].variables.len() {
            self.about[number][variable] = ids[one.seats[variable]];
        }
    }

    /// Objects leave: a pending verdict becomes violated, an open one stays open.
    fn part(&mut self, number: usize, one: &Instance) {
        let verdict = self.said(one.number);
        let (best, worst) = (verdict & 3, verdict >> 2);
        if best == 2 {
            let ids = self.id;
            self.lose(number, one, &ids);
        } else if best != 3 && worst >= 2 {
            if !self.is_told(number) {
                let ids = self.id;
                self.tell(number, one, &ids);
                self.flags[number] |= GONE;
            }
            self.flags[number] |= DOUBTED;
        }
    }

    /// The past of an instance is unknown: it may be in any state.
    fn forget(&mut self, rule: &Rule, instance: usize) {
        self.states[rule.words(instance)].fill(u32::MAX);
        self.at[instance] = SEVERAL;
        self.verdict[instance] = 3 << 2;
    }

    /// A step with unknown values: from each possible state by each possible class.
    fn advance_all(&mut self, rule: &Rule, instance: usize, by: &[u32], following: &mut [u32]) {
        let states = &mut self.states[rule.words(instance)];
        if self.at[instance] != SEVERAL {
            states.fill(0);
            set(states, usize::from(self.at[instance] >> 2));
        }
        following.fill(0);
        let (mut best, mut worst, mut last, mut found) = (3, 0, 0, 0);
        for (from, row) in rule.entries.chunks(rule.n_classes).enumerate() {
            for (class, &entry) in row.iter().enumerate() {
                if is_set(states, from) && is_set(by, class) {
                    let verdict = (entry & 3) as u8;
                    last = entry >> 2;
                    found += u32::from(!is_set(following, usize::from(last)));
                    set(following, usize::from(last));
                    best = verdict.min(best);
                    worst = verdict.max(worst);
                }
            }
        }
        states.copy_from_slice(&following[..states.len()]);
        let exact = found == 1 && best == worst;
        self.at[instance] = if exact {
            last << 2 | u16::from(best)
        } else {
            SEVERAL
        };
        self.verdict[instance] = best | worst << 2;
    }
}

impl Monitor {
    /// A monitor before the first state.
    #[must_use]
    pub const fn new() -> Self {
        let mut kept = Kept {
            id: [0; SEATS],
            kind: [NOBODY; SEATS],
            at: [0; INSTANCES],
            verdict: [0; INSTANCES],
            states: [0; WORDS],
            about: [[0; VARIABLES]; RULES],
            flags: [0; RULES],
            violations: 0,
            left_out: [false; TYPES],
        };
        let mut rule = 0;
        while rule < RULES {
            if RULE_TABLE[rule].variables.is_empty() {
                kept.at[RULE_TABLE[rule].first_instance] = RULE_TABLE[rule].start as u16;
            }
            rule += 1;
        }
        let work = Work {
            next_id: [0; SEATS],
            next_kind: [NOBODY; SEATS],
            seated: [EMPTY; SEATS],
            stays: [false; SEATS],
            earlier: [false; SEATS],
            next_left_out: [false; TYPES],
            crowded: false,
            taken: [0; SEATS],
            n_taken: 0,
            world: [0; WORLD_READS],
            own: [[0; OWN_READS]; SEATS],
            shared: [0; SHARED_READS],
            reached: [0; CELL_WORDS],
            classes: [0; CLASS_WORDS],
            following: [0; STATE_WORDS],
        };
        Self { kept, work }
    }

    /// The id of the object of a rule's variable (from 0) in the choice of objects with the worst
    /// verdict, also if they have left; 0 if there is no such choice; none if the rule has no such
    /// variable.
    #[must_use]
    pub fn about(&self, rule: usize, variable: usize) -> Option<u32> {
        let about = self.kept.about.get(rule)?;
        about[..RULE_TABLE[rule].variables.len()]
            .get(variable)
            .copied()
    }

    /// Takes the next state. An object that is missing has left; if it returns, or changes its
    /// type, it is a new object. Objects for which there is no seat are counted; from then on the
    /// worst verdict of every rule that could apply to them is violated. If one of them gets a seat
    /// later, its past is unknown.
    ///
    /// # Errors
    ///
    /// The problem with the input; then the monitor is unchanged.
    pub fn step(&mut self, input: &Input) -> Result<Said, Refusal> {
        if input.objects.len() > MOST_OBJECTS || !has_all_pairs(input) {
            return Err(Refusal::TooMany);
        }
        let left_out = self.seat(input)?;
        self.look_around(input);
        if (0..RULES).any(|number| RULE_TABLE[number].facts && self.is_excluded(input, number)) {
            return Err(Refusal::ExcludedByFacts);
        }
        let mut said = Said {
            book: range(0, 0),
            rules: [range(0, 0); RULES],
            violations: 0,
            left_out,
        };
        for (number, rule) in RULE_TABLE.iter().enumerate() {
            let own = self.judge(input, number);
            said.rules[number] = own;
            if rule.hard {
                said.book.best = said.book.best.max(own.best);
                said.book.worst = said.book.worst.max(own.worst);
            }
        }
        self.kept.id = self.work.next_id;
        self.kept.kind = self.work.next_kind;
        self.kept.left_out = self.work.next_left_out;
        said.violations = self.kept.violations;
        Ok(said)
    }

    /// Seats: objects keep theirs while they are present, others get free seats. Nothing is kept
    /// about objects without a seat: if a type had some, any object of it that now gets one may be
    /// of them.
    fn seat(&mut self, input: &Input) -> Result<u32, Refusal> {
        let (kept, work) = (&self.kept, &mut self.work);
        work.crowded = false;
        work.next_left_out.fill(false);
        work.seated.fill(EMPTY);
        for (one, object) in input.objects.iter().enumerate() {
            let kind = usize::from(object.r#type);
            if kind >= TYPES {
                return Err(Refusal::BadType);
            }
            let own = (FIRST[kind]..END[kind])
                .find(|&seat| kept.id[seat] == object.id && kept.kind[seat] == object.r#type);
            if let Some(seat) = own {
                if work.seated[seat] != EMPTY {
                    return Err(Refusal::Twice);
                }
                work.seated[seat] = one;
            }
        }
        for seat in 0..SEATS {
            work.stays[seat] = work.seated[seat] != EMPTY;
            work.earlier[seat] = work.stays[seat];
            work.next_id[seat] = kept.id[seat];
            work.next_kind[seat] = if work.stays[seat] {
                kept.kind[seat]
            } else {
                NOBODY
            };
        }
        let mut left_out = 0;
        for (one, object) in input.objects.iter().enumerate() {
            let kind = usize::from(object.r#type);
            let mut seats = FIRST[kind]..END[kind];
            if seats.clone().any(|seat| work.seated[seat] == one) {
                continue;
            }
            let is_this = |other: &Object| other.id == object.id && other.r#type == object.r#type;
            let on_seat = |seat: usize| input.objects.get(work.seated[seat]);
            if seats.clone().filter_map(on_seat).any(is_this) {
                return Err(Refusal::Twice);
            }
            match seats.find(|&seat| work.seated[seat] == EMPTY) {
                Some(free) => {
                    work.seated[free] = one;
                    work.next_id[free] = object.id;
                    work.next_kind[free] = object.r#type;
                    work.earlier[free] = kept.left_out[kind];
                }
                None if input.objects[..one].iter().any(is_this) => return Err(Refusal::Twice),
                None => {
                    left_out += 1;
                    work.crowded = true;
                    work.next_left_out[kind] = true;
                }
            }
        }
        Ok(left_out)
    }

    fn look_around(&mut self, input: &Input) {
        let work = &mut self.work;
        read_world(input, &mut work.world);
        work.n_taken = 0;
        for seat in 0..SEATS {
            if self.kept.kind[seat] != NOBODY || work.next_kind[seat] != NOBODY {
                work.taken[work.n_taken] = seat;
                work.n_taken += 1;
            }
            if work.seated[seat] != EMPTY {
                read_own(input, work.seated[seat], &mut work.own[seat]);
            }
        }
    }

    /// The instance of a choice of seats, if its objects are or were present; no object is used for
    /// two variables.
    fn there(&self, rule: &Rule, one: &mut Instance) -> Option<Presence> {
        let (kept, work) = (&self.kept, &self.work);
        let mut found = Presence {
            was: true,
            stays: true,
            is: true,
            earlier: true,
        };
        let mut number = 0;
        for (variable, &(kind, first, end)) in rule.variables.iter().enumerate() {
            let seat = work.taken[one.turns[variable]];
            if !(first..end).contains(&seat) || one.seats[..variable].contains(&seat) {
                return None;
            }
            one.seats[variable] = seat;
            number = number * (end - first) + seat - first;
            found.was = found.was && fits(kind, kept.kind[seat]);
            found.is = found.is && fits(kind, work.next_kind[seat]);
            found.stays = found.stays && work.stays[seat];
            found.earlier = found.earlier && work.earlier[seat];
        }
        one.number = rule.first_instance + number;
        (found.was || found.is).then_some(found)
    }

    /// Go on to the next choice of seats; false after the last one.
    fn turn(&self, rule: &Rule, one: &mut Instance) -> bool {
        for variable in (0..rule.variables.len()).rev() {
            one.turns[variable] += 1;
            if one.turns[variable] < self.work.n_taken {
                return true;
            }
            one.turns[variable] = 0;
        }
        false
    }

    /// Calls a function for every choice of objects that are or were present.
    fn each(&mut self, rule: &Rule, mut take: impl FnMut(&mut Self, &Instance, Presence)) {
        let mut one = Instance {
            number: 0,
            turns: [0; VARIABLES],
            seats: [0; VARIABLES],
        };
        let mut more = rule.variables.is_empty() || self.work.n_taken > 0;
        while more {
            if let Some(presence) = self.there(rule, &mut one) {
                take(self, &one, presence);
            }
            more = self.turn(rule, &mut one);
        }
    }

    /// Whether facts exclude the values that a rule reads about some objects.
    fn is_excluded(&mut self, input: &Input, number: usize) -> bool {
        let rule = &RULE_TABLE[number];
        let mut excluded = false;
        self.each(rule, |this, one, presence| {
            if presence.is {
                this.work.look(input, rule, one);
                excluded |= !this.work.classes(rule, one);
            }
        });
        excluded
    }

    fn advance(&mut self, rule: &Rule, one: &Instance) {
        let (kept, work) = (&mut self.kept, &mut self.work);
        let by = class(rule.cells, |read| work.digit(one, read));
        let from = kept.at[one.number];
        if by != SEVERAL && from != SEVERAL {
            kept.at[one.number] =
                rule.entries[usize::from(from >> 2) * rule.n_classes + usize::from(by)];
            return;
        }
        if by == SEVERAL {
            work.classes(rule, one);
        } else {
            work.classes.fill(0);
            set(&mut work.classes, usize::from(by));
        }
        kept.advance_all(rule, one.number, &work.classes, &mut work.following);
    }

    fn judge(&mut self, input: &Input, number: usize) -> Range {
        let rule = &RULE_TABLE[number];
        let (mut best, mut worst) = (0, 0);
        if !self.kept.is_told(number) {
            self.kept.about[number] = [0; VARIABLES];
        }
        self.each(rule, |this, one, there| {
            if there.was && !there.stays {
                this.kept.part(number, one);
            }
            if !there.is {
                return;
            }
            if there.earlier && !there.stays {
                this.kept.forget(rule, one.number);
            } else if !there.stays {
                this.kept.at[one.number] = u16::from(rule.start);
            }
            this.work.look(input, rule, one);
            let before = this.kept.said(one.number);
            this.advance(rule, one);
            let now = this.kept.said(one.number);
            if now == exactly(3) && before != now {
                this.kept.lose(number, one, &this.work.next_id);
            }
            best = best.max(now & 3);
            // Compares the worst verdict first, then the best one, as a single number
            if now > worst {
                worst = now;
                if !this.kept.is_told(number) {
                    this.kept.tell(number, one, &this.work.next_id);
                }
            }
        });
        worst >>= 2;
        if !rule.variables.is_empty() && rule.start != 0 {
            best = best.max(1);
            worst = worst.max(1);
            let absent = |kind: usize| {
                (0..TYPES).any(|own| self.work.next_left_out[own] && fits(kind, own as u8))
            };
            if self.work.crowded && rule.variables.iter().any(|&(kind, _, _)| absent(kind)) {
                self.kept.flags[number] |= DOUBTED;
            }
        }
        let flags = self.kept.flags[number];
        range(
            if flags & LOST != 0 { 3 } else { best },
            if flags != 0 { 3 } else { worst },
        )
    }
}

impl Default for Monitor {
    fn default() -> Self {
        Self::new()
    }
}

/// The parts of the tables that a proof reads; not needed for monitoring.
#[doc(hidden)]
pub mod proof {
    use super::*;

    /// A rule's cells and entries.
    pub fn tables_of(rule: usize) -> (&'static [u16], &'static [u16]) {
        (RULE_TABLE[rule].cells, RULE_TABLE[rule].entries)
    }

    fn asked<T: Copy>(reads: &[u32], given: &[T], read: u16) -> T {
        let place = reads.iter().position(|&one| one == u32::from(read));
        given[place.unwrap_or(usize::MAX)]
    }

    pub fn class_of(rule: usize, reads: &[u32], digits: &[u16]) -> u16 {
        class(RULE_TABLE[rule].cells, |read| asked(reads, digits, read))
    }

    pub fn step_of(rule: usize, from: u16, by: usize) -> (u16, u16) {
        let own = &RULE_TABLE[rule];
        let mut kept = Monitor::new().kept;
        kept.at[own.first_instance] = from << 2;
        let (mut classes, mut following) = ([0; CLASS_WORDS], [0; STATE_WORDS]);
        set(&mut classes, by);
        kept.advance_all(own, own.first_instance, &classes, &mut following);
        let entry = own.entries[usize::from(from) * own.n_classes + by];
        (entry, kept.at[own.first_instance])
    }

    pub fn sizes_of(rule: usize) -> (usize, usize) {
        (RULE_TABLE[rule].n_states(), RULE_TABLE[rule].n_classes)
    }

    pub fn digits(input: &Input, who: &[usize], source: usize, digits: &mut [u16]) {
        match source {
            0 => {
                let mut found = [0; WORLD_READS];
                read_world(input, &mut found);
                digits[..WORLD_READS].copy_from_slice(&found);
            }
            7 => {
                let mut all = [0; VARIABLES];
                all[..who.len()].copy_from_slice(who);
                for (read, digit) in digits[..SHARED_READS].iter_mut().enumerate() {
                    *digit = read_together(input, &all, read as u16);
                }
            }
            _ => {
                let mut found = [0; OWN_READS];
                read_own(input, who[source - 1], &mut found);
                digits[..OWN_READS].copy_from_slice(&found);
            }
        }
    }
}
