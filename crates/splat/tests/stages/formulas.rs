//! Formulas of the stages, in f64 and from the definitions: nothing here calls the renderer.

/// A reconstruction kernel at a distance, samples.
pub fn kernel(name: &str, x: f64) -> f64 {
    let r = x.abs();
    match name {
        "linear" => (1.0 - r).max(0.0),
        // Keys (1981), with a = -1/2.
        "catmull-rom" => {
            let a = -0.5;
            if r < 1.0 {
                (a + 2.0) * r.powi(3) - (a + 3.0) * r.powi(2) + 1.0
            } else if r < 2.0 {
                a * r.powi(3) - 5.0 * a * r.powi(2) + 8.0 * a * r - 4.0 * a
            } else {
                0.0
            }
        }
        "bspline2" => bspline(2, x),
        "bspline3" => bspline(3, x),
        "gaussian" if r < 2.0 => (-2.0 * x * x).exp(),
        _ => 0.0,
    }
}

/// The centred B-spline of a degree, by the recursion of Cox and de Boor.
fn bspline(degree: i32, x: f64) -> f64 {
    if degree == 0 {
        return if (-0.5..0.5).contains(&x) { 1.0 } else { 0.0 };
    }
    let half = f64::from(degree + 1) / 2.0;
    ((half + x) * bspline(degree - 1, x + 0.5) + (half - x) * bspline(degree - 1, x - 0.5)) / f64::from(degree)
}

/// Number of taps of a kernel; with [`first_tap`], the samples within its radius.
pub fn n_taps(name: &str) -> usize {
    match name {
        "linear" => 2,
        "bspline2" => 3,
        _ => 4,
    }
}

pub fn first_tap(name: &str, x: f64) -> f64 {
    match name {
        "linear" => x.floor(),
        "bspline2" => (x + 0.5).floor() - 1.0,
        _ => x.floor() - 1.0,
    }
}

/// Weight of tap `k` at a position; all weights sum to 1.
pub fn weight(name: &str, x: f64, k: f64) -> f64 {
    let all: f64 = (-4..=4).map(|i| kernel(name, x - (x.floor() + f64::from(i)))).sum();
    kernel(name, x - k) / all
}

/// Index of the sample, of `n`, that is used at `k`: beyond the faces the last one, or for splines its mirror image.
fn folded(name: &str, k: i64, n: usize) -> usize {
    let last = n as i64 - 1;
    if !name.starts_with("bspline") {
        return k.clamp(0, last) as usize;
    }
    let mut k = k;
    while k < 0 || k > last {
        k = if k < 0 { -k } else { 2 * last - k };
    }
    k as usize
}

/// Weights of all `n` samples at a position, which stops at the faces.
pub fn weights(name: &str, x: f64, n: usize) -> Vec<f64> {
    let x = x.clamp(0.0, (n - 1) as f64);
    let mut weights = vec![0.0; n];
    for i in -4..=4 {
        let k = x.floor() + f64::from(i);
        weights[folded(name, k as i64, n)] += weight(name, x, k);
    }
    weights
}

/// Weights of `[V(x + d) − V(x − d)] / 2d`.
pub fn difference(name: &str, x: f64, d: f64, n: usize) -> Vec<f64> {
    let x = x.clamp(0.0, (n - 1) as f64);
    let (hi, lo) = (weights(name, x + d, n), weights(name, x - d, n));
    hi.iter().zip(lo).map(|(hi, lo)| (hi - lo) / (2.0 * d)).collect()
}

/// The sum `Σ u[x] v[y] w[z] sample[z][y][x]`.
pub fn sum3([us, vs, ws]: [&[f64]; 3], samples: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (z, w) in ws.iter().enumerate() {
        for (y, v) in vs.iter().enumerate() {
            for (x, u) in us.iter().enumerate() {
                sum += u * v * w * samples[(z * vs.len() + y) * us.len() + x];
            }
        }
    }
    sum
}

/// A curve through nodes `(value, number)`, constant beyond the outer ones.
fn curve(nodes: &[(f64, f64)], at: f64) -> f64 {
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    if at <= first.0 {
        return first.1;
    }
    for pair in nodes.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        if at <= x1 {
            return y0 + (y1 - y0) * (at - x0) / (x1 - x0);
        }
    }
    last.1
}

/// A transfer function: opacity per unit of length, and colour, by density.
pub struct Curves {
    pub opacity: Vec<(f64, f64)>,
    pub color: Vec<(f64, [f64; 3])>,
}

impl Curves {
    pub fn color(&self, density: f64) -> [f64; 3] {
        std::array::from_fn(|c| {
            let channel: Vec<(f64, f64)> = self.color.iter().map(|(value, rgb)| (*value, rgb[c])).collect();
            curve(&channel, density)
        })
    }

    /// Optical depth per unit of length.
    pub fn depth(&self, density: f64) -> f64 {
        -(-curve(&self.opacity, density)).ln_1p()
    }

    /// Integral of the optical depth over densities: Simpson's rule between nodes.
    fn integral(&self, from: f64, to: f64) -> f64 {
        let mut ends = vec![from, to];
        ends.extend(self.opacity.iter().map(|node| node.0).filter(|x| from < *x && *x < to));
        ends.sort_by(f64::total_cmp);
        let piece = |a: f64, b: f64| {
            const N: i32 = 200;
            let at = |i: i32| a + (b - a) * f64::from(i) / f64::from(2 * N);
            let sum: f64 = (0..N)
                .map(|i| self.depth(at(2 * i)) + 4.0 * self.depth(at(2 * i + 1)) + self.depth(at(2 * i + 2)))
                .sum();
            sum * (b - a) / f64::from(6 * N)
        };
        ends.windows(2).map(|pair| piece(pair[0], pair[1])).sum()
    }

    /// The first visible density, looking up or down from a density; `None` where nothing is visible.
    fn visible_from(&self, density: f64, up: bool) -> Option<f64> {
        let mut best: Option<f64> = None;
        // Takes densities from `lo` to `hi` that have an opacity, or not at an end: such an end is in sight from one
        // side only.
        let mut offer = |lo: f64, hi: f64, at_ends: [bool; 2]| {
            let (found, is_ahead) = if up {
                (density.max(lo), density < hi || (density == hi && at_ends[1]))
            } else {
                (density.min(hi), density > lo || (density == lo && at_ends[0]))
            };
            if is_ahead && best.is_none_or(|best| (found < best) == up) {
                best = Some(found);
            }
        };
        let (first, last) = (self.opacity[0], self.opacity[self.opacity.len() - 1]);
        if first.1 > 0.0 {
            offer(f64::NEG_INFINITY, first.0, [true; 2]);
        }
        if last.1 > 0.0 {
            offer(last.0, f64::INFINITY, [true; 2]);
        }
        for pair in self.opacity.windows(2).filter(|pair| pair[0].1 > 0.0 || pair[1].1 > 0.0) {
            offer(pair[0].0, pair[1].0, [pair[0].1 > 0.0, pair[1].1 > 0.0]);
        }
        best
    }

    /// Pre-integration: on the way from one density to another, the share where something is seen first and last, and
    /// the optical depth of the first and of the second half between these, per length of the whole way.
    pub fn segment(&self, from: f64, to: f64, level_below: f64) -> ([f64; 2], [f64; 2]) {
        if (to - from).abs() < level_below {
            return ([0.0, 1.0], [0.5 * self.depth(0.5 * (from + to)); 2]);
        }
        let rises = to > from;
        let share = |density: Option<f64>, beyond: f64| {
            density.map_or(beyond, |density| ((density - from) / (to - from)).clamp(0.0, 1.0))
        };
        let first = share(self.visible_from(from, rises), 1.0);
        let last = share(self.visible_from(to, !rises), 0.0);
        let at = |share: f64| from + share * (to - from);
        let ends = [at(first), at(0.5 * (first + last)), to];
        // Nothing is visible before the first and after the last density.
        let between = |a: f64, b: f64| self.integral(a.min(b), a.max(b)) / (to - from).abs();
        ([first, last], [between(ends[0], ends[1]), between(ends[1], ends[2])])
    }
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn normalised(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 1e-12).then(|| a.map(|x| x / length))
}

/// The rows of the inverse of a matrix that is given by its columns.
fn inverse_rows([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, rows[0]);
    rows.map(|row| row.map(|x| x / determinant))
}

/// World gradient of a change per index step along x, y, z, with the columns of `world_from_index`.
pub fn world_gradient(columns: [[f64; 3]; 3], per_index: [f64; 3]) -> [f64; 3] {
    let rows = inverse_rows(columns);
    std::array::from_fn(|c| (0..3).map(|a| per_index[a] * rows[a][c]).sum())
}

/// Phong's coefficients, and directional lights.
pub struct Phong {
    pub ambient: f64,
    pub diffuse: f64,
    pub specular: f64,
    pub power: f64,
    /// Directions to the lights, and their colours.
    pub lights: Vec<([f64; 3], [f64; 3])>,
}

impl Phong {
    /// Colour after shading, two-sided, with the reflection vector; the ambient term alone where there is no gradient.
    pub fn shade(&self, rgb: [f64; 3], world_gradient: [f64; 3], to_eye: [f64; 3]) -> [f64; 3] {
        let normal = normalised(world_gradient);
        let mut shaded = rgb.map(|c| c * self.ambient);
        for (to_light, light) in &self.lights {
            let (Some(n), Some(l)) = (normal, normalised(*to_light)) else { continue };
            let n_l = dot(n, l);
            let reflected: [f64; 3] = std::array::from_fn(|c| 2.0 * n_l * n[c] - l[c]);
            let highlight = self.specular * dot(reflected, to_eye).max(0.0).powf(self.power);
            for c in 0..3 {
                shaded[c] += light[c] * (rgb[c] * self.diffuse * n_l.abs() + highlight);
            }
        }
        shaded
    }
}

/// The space between two sheets, as far as a ray draws it.
#[derive(Clone, Copy)]
pub struct Drawn {
    /// Positions at which it begins and ends.
    pub s: [f64; 2],
    /// Densities there.
    pub density: [f64; 2],
}

/// The parts of the spaces between sheets, at s = 0, 1, 2, ..., that a ray draws.
pub fn drawn(densities: &[f64], [lo, hi]: [f64; 2]) -> Vec<Drawn> {
    let parts = densities.windows(2).enumerate().map(|(k, pair)| {
        let s = [lo.max(k as f64), hi.min(k as f64 + 1.0)];
        Drawn { s, density: s.map(|s| pair[0] + (pair[1] - pair[0]) * (s - k as f64)) }
    });
    parts.filter(|part| part.s[0] < part.s[1]).collect()
}

/// Light gathered front to back: associated colour and opacity, and the position of opacity 1/2.
pub struct Light {
    pub rgba: [f64; 4],
    pub s_half: f64,
}

impl Light {
    pub fn none() -> Self {
        Self { rgba: [0.0; 4], s_half: f64::NAN }
    }

    /// Adds a fragment by Porter and Duff's *over*, front to back. Opacity grows evenly through the fragment.
    fn add(&mut self, rgb: [f64; 3], alpha: f64, [from, to]: [f64; 2]) {
        let before = self.rgba[3];
        for c in 0..3 {
            self.rgba[c] += (1.0 - before) * alpha * rgb[c];
        }
        self.rgba[3] += (1.0 - before) * alpha;
        if before < 0.5 && self.rgba[3] >= 0.5 {
            self.s_half = from + (to - from) * (0.5 - before) / (self.rgba[3] - before);
        }
    }
}

/// *Over* of sheets, each of which stands for the part of the ray that is nearer to it than to others.
pub fn over(curves: &Curves, densities: &[f64], [lo, hi]: [f64; 2], per_s: f64) -> Light {
    let mut light = Light::none();
    for (k, density) in densities.iter().enumerate() {
        let (from, to) = (lo.max(k as f64 - 0.5), hi.min(k as f64 + 0.5));
        if from < to {
            let alpha = -(-curves.depth(*density) * (to - from) * per_s).exp_m1();
            light.add(curves.color(*density), alpha, [from, to]);
        }
    }
    light
}

/// *Over* of the spaces between sheets, pre-integrated: the colour belongs to the mean place that the light comes from.
pub fn over_segments(curves: &Curves, densities: &[f64], interval: [f64; 2], per_s: f64, level_below: f64) -> Light {
    let mut light = Light::none();
    for Drawn { s: [from, to], density: [near, far] } in drawn(densities, interval) {
        let ([first, last], depths) = curves.segment(near, far, level_below);
        let (mut alpha, mut moment) = (0.0, 0.0);
        for (k, depth) in depths.into_iter().enumerate() {
            let depth = depth * (to - from) * per_s;
            let share = -(1.0 - alpha) * (-depth).exp_m1();
            moment += share * 0.5 * (k as f64 + 1.0 / (2.0 + 0.75 * depth));
            alpha += share;
        }
        if alpha <= 0.0 {
            continue;
        }
        let mean = moment / alpha;
        let rgb = curves.color(near + (far - near) * (first + mean * (last - first)));
        let begin = from + first * (to - from);
        light.add(rgb, alpha, [begin, begin + (last - first) * (to - from) * 2.0 * mean]);
    }
    light
}

/// A projection: the extreme or the integral along the ray, and the drawn length. `parts`: the drawn parts of spaces.
///
/// `level`, `white` and `attenuation`: what values are dimmed towards, what dims most, and how much per length.
pub fn project(
    operator: &str,
    parts: &[Drawn],
    per_s: f64,
    [level, white, attenuation]: [f64; 3],
    fade: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let length = parts.iter().map(|part| (part.s[1] - part.s[0]) * per_s).sum();
    let ends = || parts.iter().flat_map(|part| [0, 1].map(|end| (part.s[end], part.density[end])));
    let integral = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        parts.iter().map(|part| of(part.density[0], part.density[1]) * (part.s[1] - part.s[0]) * per_s).sum()
    };
    let dimmed = |(s, d): (f64, f64)| if d > level { level + (d - level) * fade(s) } else { d };
    // The part above 0 of a line from a to b: a triangle where it crosses 0.
    let above = |a: f64, b: f64| {
        let (a, b) = (a - level, b - level);
        if a.min(b) >= 0.0 {
            0.5 * (a + b)
        } else if a.max(b) <= 0.0 {
            0.0
        } else {
            0.5 * a.max(b) * (a.max(b) / (a - b).abs())
        }
    };
    let value = match operator {
        "maximum" => ends().map(|end| end.1).fold(f64::NEG_INFINITY, f64::max),
        "minimum" => ends().map(|end| end.1).fold(f64::INFINITY, f64::min),
        "depth-shaded maximum" => ends().map(dimmed).fold(f64::NEG_INFINITY, f64::max),
        "attenuated maximum" => {
            // The integral of the part between level and white, by the trapezia of many small steps.
            let bright = |d: f64| ((d - level) / (white - level)).clamp(0.0, 1.0);
            let (mut depth, mut largest) = (0.0, f64::NEG_INFINITY);
            for Drawn { s, density } in parts {
                let n = 20_000;
                let at = |k: i32| bright(density[0] + (density[1] - density[0]) * (f64::from(k) + 0.5) / f64::from(n));
                let mean = (0..n).map(at).sum::<f64>() / f64::from(n);
                let behind = depth + attenuation * mean * (s[1] - s[0]) * per_s;
                for (d, depth) in [(density[0], depth), (density[1], behind)] {
                    largest = largest.max(if d > level { level + (d - level) * f64::exp(-depth) } else { d });
                }
                depth = behind;
            }
            largest
        }
        "x-ray" => integral(&above),
        _ => integral(&|a, b| 0.5 * (a + b)),
    };
    [value, length]
}

/// The first local maximum of at least a threshold, else the largest density; and whether there was one.
pub fn local_maximum(parts: &[Drawn], threshold: f64) -> [f64; 2] {
    let mut highest = f64::NEG_INFINITY;
    for density in parts.iter().flat_map(|part| part.density) {
        // Densities that differ by rounding are a plateau.
        if highest >= threshold && density < highest - 1e-6 * highest.abs() {
            return [highest, 1.0];
        }
        highest = highest.max(density);
    }
    [highest, 0.0]
}

/// Position of the first crossing of a density within an interval; NaN where there is none.
pub fn first_hit(densities: &[f64], [lo, hi]: [f64; 2], iso: f64) -> f64 {
    let crossings = densities.windows(2).enumerate().filter_map(|(k, pair)| {
        let crosses = (pair[0] < iso) != (pair[1] < iso);
        crosses.then(|| k as f64 + (iso - pair[0]) / (pair[1] - pair[0]))
    });
    crossings.into_iter().find(|s| lo <= *s && *s <= hi).unwrap_or(f64::NAN)
}

/// A picture of `n_u` columns between its texels, by Keys' cubic, empty beyond, clamped to the nearest four texels, and
/// no brighter than its opacity times `peak`.
pub fn resampled(texels: &[[f64; 4]], n_u: usize, [u, v]: [f64; 2], peak: f64) -> [f64; 4] {
    let n_v = texels.len() / n_u;
    let (i, j) = (u.floor(), v.floor());
    let at = |x: f64, y: f64, c: usize| {
        let inside = x >= 0.0 && y >= 0.0 && x < n_u as f64 && y < n_v as f64;
        if inside { texels[y as usize * n_u + x as usize][c] } else { 0.0 }
    };
    let mut rgba: [f64; 4] = std::array::from_fn(|c| {
        let mut sum = 0.0;
        for y in -1..=2 {
            for x in -1..=2 {
                let (x, y) = (i + f64::from(x), j + f64::from(y));
                sum += kernel("catmull-rom", u - x) * kernel("catmull-rom", v - y) * at(x, y, c);
            }
        }
        let around = [at(i, j, c), at(i + 1.0, j, c), at(i, j + 1.0, c), at(i + 1.0, j + 1.0, c)];
        let (least, most) = around.iter().fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
        sum.clamp(least, most)
    });
    for c in 0..3 {
        rgba[c] = rgba[c].min(peak * rgba[3]);
    }
    rgba
}

/// Bounds of the density in each brick of `side` cells, `[z][y][x]`, of samples along an axis `n`.
pub fn brick_bounds(name: &str, samples: &[f64], [nx, ny, nz]: [usize; 3], side: usize) -> Vec<[f64; 2]> {
    let reached = |brick: usize, n: usize| {
        let [lo, hi] = [brick * side, ((brick + 1) * side).min(n - 1)];
        // Samples whose kernel is not 0 somewhere in the brick.
        (0..n).filter(move |&k| {
            let distance = if k < lo { lo - k } else { k.saturating_sub(hi) };
            distance == 0 || kernel(name, distance as f64 + 1e-3) != 0.0
        })
    };
    let n_bricks = |n: usize| (n - 1).div_ceil(side);
    let mut bounds = Vec::new();
    for bz in 0..n_bricks(nz) {
        for by in 0..n_bricks(ny) {
            for bx in 0..n_bricks(nx) {
                let mut own = [f64::INFINITY, f64::NEG_INFINITY];
                for z in reached(bz, nz) {
                    for y in reached(by, ny) {
                        for x in reached(bx, nx) {
                            let sample = samples[(z * ny + y) * nx + x];
                            own = [own[0].min(sample), own[1].max(sample)];
                        }
                    }
                }
                // Largest overshoot of Catmull-Rom on each side: weights sum to 5/4 in magnitude along each axis.
                let over = if name == "catmull-rom" { 0.5 * (1.25_f64.powi(3) - 1.0) * (own[1] - own[0]) } else { 0.0 };
                bounds.push([own[0] - over, own[1] + over]);
            }
        }
    }
    bounds
}
