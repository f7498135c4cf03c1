//! Every level gives the bits of plain arrays.

use std::collections::HashSet;

use super::*;

/// Every operation, on numbers with both signs, large and small.
struct Everything<'a> {
    a: &'a Lanes,
    b: &'a Lanes,
    index: &'a Lanes<u32>,
    table: &'a [Entry],
    row: &'a [f32],
    places: &'a [Places],
}

impl VectorKernel for Everything<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u32> {
        let (a, b) = (s.load(&self.a.0), s.load(&self.b.0));
        let [lt, le] = [s.lt(a, b), s.le(b, a)];
        let mut numbers = vec![
            s.splat(0.25),
            s.add(a, b),
            s.sub(a, b),
            s.mul(a, b),
            s.div(a, b),
            s.min(a, b),
            s.max(a, b),
            s.abs(a),
            s.select(lt, a, b),
            s.select(s.or(lt, le), a, b),
            s.select(s.and(lt, le), a, b),
            s.take(&self.a.0, self.index),
            s.exp2_neg(s.add(s.min(s.abs(a), s.splat(100.0)), s.splat(ROUND))),
            s.rsqrt(s.abs(b)),
            s.add_mul(a, a, b),
        ];
        for places in self.places {
            match places.nearness() {
                Nearness::Near => numbers.extend(s.gather::<3>(self.row, s.at(places))),
                Nearness::Far => numbers.extend(s.gather_far::<3>(self.row, s.at(places))),
                Nearness::Any => {}
            }
        }
        numbers.extend(s.look_up(self.table, a));
        numbers.extend(s.transpose_quads([a, b, s.add(a, b), s.mul(a, b)]));
        numbers.extend(s.interleave_quads(a, b));
        numbers.extend(s.deinterleave_quads(a, b));
        numbers.push(s.middle_quads(a, b));
        let mut rows: [Lanes; LANES] = std::array::from_fn(|r| Lanes(std::array::from_fn(|c| (16 * r + c) as f32)));
        s.transpose(&mut rows);
        assert!((0..LANES).all(|r| (0..LANES).all(|c| rows[c].0[r] == (16 * r + c) as f32)));
        let mut bits = vec![u32::from(s.bits(lt)), u32::from(s.bits(le))];
        for number in numbers {
            let mut out = [0.0; LANES];
            s.store(number, &mut out);
            bits.extend(out.map(f32::to_bits));
        }
        bits
    }
}

#[test]
fn every_level_gives_the_same_bits() {
    let number = |i: usize| (i as f32 * 12.9898).sin() * 10.0_f32.powi(i as i32 % 5 - 1);
    let table: Vec<Entry> = (0..40).map(|i| std::array::from_fn(|c| number(4 * i + c))).collect();
    let mut kinds = HashSet::new();
    for round in 0..200 {
        let a = Lanes(std::array::from_fn(|i| number(round * 31 + i)));
        let b = Lanes(std::array::from_fn(|i| if i == 3 { a.0[3] } else { number(round * 17 + 500 + i) }));
        let index = Lanes(std::array::from_fn(|i| (round + 7 * i) as u32));
        // Rising and falling, with steps below and above 1.
        let step = round as f32 * 0.03 - 3.0;
        let lowest = (step * (LANES - 1) as f32).min(0.0);
        let places =
            [0.0, 0.3, 0.9].map(|x| Places::new(Lanes(std::array::from_fn(|i| (x + step * i as f32 - lowest) as u32))));
        let row: Vec<f32> = (0..FAR_ROOM + 2).map(|i| number(round + 3 * i)).collect();
        kinds.extend(places.map(|places| places.nearness() as usize));
        for places in places.iter().filter(|places| places.nearness() != Nearness::Any) {
            let is_near = places.nearness() == Nearness::Near;
            let at = Plain.at(places);
            let taps = if is_near { Plain.gather::<3>(&row, at) } else { Plain.gather_far::<3>(&row, at) };
            for (t, tap) in taps.iter().enumerate() {
                assert_eq!(*tap, places.index().0.map(|i| row[t + i as usize]));
            }
        }
        let everything = || Everything { a: &a, b: &b, index: &index, table: &table, row: &row, places: &places };
        let plain = everything().run(Plain);
        for level in Level::all() {
            assert!(level.dispatch(everything()) == plain, "{level:?}");
        }
    }
    assert_eq!(kinds.len(), 3, "all kinds of places were tried");
}

#[test]
fn gathers_stay_inside_their_row() {
    struct Gather<'a>(&'a [f32], &'a Places);
    impl VectorKernel for Gather<'_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, s: S) {
            let at = s.at(self.1);
            let _ = if self.1.nearness() == Nearness::Near {
                s.gather::<2>(self.0, at)
            } else {
                s.gather_far::<2>(self.0, at)
            };
        }
    }
    let row = [0.0; FAR_ROOM + 1];
    for (step, n) in [(1, NEAR_ROOM + 1), (2, FAR_ROOM + 1)] {
        let places = Places::new(Lanes(std::array::from_fn(|i| step * i as u32)));
        for level in Level::all() {
            level.dispatch(Gather(&row[..n], &places));
            let short = || level.dispatch(Gather(&row[..n - 1], &places));
            // In WebAssembly a panic ends the program.
            assert!(cfg!(panic = "abort") || std::panic::catch_unwind(short).is_err(), "{level:?}");
        }
    }
}

/// Operations that compare and select, on NaN, infinities and zeros of both signs.
struct Choices<'a> {
    a: &'a Lanes,
    b: &'a Lanes,
    index: &'a Lanes<u32>,
    table: &'a [Entry],
}

impl VectorKernel for Choices<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u32> {
        let (a, b) = (s.load(&self.a.0), s.load(&self.b.0));
        let [lt, le] = [s.lt(a, b), s.le(a, b)];
        let mut numbers = vec![s.min(a, b), s.max(a, b), s.abs(a), s.select(lt, a, b), s.take(&self.a.0, self.index)];
        numbers.extend(s.look_up(self.table, a));
        let mut bits = vec![u32::from(s.bits(lt)), u32::from(s.bits(le))];
        for number in numbers {
            let mut out = [0.0; LANES];
            s.store(number, &mut out);
            bits.extend(out.map(f32::to_bits));
        }
        bits
    }
}

#[test]
fn every_level_treats_nan_infinity_and_zero_alike() {
    let table = [[1.0, -2.0, 0.5, 0.0], [2.0, 3.0, 0.5, -1.0], [4.0, 5.0, 0.25, 7.0]];
    let numbers = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, 1.0, -1e-40];
    let index = Lanes(std::array::from_fn(|i| 5 * i as u32));
    for shift in 0..numbers.len() {
        let a = Lanes(std::array::from_fn(|i| numbers[i % 8]));
        let b = Lanes(std::array::from_fn(|i| numbers[(i + shift) % 8]));
        let choices = || Choices { a: &a, b: &b, index: &index, table: &table };
        let plain = choices().run(Plain);
        let want = |choose: fn(f32, f32) -> bool| {
            std::array::from_fn::<u32, LANES, _>(|i| if choose(a.0[i], b.0[i]) { a.0[i] } else { b.0[i] }.to_bits())
        };
        assert_eq!(plain[2..18], want(|a, b| a < b), "the smaller, or b");
        assert_eq!(plain[18..34], want(|a, b| a > b), "the larger, or b");
        for level in Level::all() {
            assert!(level.dispatch(choices()) == plain, "{level:?}");
        }
    }
}

#[test]
fn reciprocal_square_roots_are_precise() {
    let kernel = |a: f32| Plain.rsqrt([a; LANES])[0];
    for i in 0..4000 {
        let a = 1e-12_f32 * 1.02_f32.powi(i % 3000);
        let want = 1.0 / f64::from(a).sqrt();
        assert!((f64::from(kernel(a)) - want).abs() < 1e-6 * want, "{a}");
    }
}

#[test]
fn rows_of_quads_become_columns_and_go_by_turns() {
    let rows: [[f32; LANES]; 4] = std::array::from_fn(|r| std::array::from_fn(|i| (16 * r + i) as f32));
    for (q, column) in Plain.transpose_quads(rows).iter().enumerate() {
        for (r, quad) in column.chunks(4).enumerate() {
            assert_eq!(quad, &rows[r][4 * q..][..4]);
        }
    }
    let [a, b, ..] = rows;
    for (k, quad) in Plain.interleave_quads(a, b).as_flattened().chunks(4).enumerate() {
        assert_eq!(quad, &rows[k % 2][4 * (k / 2)..][..4]);
    }
    let [first, second] = Plain.interleave_quads(a, b);
    assert_eq!(Plain.deinterleave_quads(first, second), [a, b]);
    assert_eq!(
        Plain.middle_quads(a, b).as_chunks().0,
        &[&a[4..12], &b[4..12]].map(|x| <[f32; 8]>::try_from(x).unwrap())
    );
}

#[test]
fn rows_are_read_where_they_are() {
    let numbers: Vec<f32> = (0..100).map(|i| i as f32).collect();
    let rows = Rows::new(&numbers, 20);
    for first in 0..25 {
        for (r, row) in Plain.load_rows(&rows, first).iter().enumerate() {
            assert_eq!(row, &numbers[first + 20 * r..][..LANES]);
        }
    }
    for (rows, first) in [(rows, 25), (Rows::new(&numbers, 29), 0), (Rows::new(&numbers, usize::MAX / 2), 0)] {
        assert!(cfg!(panic = "abort") || std::panic::catch_unwind(|| Plain.load_rows(&rows, first)).is_err());
    }
}

#[test]
fn look_up_is_linear_and_stays_inside() {
    let table: Vec<Entry> = (0..10).map(|i| [i as f32, -(i as f32), 0.5, 2.0 * i as f32]).collect();
    let positions = [-5.0, 0.0, 0.25, 3.5, 7.75, 8.0, 9.0, 1e9, f32::NAN, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let [x, negative, constant, double] = Plain.look_up(&table, positions);
    for i in 0..LANES {
        let want = if positions[i] > 0.0 { positions[i].min(8.0) } else { 0.0 };
        assert_eq!([x[i], negative[i], constant[i], double[i]], [want, -want, 0.5, 2.0 * want]);
    }
}
