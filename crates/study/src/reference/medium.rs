//! Medium at a point of a ray of the reference, of one volume or several.

/// Medium at a point of a ray: extinction per world unit, and colour after shading.
pub(super) struct Medium {
    pub extinction: f64,
    pub color: [f64; 3],
}

impl Medium {
    pub const NONE: Self = Self { extinction: 0.0, color: [0.0; 3] };

    /// Mixture with another medium: extinctions add, colours mix by extinction. A medium that is opaque at any
    /// thickness (infinite extinction) decides the colour alone; two of them mix evenly.
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
