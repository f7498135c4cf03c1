// Known share of a place some of whose samples are missing. Twin of crates/splat/src/source/nonfinite.rs.

// 1 - missing share, or 0 where less than MIN_KNOWN is left.
fn known_share(missing: f32) -> f32 {
    return select(1.0f - missing, 0.0f, 1.0f - missing < MIN_KNOWN);
}

// Part of the way between two sheets where points are known, as two shares of it; the first is not below the second
// where no point is known.
fn known_part(front: f32, back: f32) -> vec2<f32> {
    let crossing = (MISSING - front) / select(back - front, 1.0f, back == front);
    let begin = select(0.0f, select(crossing, 1.0f, back >= MISSING), front >= MISSING);
    let end = select(1.0f, select(crossing, 0.0f, front >= MISSING), back >= MISSING);
    return vec2<f32>(begin, end);
}
