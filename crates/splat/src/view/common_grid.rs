//! The index space that the layers of a picture share: rays, sheets and texels are counted in it.
//!
//! Its axes are the first layer's, its spacing along each the finest that any layer has, and its box holds all
//! of them. One volume alone has its own grid. Each layer lies in it by a shift and a scale along every axis, so that
//! it is reconstructed on the same sheets, by footprints of its own.

use glam::DVec3;
use wavesplat_core::{Error, Grid, Result, Statistics};

/// Map from the common grid to a layer's samples, for x, y and z: the layer's index position at position 0 of the
/// common grid, and its change per step of the common grid.
pub type IndexMap = [(f64, f64); 3];

/// The identity map: the layer lies as the common grid does.
pub const IDENTITY_MAP: IndexMap = [(0.0, 1.0); 3];

/// The grid that layers share, and the map from it to each layer.
#[derive(Clone, Debug)]
pub struct CommonGrid {
    /// The common grid; its statistics are placeholders, not the statistics of a volume.
    pub grid: Grid,
    /// Maps to the layers, in their order.
    pub layers: Vec<IndexMap>,
}

/// Largest deviation of an axis from the first layer's, as a fraction of its step, that counts as parallel.
const PARALLEL: f64 = 1e-6;

/// Tolerance within which steps and shifts are rounded to whole numbers: affines in files are rounded to f32.
const WHOLE: f64 = 1e-6;

/// Largest number of steps of the common grid along an axis.
const MAX_STEPS: f64 = 1e6;

impl CommonGrid {
    /// The common grid of the layers' grids.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] where axes are not parallel to the first layer's, or the layers are too far apart.
    pub fn new(grids: &[&Grid]) -> Result<Self> {
        let first = grids[0];
        let is_same = |grid: &&Grid| (grid.size(), grid.world_from_index()) == (first.size(), first.world_from_index());
        if grids.iter().all(is_same) {
            return Ok(Self { grid: first.clone(), layers: vec![IDENTITY_MAP; grids.len()] });
        }
        let mut placed = Vec::new();
        for (k, grid) in grids.iter().enumerate() {
            let Some(place) = place_in(first, grid) else {
                let what = format!("axes of layer {}", k + 1);
                let mend = "resample the layer onto axes of the first one";
                return Err(Error::out_of_range(what, "oblique to the first layer's", "parallel to these", mend));
            };
            placed.push(place);
        }
        let mut step = DVec3::ONE;
        let [mut lo, mut hi] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for ((origin, steps), grid) in placed.iter().zip(grids) {
            step = step.min(steps.abs());
            for end in grid.bounds() {
                lo = lo.min(*origin + *steps * end);
                hi = hi.max(*origin + *steps * end);
            }
        }
        // Samples of the first layer lie on its sheets where it is the finest.
        let n_before = ((-lo / step) - WHOLE).ceil();
        let n_steps = ((hi / step) - WHOLE).ceil() + n_before;
        if n_steps.max_element() > MAX_STEPS {
            let mend = "check where the layers lie, and in which units";
            return Err(Error::out_of_range(
                "place of the layers",
                "far apart",
                "together within a million samples",
                mend,
            ));
        }
        let origin = -n_before * step;
        let mut world_from_index = first.world_from_index();
        world_from_index.translation = world_from_index.transform_point3(origin);
        for a in 0..3 {
            *world_from_index.matrix3.col_mut(a) *= step[a];
        }
        let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let size = (n_steps + DVec3::ONE).max(DVec3::splat(2.0)).to_array().map(|n| n as usize);
        let grid = Grid::new("the layers", size, world_from_index, statistics, true)?;
        let bounds = [(lo - origin) / step, (hi - origin) / step];
        let grid = grid.as_level_of(first.default_opacity_unit(), bounds);
        let map = |(shift, steps): &(DVec3, DVec3)| {
            [0, 1, 2].map(|a| ((origin[a] - shift[a]) / steps[a], step[a] / steps[a]))
        };
        Ok(Self { grid, layers: placed.iter().map(map).collect() })
    }
}

/// Position of a grid's first sample, and its steps, in index positions of another grid; `None` where axes are oblique.
fn place_in(other: &Grid, grid: &Grid) -> Option<(DVec3, DVec3)> {
    let own = other.index_from_world() * grid.world_from_index();
    let [x, y, z] = [own.matrix3.x_axis, own.matrix3.y_axis, own.matrix3.z_axis];
    let steps = DVec3::new(x.x, y.y, z.z);
    let aside = [DVec3::new(0.0, x.y, x.z), DVec3::new(y.x, 0.0, y.z), DVec3::new(z.x, z.y, 0.0)];
    let is_parallel = (0..3).all(|a| aside[a].length() <= PARALLEL * steps[a].abs());
    is_parallel.then(|| (own.translation.map(whole), steps.map(|step| whole(step.abs()) * step.signum())))
}

/// Map from the common grid to a field that colours a layer; the layer's own map where both have the same grid.
///
/// # Errors
///
/// [`Error::OutOfRange`] where the field's axes are not parallel to the common grid's, or the layer reaches further
/// than one sample of the field beyond it.
pub fn map_of_color(common: &Grid, (layer, of_layer): (&Grid, &IndexMap), field: &Grid) -> Result<IndexMap> {
    if (field.size(), field.world_from_index()) == (layer.size(), layer.world_from_index()) {
        return Ok(*of_layer);
    }
    let Some((origin, steps)) = place_in(common, field) else {
        let (what, mend) = ("axes of the field that colours a layer", "resample the field onto the layer's samples");
        return Err(Error::out_of_range(what, "oblique to the layer's", "parallel to these", mend));
    };
    let map: IndexMap = [0, 1, 2].map(|a| (-origin[a] / steps[a], 1.0 / steps[a]));
    let [lo, hi] = field.bounds();
    let reach = DVec3::splat(1.0 + WHOLE);
    let covers = |end: DVec3| {
        let end = to_layer(&map, from_layer(of_layer, end));
        end.cmpge(lo - reach).all() && end.cmple(hi + reach).all()
    };
    if !layer.bounds().into_iter().all(covers) {
        let mend = "crop the layer to where the field is, or give a field that covers it";
        return Err(Error::out_of_range("extent of the field that colours a layer", "a part of it", "all of it", mend));
    }
    Ok(map)
}

/// `x`, rounded where it is within [`WHOLE`] of a whole number.
fn whole(x: f64) -> f64 {
    if (x - x.round()).abs() <= WHOLE { x.round() } else { x }
}

/// A position of the common grid as one of a layer's samples.
pub fn to_layer(map: &IndexMap, position: DVec3) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|a| map[a].0 + map[a].1 * position[a]))
}

/// A position among a layer's samples as one of the common grid.
pub fn from_layer(map: &IndexMap, position: DVec3) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|a| (position[a] - map[a].0) / map[a].1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;

    fn grid(size: [usize; 3], spacing: DVec3, origin: DVec3) -> Grid {
        let affine = DAffine3 { translation: origin, ..DAffine3::from_scale(spacing) };
        Grid::new("test", size, affine, Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 }, true).unwrap()
    }

    #[test]
    fn one_volume_has_its_own_grid() {
        let own = grid([5, 6, 7], DVec3::new(1.0, 2.0, 3.0), DVec3::splat(0.3));
        let common = CommonGrid::new(&[&own, &own]).unwrap();
        assert_eq!((common.grid, common.layers), (own, vec![IDENTITY_MAP; 2]));
    }

    #[test]
    fn layers_lie_where_they_lie_in_the_world() {
        let first = grid([10, 10, 10], DVec3::splat(2.0), DVec3::ZERO);
        let other = grid([9, 30, 4], DVec3::new(4.0, 1.0, -3.0), DVec3::new(-5.0, 1.5, 20.0));
        let common = CommonGrid::new(&[&first, &other]).unwrap();
        for (grid, map) in [&first, &other].into_iter().zip(&common.layers) {
            for corner in grid.bounds() {
                let world = grid.world_from_index().transform_point3(corner);
                let at = common.grid.index_from_world().transform_point3(world);
                assert!((to_layer(map, at) - corner).length() < 1e-9 && (from_layer(map, corner) - at).length() < 1e-9);
                let [lo, hi] = common.grid.bounds();
                assert!(at.cmpge(lo - 1e-9).all() && at.cmple(hi + 1e-9).all());
            }
        }
        let spacing = common.grid.spacing();
        assert!((spacing - DVec3::new(2.0, 1.0, 2.0)).length() < 1e-12);
        // The first layer's samples lie on sheets.
        assert!(from_layer(&common.layers[0], DVec3::splat(3.0)).z.fract().abs() < 1e-12);
    }

    #[test]
    fn oblique_layers_are_refused() {
        let first = grid([10, 10, 10], DVec3::ONE, DVec3::ZERO);
        let turned = Grid::new(
            "turned",
            [10, 10, 10],
            DAffine3::from_rotation_z(0.1),
            Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 },
            true,
        );
        assert!(CommonGrid::new(&[&first, &turned.unwrap()]).is_err());
        let far = grid([10, 10, 10], DVec3::ONE, DVec3::splat(1e9));
        assert!(CommonGrid::new(&[&first, &far]).is_err());
    }
}
