//! The monitor accepts a state with all values unknown, and refuses invalid states.

use @name@::*;

#[test]
fn nothing_known_violates_nothing_for_sure() {
    let said = Monitor::new().step(&Input::unknown(&[]));
    assert!(matches!(said, Ok(said) if said.book.best < Verdict::Violated));
}

#[test]
fn what_is_no_object_is_refused() {
    let objects = [Object::unknown(1, u8::MAX)];
    let said = Monitor::new().step(&Input::unknown(&objects));
    assert_eq!(said, Err(Refusal::BadType));
}
