// A monitor in Rust with the functions of the C harness, which a proof calls.

use rulec_::*;

#[repr(C)]
struct CSaid {
    ranges: [[u8; 2]; RULES + 1],
    violations: u32,
    left_out: u32,
}

fn both(range: Range) -> [u8; 2] {
    [range.best as u8, range.worst as u8]
}

#[no_mangle]
extern "C" fn rulec_state_size() -> usize {
    std::mem::size_of::<Monitor>()
}

#[no_mangle]
extern "C" fn rulec_kept_size() -> usize {
    0
}

#[no_mangle]
unsafe extern "C" fn rulec_init(monitor: *mut Monitor) {
    unsafe { monitor.write_unaligned(Monitor::new()) }
}

#[no_mangle]
unsafe extern "C" fn rulec_step(
    monitor: *mut Monitor,
    input: *const CInput,
    said: *mut CSaid,
) -> u8 {
    unsafe {
        let mut own = monitor.read_unaligned();
        let result = own.step(&(*input).as_input());
        monitor.write_unaligned(own);
        match result {
            Ok(found) => {
                let mut ranges = [[0; 2]; RULES + 1];
                ranges[0] = both(found.book);
                for (to, from) in ranges[1..].iter_mut().zip(found.rules) {
                    *to = both(from);
                }
                let (violations, left_out) = (found.violations, found.left_out);
                said.write_unaligned(CSaid {
                    ranges,
                    violations,
                    left_out,
                });
                0
            }
            Err(Refusal::BadType) => 2,
            Err(Refusal::Twice) => 3,
            Err(Refusal::TooMany) => 4,
            Err(Refusal::ExcludedByFacts) => 5,
        }
    }
}

#[no_mangle]
unsafe extern "C" fn rulec_all_classes(
    rule: u32,
    reads: *const u32,
    sizes: *const u32,
    n: u32,
    classes: *mut u16,
) {
    unsafe {
        let reads = std::slice::from_raw_parts(reads, n as usize);
        let sizes = std::slice::from_raw_parts(sizes, n as usize);
        let letters: u32 = sizes.iter().product();
        for letter in 0..letters {
            let mut left = letter;
            let digits: Vec<u16> = sizes
                .iter()
                .map(|size| {
                    let digit = left % size;
                    left /= size;
                    digit as u16
                })
                .collect();
            *classes.add(letter as usize) = proof::class_of(rule as usize, reads, &digits);
        }
    }
}

#[no_mangle]
unsafe extern "C" fn rulec_all_steps(
    rule: u32,
    reached: *mut u16,
    verdicts: *mut u8,
    by_sets: *mut u16,
) {
    let (n_states, n_classes) = proof::sizes_of(rule as usize);
    for from in 0..n_states {
        for by in 0..n_classes {
            let place = from * n_classes + by;
            let (entry, by_set) = proof::step_of(rule as usize, from as u16, by);
            unsafe {
                *reached.add(place) = entry >> 2;
                *verdicts.add(place) = (entry & 3) as u8;
                *by_sets.add(place) = by_set;
            }
        }
    }
}

#[no_mangle]
unsafe extern "C" fn rulec_digits(
    input: *const CInput,
    who: *const usize,
    source: u32,
    digits: *mut u16,
) {
    unsafe {
        let digits = std::slice::from_raw_parts_mut(digits, 0x1000);
        let who = std::slice::from_raw_parts(who, VARIABLES);
        proof::digits(&(*input).as_input(), who, source as usize, digits);
    }
}

/// The numbers in a rule's tables.
#[no_mangle]
unsafe extern "C" fn rulec_numbers(number: u32, cells: *mut u16, entries: *mut u16) {
    let (from_cells, from_entries) = proof::tables_of(number as usize);
    unsafe {
        std::ptr::copy_nonoverlapping(from_cells.as_ptr(), cells, from_cells.len());
        std::ptr::copy_nonoverlapping(from_entries.as_ptr(), entries, from_entries.len());
    }
}
