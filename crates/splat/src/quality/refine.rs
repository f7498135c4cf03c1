//! Which parts of a picture are drawn once more, and how finely.
//!
//! The error of a picture is where its contrast is: parts have about as much of the one as of the other, if contrast is
//! the squares of the Laplacian of the colours.

use wavesplat_core::Picture;

use crate::quality::error_model::{ErrorModel, Settings};
use crate::quality::parts::contrasts;

/// Parts that are drawn once more.
pub struct NextPass {
    pub settings: Settings,
    /// Of all parts of the picture, row by row.
    pub is_wanted: Vec<bool>,
}

/// How a part was drawn, and its share of the mean square error of the picture.
#[derive(Clone, Copy)]
struct Part {
    pass: usize,
    error: f64,
    /// The error of the first picture, by what was measured of it, and by what changed since.
    first_error: [f64; 2],
    idx: usize,
}

/// The error of a picture, part by part.
pub struct Refinement {
    experience: ErrorModel,
    /// Of each pass.
    settings: Vec<Settings>,
    /// Those that show something.
    parts: Vec<Part>,
    /// Of all, those that show nothing yet.
    is_unseen: Vec<bool>,
}

/// A part that shows something has this share of the mean error at least.
const FLAT: f64 = 0.03;

/// The work of some parts: what is done for a picture whatever is drawn of it, and the factor by which texels
/// are more than those of the parts, since the filter reads those around them, too.
const FIXED_SHARE: f64 = 0.2;
const AROUND: f64 = 1.2;

/// By how much what was measured is believed rather than what was expected.
const TRUST: f64 = 0.8;

impl Refinement {
    /// Of a picture that was drawn with some settings.
    pub fn new(experience: ErrorModel, first: Settings, picture: &Picture) -> Self {
        let contrasts = contrasts(picture);
        let seen = contrasts.iter().enumerate().filter(|(_, contrast)| **contrast > 0.0);
        let mut parts: Vec<Part> =
            seen.map(|(idx, error)| Part { pass: 0, error: *error, first_error: [0.0; 2], idx }).collect();
        let sum: f64 = parts.iter().map(|part| part.error).sum();
        let floor = FLAT * sum / parts.len().max(1) as f64;
        let scale = experience.error(&first) / (sum + floor * parts.len() as f64);
        for part in &mut parts {
            part.error = (part.error + floor) * scale;
            part.first_error = [part.error; 2];
        }
        let is_unseen = contrasts.iter().map(|contrast| *contrast == 0.0).collect();
        Self { experience, settings: vec![first], parts, is_unseen }
    }

    /// The mean square error of the picture.
    pub fn error(&self) -> f64 {
        self.parts.iter().map(|part| part.error).sum()
    }

    /// The factor by which errors are larger than was measured of the first picture, by what changed since.
    pub fn truer(&self) -> f64 {
        let [measured, truer] = [0, 1].map(|k| self.parts.iter().map(|part| part.first_error[k]).sum::<f64>());
        // A picture of one colour has no parts that could change.
        if measured > 0.0 { truer / measured } else { 1.0 }
    }

    /// The share of what is seen that is drawn once more.
    pub fn share(&self, next: &NextPass) -> f64 {
        let n_drawn = self.parts.iter().filter(|part| next.is_wanted[part.idx]).count();
        n_drawn as f64 / self.parts.len().max(1) as f64
    }

    /// The factors by which other settings make errors smaller, for each pass.
    fn factors(&self, other: &Settings) -> Vec<f64> {
        let error = self.experience.error(other);
        let of_pass = |pass: &Settings| {
            let is_finer = other.sheets_per_slice >= pass.sheets_per_slice && other.oversampling >= pass.oversampling;
            if is_finer { error / self.experience.error(pass) } else { 1.0 }
        };
        self.settings.iter().map(of_pass).collect()
    }

    /// What is cheapest of what promises an error of the picture, if it can be with something to spare. Where nothing
    /// does, what promises nearly the least; `None` where that is hardly less than now.
    pub fn cheapest(&mut self, error: f64, spare: f64) -> Option<NextPass> {
        self.parts.sort_by(|a, b| b.error.total_cmp(&a.error).then(a.idx.cmp(&b.idx)));
        let now = self.error();
        let all: Vec<(Settings, Vec<f64>)> = self
            .experience
            .settings_from(self.settings[0])
            .map(|settings| (settings, self.factors(&settings)))
            .collect();
        let all_with = |factors: &[f64]| self.parts.iter().map(|part| part.error * factors[part.pass]).sum::<f64>();
        let best = all.iter().map(|(_, factors)| all_with(factors)).fold(f64::INFINITY, f64::min);
        let error = if best <= error { (error * spare).max(0.5 * (best + error)) } else { best / spare };
        if error >= now {
            return None;
        }
        let mut cheapest: Option<(f64, Settings, usize)> = None;
        for (settings, factors) in &all {
            let mut left = now;
            let enough = self.parts.iter().position(|part| {
                left -= part.error * (1.0 - factors[part.pass]);
                left <= error
            });
            let Some(last) = enough else { continue };
            let n = last + 1;
            let share = (AROUND * n as f64 / self.parts.len() as f64).min(1.0);
            let cost = self.experience.cost(settings) * (FIXED_SHARE + (1.0 - FIXED_SHARE) * share);
            if cheapest.is_none_or(|(least, ..)| cost < least) {
                cheapest = Some((cost, *settings, n));
            }
        }
        let (_, settings, n) = cheapest?;
        // Where nothing was seen, something fine may lie between the texels; where there is nothing, it costs nothing.
        let mut is_wanted = self.is_unseen.clone();
        let factors = self.factors(&settings);
        for part in self.parts[..n].iter().filter(|part| factors[part.pass] < 1.0) {
            is_wanted[part.idx] = true;
        }
        Some(NextPass { settings, is_wanted })
    }

    /// Parts were drawn once more. `changes`: how much of the picture changed in each part, mean square.
    pub fn drawn(&mut self, next: &NextPass, changes: &[f64]) {
        let factors = self.factors(&next.settings);
        let drawn: Vec<&Part> = self.parts.iter().filter(|part| next.is_wanted[part.idx]).collect();
        let change = |pass: &Settings| self.experience.change(pass, &next.settings) / self.experience.error(pass);
        let expected: Vec<f64> = self.settings.iter().map(change).collect();
        let truer = |parts: &[&Part]| {
            let change: f64 = parts.iter().map(|part| changes[part.idx]).sum();
            let expected: f64 = parts.iter().map(|part| part.error * expected[part.pass]).sum();
            (change / expected).clamp(0.05, 20.0).powf(TRUST)
        };
        let of_drawn = truer(&drawn);
        // Those that are left are like those with the least contrast of them.
        let of_others = truer(&drawn[drawn.len() / 2..]);
        self.settings.push(next.settings);
        self.is_unseen.fill(false);
        for part in &mut self.parts {
            let is_drawn = next.is_wanted[part.idx];
            let truer = if is_drawn { of_drawn } else { of_others };
            part.error *= truer;
            part.first_error[1] *= truer;
            if is_drawn {
                part.error *= factors[part.pass];
                part.pass = self.settings.len() - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::error_model::mean_square_of;
    use crate::quality::probe::Errors;
    use crate::source::slices::Slices;
    use glam::DVec3;
    use wavesplat_core::{Kernel, Projection, RenderOptions};
    use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

    const FIRST: Settings = Settings { sheets_per_slice: 1.0, oversampling: 0.5 };

    /// Of five parts in a row, with the contrast of stripes of these heights; the last shows nothing.
    fn refinement(heights: [f32; 3]) -> Refinement {
        let color = |x: usize| heights.get(x / 16).map_or(0.0, |height| 0.5 + height * (x % 2) as f32);
        let rgba = (0..80 * 16).map(|k| [color(k % 80), 0.0, 0.0, if k % 80 < 48 { 1.0 } else { 0.0 }]).collect();
        let picture = Picture { width_px: 80, height_px: 16, rgba, depth: None, value: None };
        let phantom = Phantom::ripples(8);
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let hard = opacity_ramp(&[(127.0, 0.0), (128.0, 1.0)], None);
        let projection = Projection::Orthographic { parallel_scale: 6.0 };
        let camera = camera_towards(phantom.centre(), DVec3::X, 20.0, projection);
        let options = RenderOptions { width_px: 80, height_px: 16, ..RenderOptions::default() };
        let errors = Errors { along: 5e-4, across: 5e-4, across_decay: 0.4 };
        let usual = ErrorModel::usual(&slices, &hard, &camera, &options);
        Refinement::new(usual.after(errors, FIRST), FIRST, &picture)
    }

    #[test]
    fn parts_of_much_contrast_are_drawn_first_and_as_many_as_needed() {
        let mut all = refinement([0.02, 0.4, 0.1]);
        let first = all.experience.error(&FIRST);
        assert!((all.error() - first).abs() < 1e-12, "the error is that of the first picture");
        assert!(first > 5e-4 && first < 1e-3, "what is along and what is across the rays are not quite the same");
        let next = all.cheapest(5e-4, 1.0).unwrap();
        assert_eq!(next.is_wanted, [false, true, false, false, true], "and what shows nothing yet");
        let next = all.cheapest(1e-5, 1.0).unwrap();
        assert!(next.is_wanted[1] && next.is_wanted[2]);
        assert!(next.settings.sheets_per_slice > 2.0 && next.settings.oversampling > 1.0);
        assert!(all.share(&next) > 0.6);
    }

    #[test]
    fn what_changes_tells_what_is_left() {
        let left_after = |times: f64| {
            let mut all = refinement([0.1, 0.4, 0.1]);
            let next = all.cheapest(5e-4, 1.0).unwrap();
            assert_eq!(next.is_wanted, [false, true, false, false, true]);
            let change = times * all.experience.change(&FIRST, &next.settings) * all.parts[0].error / all.error();
            let changes: Vec<f64> = next.is_wanted.iter().map(|drawn| if *drawn { change } else { 0.0 }).collect();
            all.drawn(&next, &changes);
            [all.error(), all.truer()]
        };
        let [less, expected, more] = [0.5, 1.0, 2.0].map(left_after);
        assert!(expected[0] <= 5e-4, "as promised");
        for (k, expected) in expected.into_iter().enumerate() {
            assert!(less[k] < 0.7 * expected && more[k] > 1.5 * expected, "{less:?} {expected} {more:?}");
        }
        assert!((expected[1] - 1.0).abs() < 1e-9, "{expected:?}");
    }

    #[test]
    fn without_parts_nothing_is_truer_than_what_was_measured() {
        assert_eq!(Refinement { parts: Vec::new(), ..refinement([0.1; 3]) }.truer(), 1.0);
    }

    #[test]
    fn what_is_out_of_reach_is_drawn_with_nearly_the_finest_and_then_it_ends() {
        let mut all = refinement([0.3, 0.4, 0.1]);
        let next = all.cheapest(mean_square_of(80.0), 0.8).unwrap();
        let before = all.error();
        let changes: Vec<f64> = vec![before / 3.0; 5];
        all.drawn(&next, &changes);
        assert!(all.error() < 0.1 * before);
        // Until there is less to gain than what is spared, and no longer.
        let mut n_passes = 1;
        while let Some(next) = all.cheapest(mean_square_of(80.0), 0.8) {
            let before = all.error();
            let change = |pass: &Settings| all.experience.change(pass, &next.settings);
            let expected = all.settings.iter().map(change).fold(0.0, f64::max);
            let changes = vec![expected * before / all.experience.error(&FIRST) / 3.0; 5];
            all.drawn(&next, &changes);
            assert!(all.error() < 0.9 * before, "{} {before}", all.error());
            n_passes += 1;
        }
        assert!(n_passes <= 3, "{n_passes}");
    }
}
