//! Sources of the samples of a frame: its layers, and after them the fields that colour layers, in the order of these.

use crate::render::plan::{ColorPlan, Plan};
use crate::render::tile::TileJob;
use crate::source::geometry::SheetGeometry;
use crate::view::common_grid::IndexMap;

impl Plan {
    /// Map from index positions of the frame to the samples of a source.
    pub(super) fn map_of_source(&self, source: usize) -> IndexMap {
        match self.color_of_source(source) {
            Some((_, color)) => color.map,
            None => self.layers[source].map,
        }
    }

    /// The layer that is drawn from a source: itself, or the one that a field colours.
    pub(super) fn layer_of_source(&self, source: usize) -> usize {
        self.color_of_source(source).map_or(source, |(layer, _)| layer)
    }

    fn color_of_source(&self, source: usize) -> Option<(usize, &ColorPlan)> {
        let number = source.checked_sub(self.layers.len())?;
        let mut colors = self.layers.iter().enumerate().filter_map(|(k, layer)| Some((k, layer.color.as_ref()?)));
        colors.nth(number)
    }
}

impl<'a> TileJob<'a> {
    /// Geometry of the sheets over the samples of a source.
    pub fn source(&self, source: usize) -> &SheetGeometry<'a> {
        match source.checked_sub(self.layers.len()) {
            None => &self.layers[source].geometry,
            Some(color) => &self.fields[self.n_plain_fields + color],
        }
    }
}
