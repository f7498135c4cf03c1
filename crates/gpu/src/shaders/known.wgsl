// What is known of a place whose samples are missing in part. Twin of crates/splat/src/source/nonfinite.rs.

// 1 less the missing share, or 0.
fn known_share(missing: f32) -> f32 {
    return select(1.0f - missing, 0.0f, 1.0f - missing < MIN_KNOWN);
}

// The shares of the way between two sheets between which points are known; the first is not below the second where none is.
fn known_part(front: f32, back: f32) -> vec2<f32> {
    let crossing = (MISSING - front) / select(back - front, 1.0f, back == front);
    let begin = select(0.0f, select(crossing, 1.0f, back >= MISSING), front >= MISSING);
    let end = select(1.0f, select(crossing, 0.0f, front >= MISSING), back >= MISSING);
    return vec2<f32>(begin, end);
}
