//! What a ray of the reference meets at a point, of one volume or several.

/// What is at a point of a ray: extinction per world unit, and colour in the light.
pub(super) struct Medium {
    pub extinction: f64,
    pub color: [f64; 3],
}

impl Medium {
    pub const NONE: Self = Self { extinction: 0.0, color: [0.0; 3] };

    /// Together with another: extinctions add, colours mix by extinction. Of what is opaque at any thickness, infinite, the
    /// first counts.
    pub fn and(&self, other: &Self) -> Self {
        let extinction = self.extinction + other.extinction;
        if extinction <= 0.0 {
            return Self::NONE;
        }
        let share = if self.extinction.is_infinite() {
            if other.extinction.is_infinite() { 0.5 } else { 0.0 }
        } else if other.extinction.is_infinite() {
            1.0
        } else {
            other.extinction / extinction
        };
        let color = [0, 1, 2].map(|c| self.color[c] + (other.color[c] - self.color[c]) * share);
        Self { extinction, color }
    }

    /// The mean of two points.
    pub fn mean(&self, other: &Self) -> Self {
        let Self { extinction, color } = self.and(other);
        Self { extinction: 0.5 * extinction, color }
    }
}
