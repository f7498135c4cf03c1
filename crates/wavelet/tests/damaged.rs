//! A damaged volume gives an error, or a volume that decodes; never a panic.

mod damage;

use damage::{Bytes, check, damaged};

#[test]
fn damaged_arrays_are_refused_or_decode() {
    const N: usize = 10_000;
    let mut state = 7_u64;
    let mut n_accepted = 0;
    for round in 0..N {
        let random: Vec<u8> = (0..96)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 56) as u8
            })
            .collect();
        let mut bytes = Bytes(&random);
        let arrays = damaged(&mut bytes);
        let checked = std::panic::catch_unwind(move || check(&arrays, &mut bytes));
        n_accepted += usize::from(checked.unwrap_or_else(|_| panic!("round {round}: {random:?}")));
    }
    // Acceptance and refusal are both frequent.
    assert!(n_accepted > N / 10 && n_accepted < N - N / 10, "{n_accepted} of {N} were accepted");
}
