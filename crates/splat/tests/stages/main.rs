//! Stage by stage: small inputs with answers from formulas, which every backend is held to, and this one at every SIMD
//! level. The files are in `crates/splat/fixtures`; the format is described in `docs/design/012-stage-fixtures.md`.

mod cases;
mod fixture;
mod formulas;
mod ray_cases;
mod run;

use wavesplat_compute::simd::Level;

/// Largest size of all fixtures together, in bytes.
const MAX_BYTES: u64 = 300 << 10;

#[test]
fn fixtures_are_what_the_formulas_give() {
    for fixture in cases::fixtures() {
        if std::env::var_os("WAVESPLAT_WRITE_FIXTURES").is_some() {
            // Run by `make fixtures`.
            fixture.write();
        }
        fixture.check_stored();
    }
    let n_bytes = fixture::n_bytes();
    assert!(n_bytes < MAX_BYTES, "the fixtures take {n_bytes} bytes");
}

#[test]
fn every_level_gives_the_answers_and_the_same_bits() {
    let mut failures = Vec::new();
    for fixture in cases::fixtures() {
        for case in fixture.stored() {
            let narrowest = run::run(fixture.stage, Level::all()[0], &case);
            for level in Level::all() {
                let got = run::run(fixture.stage, level, &case);
                failures.extend(fixture.check(&case, &got, level.name()).err());
                let bits = |x: &fixture::Arrays| x.values().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
                if bits(&got) != bits(&narrowest) {
                    failures.push(format!("{} of {}: {level:?} has other bits", case.name, fixture.stage));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}
