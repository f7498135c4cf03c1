//! Square parts of a picture, of which some are wanted.

use glam::DVec2;
use wavesplat_compute::parallel;
use wavesplat_core::Picture;

/// Pixels of a part along each side; those at the right and at the bottom may be smaller.
pub const PART_PX: usize = 16;

/// Which parts of a picture are wanted.
#[derive(Clone, Debug)]
pub struct Parts {
    n: [usize; 2],
    /// Row by row.
    is_wanted: Vec<bool>,
}

impl Parts {
    /// `is_wanted`: of all parts of a picture, row by row.
    pub fn new(size_px: [usize; 2], is_wanted: Vec<bool>) -> Self {
        let n = n_parts(size_px);
        debug_assert_eq!(is_wanted.len(), n[0] * n[1]);
        Self { n, is_wanted }
    }

    /// Whether any is that lies between two pixel positions.
    pub fn any_between(&self, lo: DVec2, hi: DVec2) -> bool {
        let part = |position: f64, axis: usize| {
            let part = (position / PART_PX as f64).floor();
            part.clamp(-1.0, self.n[axis] as f64)
        };
        // Those beyond the picture are none.
        let from = [part(lo.x, 0).max(0.0) as usize, part(lo.y, 1).max(0.0) as usize];
        let to = [part(hi.x, 0) + 1.0, part(hi.y, 1) + 1.0];
        let to = [(to[0] as usize).min(self.n[0]), (to[1] as usize).min(self.n[1])];
        from[0] < to[0] && (from[1]..to[1]).any(|y| self.is_wanted[y * self.n[0]..][from[0]..to[0]].contains(&true))
    }

    /// Whether the part is in which a pixel is.
    pub fn is_wanted(&self, x: usize, y: usize) -> bool {
        self.is_wanted[y / PART_PX * self.n[0] + x / PART_PX]
    }
}

/// Parts along x and along y.
pub fn n_parts(size_px: [usize; 2]) -> [usize; 2] {
    size_px.map(|n| n.div_ceil(PART_PX))
}

/// Of each part, row by row, the sum over its pixels of the squares of the colours' Laplacians.
pub fn contrasts(picture: &Picture) -> Vec<f64> {
    let (width, height) = (picture.width_px, picture.height_px);
    let [n_x, n_y] = n_parts([width, height]);
    // Colours of a row, with the outermost once more beyond its ends.
    let fill = |row: &mut [[f32; 4]], y: usize| {
        let pixels = &picture.rgba[y * width..][..width];
        let seen = |[r, g, b, _]: [f32; 4]| [r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0), 0.0];
        for (own, rgba) in row[1..].iter_mut().zip(pixels) {
            *own = seen(*rgba);
        }
        (row[0], row[width + 1]) = (row[1], row[width]);
    };
    let of_band = |band: usize| {
        let rows = band * PART_PX..((band + 1) * PART_PX).min(height);
        let mut sums = vec![[0.0_f32; 4]; n_x];
        let mut above = vec![[0.0; 4]; width + 2];
        let (mut own, mut below) = (above.clone(), above.clone());
        fill(&mut above, rows.start.saturating_sub(1));
        fill(&mut own, rows.start);
        for y in rows {
            fill(&mut below, (y + 1).min(height - 1));
            for (part, sum) in sums.iter_mut().enumerate() {
                let columns = part * PART_PX + 1..((part + 1) * PART_PX).min(width) + 1;
                for x in columns {
                    for c in 0..4 {
                        let around = own[x - 1][c] + own[x + 1][c] + (above[x][c] + below[x][c]);
                        sum[c] += (around - 4.0 * own[x][c]).powi(2);
                    }
                }
            }
            std::mem::swap(&mut above, &mut own);
            std::mem::swap(&mut own, &mut below);
        }
        sums.iter().map(|[r, g, b, _]| f64::from(r + g + b)).collect::<Vec<_>>()
    };
    parallel::map(n_y, of_band).concat()
}

/// Puts the parts of another picture that are wanted in the place of a picture's own. Returns how much the colours
/// change by each, mean square over the whole picture, peak 1.
pub fn replace(picture: &mut Picture, other: &Picture, parts: &Parts) -> Vec<f64> {
    let width = picture.width_px;
    let per_pixel = 1.0 / picture.rgba.len() as f64;
    let mut changes = vec![0.0; parts.is_wanted.len()];
    for k in 0..picture.height_px * parts.n[0] {
        let (y, x) = (k / parts.n[0], k % parts.n[0] * PART_PX);
        if !parts.is_wanted(x, y) {
            continue;
        }
        let pixels = y * width + x..y * width + (x + PART_PX).min(width);
        let (own, other_rgba) = (&mut picture.rgba[pixels.clone()], &other.rgba[pixels.clone()]);
        let change: f32 = own.iter().zip(other_rgba).map(|(a, b)| difference(a, b)).sum();
        changes[y / PART_PX * parts.n[0] + x / PART_PX] += per_pixel * f64::from(change);
        own.copy_from_slice(other_rgba);
        for (own, other) in [(&mut picture.depth, &other.depth), (&mut picture.value, &other.value)] {
            if let (Some(own), Some(other)) = (own, other) {
                own[pixels.clone()].copy_from_slice(&other[pixels.clone()]);
            }
        }
    }
    changes
}

/// The mean square difference of two colours over black.
pub fn difference(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    (0..3).map(|c| (a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum::<f32>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [40, 33];

    fn picture(color: impl Fn(usize, usize) -> f32) -> Picture {
        let rgba = (0..SIZE[0] * SIZE[1]).map(|k| [color(k % SIZE[0], k / SIZE[0]), 0.0, 0.0, 1.0]).collect();
        Picture { width_px: SIZE[0], height_px: SIZE[1], rgba, depth: None, value: None }
    }

    fn only(wanted: usize) -> Parts {
        let [n_x, n_y] = n_parts(SIZE);
        Parts::new(SIZE, (0..n_x * n_y).map(|k| k == wanted).collect())
    }

    #[test]
    fn a_part_is_where_its_pixels_are() {
        assert_eq!(n_parts(SIZE), [3, 3]);
        let parts = only(5);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                assert_eq!(parts.is_wanted(x, y), x >= 32 && (16..32).contains(&y));
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                assert_eq!(parts.any_between(at, at), parts.is_wanted(x, y));
            }
        }
        let any = |lo: [f64; 2], hi: [f64; 2]| parts.any_between(DVec2::from_array(lo), DVec2::from_array(hi));
        assert!(any([-1e9, -1e9], [1e9, 1e9]) && any([20.0, 10.0], [32.5, 16.5]));
        assert!(
            !any([20.0, 10.0], [31.5, 16.5]) && !any([-9.0, -9.0], [-1.0, -1.0]) && !any([60.0, 20.0], [70.0, 22.0])
        );
    }

    #[test]
    fn contrast_is_the_laplacian_of_what_is_seen() {
        assert!(contrasts(&picture(|x, _| 0.001 * x as f32))[4] < 1e-9, "a ramp");
        let dot = contrasts(&picture(|x, y| if [x, y] == [20, 31] { 0.5 } else { 0.0 }));
        // The pixel itself and three neighbours; the fourth is in the part below.
        let want = 0.25 * f64::from(16 + 3);
        for (k, contrast) in dot.into_iter().enumerate() {
            let want = [0.0, want, 0.25][usize::from(k == 4) + 2 * usize::from(k == 7)];
            assert!((contrast - want).abs() < 1e-6, "{k}: {contrast}");
        }
        let glare = contrasts(&picture(|x, _| 1.0 + x as f32));
        assert!(glare.iter().all(|contrast| *contrast == 0.0), "brighter than white is white");
    }

    #[test]
    fn only_what_is_wanted_is_replaced() {
        let (mut own, other) = (picture(|_, _| 0.25), picture(|_, _| 0.75));
        (own.value, own.depth) = (Some(vec![0.0; own.rgba.len()]), None);
        let other = Picture { value: Some(vec![1.0; other.rgba.len()]), ..other };
        let parts = only(8);
        let changes = replace(&mut own, &other, &parts);
        // A corner of eight pixels and one row.
        let change = 8.0 * 0.25 / 3.0 / own.rgba.len() as f64;
        assert!(changes[..8].iter().all(|change| *change == 0.0) && (changes[8] / change - 1.0).abs() < 1e-6);
        for (k, rgba) in own.rgba.iter().enumerate() {
            let is_wanted = parts.is_wanted(k % SIZE[0], k / SIZE[0]);
            assert_eq!(rgba[0], if is_wanted { 0.75 } else { 0.25 });
            assert_eq!(own.value.as_ref().unwrap()[k], f32::from(is_wanted));
        }
    }
}
