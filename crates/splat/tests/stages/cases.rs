//! The fixtures: small inputs of each stage, with the answers of the formulas.

use crate::fixture::{Case, Fixture};
use crate::formulas::{self, Curves, Phong};
use crate::ray_cases;

/// All stages, in the order in which a frame runs them.
pub fn fixtures() -> Vec<Fixture> {
    vec![
        footprint(),
        slice_taps(),
        bricks(),
        sheet(),
        look_up(),
        classify(),
        opacity(),
        preintegrate(),
        shade(),
        ray_cases::over(),
        ray_cases::project(),
        ray_cases::first_hit(),
        ray_cases::local_maximum(),
        resample(),
    ]
}

pub const FORMULAS: &str =
    "formulas in f64 (crates/splat/tests/stages/formulas.rs), which call nothing of the renderer";

/// Usual tolerance of other backends, relative and absolute; the absolute part is f32's rounding of sums of numbers of
/// about 1.
pub const TOLERANCE: [f64; 2] = [1e-5, 2e-6];

const KERNELS: [&str; 5] = ["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"];

/// Source of numbers without a visible pattern, `0..1`, of few digits.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 54) as f64 / 1024.0
    }

    pub fn many(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

fn footprint() -> Fixture {
    const N: usize = 12;
    const N_POSITIONS: usize = 32;
    let mut cases = Vec::new();
    for kernel in KERNELS {
        // Through both faces; inside, where there is a fast way; backwards; with differences of parts of a sample.
        for (offset, origin, step) in [(1.0, -1.25, 0.5), (2.0, 3.0, 0.125), (1.0, 9.5, -0.25), (0.5, 0.25, 0.3125)] {
            let last = (N - 1) as f64;
            let at = |i: usize| (origin + step * i as f64).clamp(0.0, last);
            let positions = || (0..N_POSITIONS).map(at);
            let n_taps = formulas::n_taps(kernel);
            let weights = positions().flat_map(|x| {
                let first = formulas::first_tap(kernel, x);
                (0..n_taps).map(move |t| formulas::weight(kernel, x, first + t as f64))
            });
            let case = Case::new(format!("{kernel}, differences of {offset}, {origin} + {step} i"))
                .with_text("kernel", kernel)
                .with("n_samples", N as f64)
                .with("n_positions", N_POSITIONS as f64)
                .with("origin", origin)
                .with("step", step)
                .with("offset", offset)
                .answer("first", positions().map(|x| formulas::first_tap(kernel, x)))
                .answer("weights", weights)
                .answer("difference", positions().flat_map(|x| formulas::difference(kernel, x, offset, N)));
            cases.push(case);
        }
    }
    Fixture {
        stage: "footprint",
        what: "Footprints of an axis of n_samples at the positions origin + step i, which stop at the first and the last \
               sample: first, the first sample of each, before folding; weights[i][tap]; difference[i][sample], \
               (V(x + offset) - V(x - offset)) / (2 offset) as weights of all samples, folded.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &["first"],
        cases,
    }
}

fn slice_taps() -> Fixture {
    const N: usize = 9;
    let positions = [0.0, 0.375, 1.0, 2.5, 3.75, 7.25, 7.875, 8.0];
    let case = |(kernel, offset): (&str, f64)| {
        let of = |weights: &dyn Fn(f64) -> Vec<f64>| positions.iter().flat_map(|x| weights(*x)).collect::<Vec<_>>();
        Case::new(format!("{kernel}, differences of {offset}"))
            .with_text("kernel", kernel)
            .with("n_samples", N as f64)
            .with("offset", offset)
            .with_array("w", positions)
            .answer("weights", of(&|x| formulas::weights(kernel, x, N)))
            .answer("difference", of(&|x| formulas::difference(kernel, x, offset, N)))
    };
    Fixture {
        stage: "slice_taps",
        what: "Weights[i][slice] of all slices for a sheet at w[i], folded at the faces, and of the derivative through it.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &[],
        cases: KERNELS.into_iter().flat_map(|kernel| [(kernel, 1.0), (kernel, 0.75)]).map(case).collect(),
    }
}

fn bricks() -> Fixture {
    let size @ [nx, ny, nz] = [11, 8, 9];
    let mut random = Random(3);
    let mut cases = Vec::new();
    for (kernel, side) in KERNELS.into_iter().flat_map(|kernel| [(kernel, 2), (kernel, 4)]) {
        // Few bright samples, so that it matters which of them a brick reaches.
        let samples: Vec<f64> =
            random.many(nx * ny * nz).iter().map(|x| if *x > 0.96 { 255.0 } else { (x * 100.0).floor() }).collect();
        let bounds = formulas::brick_bounds(kernel, &samples, size, side);
        // Bounds may be rounded outwards by a few of 4096 levels.
        let is_clear = |threshold: f64| bounds.iter().all(|[_, hi]| (hi - threshold).abs() > 0.3);
        let threshold = (0..1000).map(|k| 130.5 + 0.25 * f64::from(k)).find(|t| is_clear(*t)).expect("a threshold");
        let case = Case::new(format!("{kernel}, {side} cells"))
            .with_text("kernel", kernel)
            .with("side", side as f64)
            .with("threshold", threshold)
            .with_array("size", size.map(|n| n as f64))
            .with_array("samples", samples)
            .answer("occupied", bounds.iter().map(|[_, hi]| if *hi > threshold { 1.0 } else { 0.0 }));
        cases.push(case);
    }
    Fixture {
        stage: "bricks",
        what: "occupied[z][y][x] of bricks of side cells along each axis, of samples[z][y][x] (of B-splines: \
               coefficients), size along x, y, z: 1 where a density above threshold can be reconstructed.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &["occupied"],
        cases,
    }
}

fn sheet() -> Fixture {
    let size @ [nx, ny, nz] = [7, 6, 5];
    let mut random = Random(11);
    let mut cases = Vec::new();
    for kernel in KERNELS {
        // Slices across z, and across x; sheets between slices, near a face, on a slice.
        let places = [([0_usize, 1, 2], 1.625, 1.0), ([1, 2, 0], 0.25, 0.5), ([0, 1, 2], 3.0, 1.0)];
        for (axes, w, offset) in places.into_iter().take(if kernel == "catmull-rom" { 3 } else { 2 }) {
            let coefficients = random.many(nx * ny * nz);
            let samples: Vec<f64> = if kernel.starts_with("bspline") {
                let at = |i: usize, n: usize| formulas::weights(kernel, i as f64, n);
                let sum = |i: usize| {
                    let [x, y, z] = [i % nx, i / nx % ny, i / (nx * ny)];
                    formulas::sum3([&at(x, nx), &at(y, ny), &at(z, nz)], &coefficients)
                };
                (0..nx * ny * nz).map(sum).collect()
            } else {
                coefficients.clone()
            };
            let (u, v) = ([-0.25, 0.4375], [4.75, -0.625]);
            let n = axes.map(|a| size[a]);
            let sum = |i: usize, differs: Option<usize>| {
                let at = [u[0] + u[1] * (i % 16) as f64, v[0] + v[1] * (i / 16) as f64, w];
                let along = [0, 1, 2].map(|k| {
                    if differs == Some(k) {
                        formulas::difference(kernel, at[k], offset, n[k])
                    } else {
                        formulas::weights(kernel, at[k], n[k])
                    }
                });
                // Weights along x, y, z, from those along u, v, w.
                let [x, y, z] = [0, 1, 2].map(|a| &along[axes.iter().position(|b| *b == a).expect("an axis")][..]);
                formulas::sum3([x, y, z], &coefficients)
            };
            let all = |differs| (0..64).map(|i| sum(i, differs)).collect::<Vec<_>>();
            let case = Case::new(format!("{kernel}, slices across {}, w = {w}", ["x", "y", "z"][axes[2]]))
                .with_text("kernel", kernel)
                .with_array("size", size.map(|n| n as f64))
                .with_array("axes", axes.map(|a| a as f64))
                .with("offset", offset)
                .with_array("u", u)
                .with_array("v", v)
                .with("w", w)
                .with_array("samples", samples)
                .with_array("coefficients", coefficients.iter().copied())
                .answer("density", all(None))
                .answer("gradient_u", all(Some(0)))
                .answer("gradient_v", all(Some(1)))
                .answer("gradient_w", all(Some(2)));
            cases.push(case);
        }
    }
    Fixture {
        stage: "sheet",
        what: "Densities[j][i] and their derivatives along the axes u, v, w, per index step, of 16 x 4 texels of a sheet at \
               w: texel (i, j) lies at u[0] + u[1] i, v[0] + v[1] j. samples[z][y][x] of size along x, y, z; axes, which \
               of x, y, z are u, v, w; offset, half the distance of differences; coefficients, what the kernel weighs: of \
               B-splines those that interpolate the samples.",
        made_from: FORMULAS,
        // Samples of B-splines are rounded to f32, and their prefilter magnifies that up to 27 times.
        tolerance: [1e-5, 8e-6],
        exact: &[],
        cases,
    }
}

fn look_up() -> Fixture {
    let mut random = Random(5);
    let mut table: Vec<[f64; 4]> = (0..9).map(|_| [0; 4].map(|_| random.next())).collect();
    // One entry more, for interpolation at the very end of the last cell.
    table.push(table[8]);
    let positions = [-3.0, 0.0, 0.25, 0.5, 1.0, 1.75, 2.125, 3.0, 3.875, 4.5, 5.0, 6.625, 7.5, 7.9375, 8.0, 1000.0];
    let at = |position: f64, c: usize| {
        let position = position.clamp(0.0, 8.0);
        let cell = (position as usize).min(7);
        let share = position - cell as f64;
        table[cell][c] * (1.0 - share) + table[cell + 1][c] * share
    };
    let channel = |c: usize| positions.map(|position| at(position, c));
    let case = Case::new("nine entries")
        .with_array("table", table.as_flattened().iter().copied())
        .with_array("position", positions)
        .answer("r", channel(0))
        .answer("g", channel(1))
        .answer("b", channel(2))
        .answer("depth", channel(3));
    Fixture {
        stage: "look_up",
        what: "A table[entry][r, g, b, optical depth], its last entry twice, read between its entries; positions stop at \
               its ends.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &[],
        cases: vec![case],
    }
}

/// Transfer functions whose nodes are entries of the tables that are made of them.
pub fn curves() -> [(&'static str, Curves); 2] {
    let color = vec![(0.0, [1.0, 0.5, 0.0]), (128.0, [0.25, 0.75, 0.5]), (256.0, [0.0, 0.5, 1.0])];
    let hill = vec![(0.0, 0.0), (32.0, 0.0), (96.0, 0.5), (128.0, 0.25), (192.0, 0.0), (256.0, 0.0)];
    let two = vec![(0.0, 0.25), (32.0, 0.0), (112.0, 0.0), (144.0, 0.625), (256.0, 0.625)];
    [("a hill", Curves { opacity: hill, color: color.clone() }), ("two parts", Curves { opacity: two, color })]
}

pub fn with_curves(case: Case, Curves { opacity, color }: &Curves) -> Case {
    case.with_array("opacity_nodes", opacity.iter().flat_map(|(value, opacity)| [*value, *opacity]))
        .with_array("color_nodes", color.iter().flat_map(|(value, [r, g, b])| [*value, *r, *g, *b]))
}

/// Densities between which tables are made: 2048 entries from the first node to the last, 1/8 apart.
const RANGE: [f64; 2] = [0.0, 256.0];
pub const ENTRY: f64 = 0.125;

fn classify() -> Fixture {
    let densities: Vec<f64> = (0..64).map(|i| -40.0 + 5.3125 * f64::from(i)).collect();
    let case = |(name, curves): (&str, Curves)| {
        let channel = |c: usize| densities.iter().map(|d| curves.color(*d)[c]).collect::<Vec<_>>();
        with_curves(Case::new(name), &curves)
            .with_array("range", RANGE)
            .with_array("density", densities.iter().copied())
            .answer("r", channel(0))
            .answer("g", channel(1))
            .answer("b", channel(2))
            .answer("depth", densities.iter().map(|d| curves.depth(*d)))
    };
    Fixture {
        stage: "classify",
        what: "Colour and optical depth per unit of length of densities, by a transfer function: opacity_nodes (value, \
               opacity per unit) and color_nodes (value, r, g, b), linear in between, constant beyond. The depth is \
               -ln(1 - opacity). range: of densities, for the tables.",
        made_from: FORMULAS,
        // Between the entries of a table the depth is linear.
        tolerance: [1e-5, 1e-5],
        exact: &[],
        cases: curves().into_iter().map(case).collect(),
    }
}

fn opacity() -> Fixture {
    let lengths: Vec<f64> =
        (0..48).map(|i| (1.0 + f64::from(i % 3) * 0.375) * f64::exp2(f64::from(i / 3) - 12.0)).collect();
    let lengths =
        || lengths.iter().copied().chain([0.0, 1e-6, 25.0, 80.0, 90.0, 126.0, 1e9, 1e30].map(|x| f64::from(x as f32)));
    let case =
        Case::new("thin to opaque").with_array("x", lengths()).answer("opacity", lengths().map(|x| -(-x).exp_m1()));
    Fixture {
        stage: "opacity",
        what: "1 - exp(-x) for an optical depth x: the opacity of a slab.",
        made_from: FORMULAS,
        tolerance: [1e-5, 0.0],
        exact: &[],
        cases: vec![case],
    }
}

fn preintegrate() -> Fixture {
    let ends = [
        (0.0, 256.0),
        (256.0, 0.0),
        (40.0, 72.0),
        (72.0, 40.0),
        (16.0, 48.0),
        (48.0, 16.0),
        (100.0, 164.0),
        (176.0, 248.0),
        (150.0, 150.0),
        (60.0, 60.007_812_5),
        (24.0, 200.0),
        (-64.0, 48.0),
        (300.0, 130.0),
        (120.0, 152.0),
        (8.0, 128.0),
        (136.0, 20.0),
    ];
    let case = |(name, curves): (&str, Curves)| {
        let segments = ends.map(|(from, to)| curves.segment(from, to, 0.25 * ENTRY));
        with_curves(Case::new(name), &curves)
            .with_array("range", RANGE)
            .with("slab_thickness", 0.5)
            .with_array("from", ends.map(|end| end.0))
            .with_array("to", ends.map(|end| end.1))
            .answer("first", segments.map(|([first, _], _)| first))
            .answer("last", segments.map(|([_, last], _)| last))
            .answer("depth_first_half", segments.map(|(_, [depth, _])| depth))
            .answer("depth_second_half", segments.map(|(_, [_, depth])| depth))
    };
    Fixture {
        stage: "preintegrate",
        what: "Rays on which the density goes evenly from one number to another: the share of the way where something is \
               seen first and last, and the optical depth of the first and of the second half of what lies between, per \
               length of the whole way. Where both densities are the same, as good as, all of the way is seen. The \
               transfer function is as in classify; slab_thickness, of a usual slab, is for the tables.",
        made_from: FORMULAS,
        // Differences of an integral in f32 that reaches 75.
        tolerance: [1e-5, 2e-5],
        exact: &[],
        cases: curves().into_iter().map(case).collect(),
    }
}

/// Name, directions and colours of lights, index to world, and which axes are u, v, w.
type LitCase<'a> = (&'a str, (&'a [[f64; 3]], &'a [[f64; 3]]), [[f64; 3]; 3], [usize; 3]);

fn shade() -> Fixture {
    let mut random = Random(23);
    let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let aslant = [[0.5, 0.125, 0.0], [-0.25, 1.25, 0.125], [0.0, 0.25, 2.0]];
    let eye = [[0.0, 0.0, -1.0]];
    let two = [[2.0, 1.0, -2.0], [-1.0, 0.5, 0.25]];
    let lights: [LitCase; 4] = [
        ("a white light at the eye", (&eye, &[[1.0; 3]]), straight, [0, 1, 2]),
        ("a white light at the eye, samples aslant", (&eye, &[[1.0; 3]]), aslant, [0, 1, 2]),
        ("a white light", (&two[..1], &[[1.0; 3]]), aslant, [1, 2, 0]),
        ("two lights with colours", (&two, &[[1.0, 0.5, 0.25], [0.25, 0.5, 1.0]]), aslant, [0, 2, 1]),
    ];
    let mut cases = Vec::new();
    for (name, (directions, colors), matrix, axes) in lights {
        let phong = Phong {
            ambient: 0.125,
            diffuse: 0.625,
            specular: 0.25,
            power: if name.starts_with("two") { 2.5 } else { 10.0 },
            lights: directions.iter().copied().zip(colors.iter().copied()).collect(),
        };
        let at_eye = directions.len() == 1 && directions[0] == eye[0];
        let mut texels: Vec<([f64; 3], [f64; 3], [f64; 3])> = Vec::new();
        for i in 0..16 {
            let rgb = [0; 3].map(|_| random.next());
            let gradient = [0; 3].map(|_| random.next() - 0.5);
            // A gradient of 0, and one that is mere rounding.
            let gradient = if i < 2 { gradient.map(|g| g * [0.0, 1e-9][i]) } else { gradient };
            let towards = [random.next() - 0.5, random.next() - 0.5, -0.5 - random.next()];
            let length = formulas::dot(towards, towards).sqrt();
            let to_eye = if at_eye { eye[0] } else { towards.map(|x| f64::from((x / length) as f32)) };
            texels.push((rgb, gradient.map(|g| f64::from(g as f32)), to_eye));
        }
        let shaded = |(rgb, gradient, to_eye): &([f64; 3], [f64; 3], [f64; 3])| {
            let mut per_index = [0.0; 3];
            (0..3).for_each(|k| per_index[axes[k]] = gradient[k]);
            let is_noise = formulas::dot(*gradient, *gradient) < 1e-12;
            let gradient = formulas::world_gradient(matrix, per_index);
            phong.shade(*rgb, if is_noise { [0.0; 3] } else { gradient }, *to_eye)
        };
        let answers: Vec<[f64; 3]> = texels.iter().map(shaded).collect();
        let case = Case::new(name)
            .with_array("world_from_index", matrix.as_flattened().iter().copied())
            .with_array("axes", axes.map(|a| a as f64))
            .with("ambient", phong.ambient)
            .with("diffuse", phong.diffuse)
            .with("specular", phong.specular)
            .with("power", phong.power)
            .with_array("to_lights", directions.as_flattened().iter().copied())
            .with_array("light_colors", colors.as_flattened().iter().copied())
            .with_array("rgb", texels.iter().flat_map(|texel| texel.0))
            .with_array("gradient", texels.iter().flat_map(|texel| texel.1))
            .with_array("to_eye", texels.iter().flat_map(|texel| texel.2))
            .answer("shaded", answers.into_iter().flatten());
        cases.push(case);
    }
    Fixture {
        stage: "shade",
        what: "Phong shading, two-sided, of rgb[i][3] with gradients[i][3] along the axes u, v, w per index step: axes, \
               which of x, y, z these are; world_from_index, its three columns. to_eye[i][3], unit world vectors; \
               to_lights[light][3], world vectors; light_colors[light][3]. Densities are up to 1: a gradient below 4e-6 of \
               that is none.",
        made_from: FORMULAS,
        // Powers magnify the rounding of reciprocal square roots.
        tolerance: [1e-5, 1e-5],
        exact: &[],
        cases,
    }
}

fn resample() -> Fixture {
    let (n_u, n_v) = (9, 7);
    let mut random = Random(71);
    let case = |(name, peak): (&str, f64)| {
        let texels: Vec<[f64; 4]> = (0..n_u * n_v)
            .map(|_| {
                let opacity = random.next();
                let mut channel = || f64::from((opacity * random.next()) as f32);
                [channel(), channel(), channel(), opacity]
            })
            .collect();
        let positions: Vec<[f64; 2]> = (0..32)
            .map(|i| match i {
                0 => [3.0, 2.0],
                1 => [0.0, 6.0],
                2 => [-0.75, 3.25],
                3 => [8.5, 6.75],
                4 => [-5.0, 3.0],
                _ => [random.next() * 11.0 - 1.0, random.next() * 9.0 - 1.0].map(|x| f64::from(x as f32)),
            })
            .collect();
        let read = positions.iter().flat_map(|at| formulas::resampled(&texels, n_u, *at, peak)).collect::<Vec<_>>();
        Case::new(name)
            .with_array("size", [n_u as f64, n_v as f64])
            .with("peak", peak)
            .with_array("texels", texels.as_flattened().iter().copied())
            .with_array("u", positions.iter().map(|at| at[0]))
            .with_array("v", positions.iter().map(|at| at[1]))
            .answer("rgba", read)
    };
    Fixture {
        stage: "resample",
        what: "What the warp reads of a base plane of associated texels[v][u][4], size along u and v, between its texels: \
               rgba[i][4] at the texel positions u[i], v[i]. By the cubic of Catmull and Rom, empty beyond, held between \
               the nearest four texels, colours at most peak times the opacity.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &[],
        cases: [("colours up to 1", 1.0), ("colours up to 1/2", 0.5)].into_iter().map(case).collect(),
    }
}
