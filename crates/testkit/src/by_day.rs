//! Tests whose cases are many: a share of them runs by day, all at night.

/// Cases of a test: all in a nightly run (`WAVESPLAT_NIGHTLY` is set), else every `nth`, from the first on.
pub fn by_day<T>(cases: impl IntoIterator<Item = T>, nth: usize) -> Vec<T> {
    let nth = if std::env::var_os("WAVESPLAT_NIGHTLY").is_some() { 1 } else { nth };
    cases.into_iter().step_by(nth).collect()
}
