//! Segmentations of documents: numbers of samples and their looks.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::{Value, json};
use wavesplat_core::{Error, Grid, Kernel, LabelLook, Volume};
use wavesplat_look::colors::label_color;
use wavesplat_splat::optics::labels::{Codes, Labels};

use crate::document_values::{DocumentResult, made, not_drawn, straight_color};

/// Largest number of labels: data with more values is a scan.
const MAX_LABELS: usize = 65_535;
/// Memory budget for decoded fields, bytes.
const BUDGET_BYTES: usize = 512 << 20;
/// Opacity of a label that says nothing of it.
const USUAL_OPACITY: f64 = 0.8;

/// The labels that fields describe, of a segmentation on the samples of the scan.
pub(crate) fn labels_of(fields: &Value, segmentation: &Volume<'_>, scan: &Grid) -> DocumentResult<Arc<Labels>> {
    let grid = segmentation.grid();
    if grid.size() != scan.size() || grid.world_from_index() != scan.world_from_index() {
        return Err(not_drawn("labels.volume", "a segmentation on other samples than those of the first layer"));
    }
    let refused = |what: &'static str, found: String, allowed: &'static str, mend: &'static str| {
        Err(made("labels", Error::out_of_range(what, found, allowed, mend)))
    };
    let samples = segmentation.samples();
    let n = grid.size().iter().product();
    let mut numbers = BTreeSet::new();
    for value in (0..n).map(|k| samples.get(k)) {
        if value.fract() != 0.0 {
            return refused(
                "sample of the segmentation",
                value.to_string(),
                "a whole number",
                "labels are 0, 1, 2, ...",
            );
        }
        numbers.insert(value as i64);
        if numbers.len() > MAX_LABELS {
            let found = format!("more than {MAX_LABELS}");
            return refused("different numbers of the segmentation", found, "fewer", "it looks like a scan");
        }
    }
    let mut looks: BTreeMap<i64, LabelLook> = BTreeMap::new();
    if let Value::Object(given) = &fields["labels"] {
        for (name, fields) in given {
            let number = name.parse().unwrap_or(i64::MIN);
            if !numbers.contains(&number) {
                return refused("label", name.clone(), "a number that occurs", "leave out its look");
            }
            looks.insert(number, look_of_label(fields, number)?);
        }
    } else {
        let shown = (0..).zip(numbers.iter().filter(|number| **number != 0));
        let usual = |place| LabelLook { rgb: label_color(place), opacity: USUAL_OPACITY, scan: 0.0, tint: 0.0 };
        looks.extend(shown.map(|(place, number)| (*number, usual(place))));
    }
    let codes: BTreeMap<i64, u16> = numbers.iter().copied().zip(0..).collect();
    let code = |k: usize| codes.get(&(samples.get(k) as i64)).copied().unwrap_or_default();
    let codes = if numbers.len() <= 256 {
        Codes::U8((0..n).map(|k| code(k).to_le_bytes()[0]).collect())
    } else {
        Codes::U16((0..n).map(code).collect())
    };
    let looks = numbers.iter().map(|number| looks.get(number).copied().unwrap_or(LabelLook::NONE)).collect();
    let kernel = if fields["smooth"] == json!(false) { Kernel::Linear } else { Kernel::Gaussian };
    Labels::new(codes, looks, scan, kernel, BUDGET_BYTES).map(Arc::new).map_err(|error| made("labels", error))
}

fn look_of_label(fields: &Value, number: i64) -> DocumentResult<LabelLook> {
    let place = format!("labels[{number}].color");
    let color = straight_color(&fields["color"], &place)?;
    let [r, g, b, _] = color.ok_or_else(|| {
        let error = Error::out_of_range("colour of a label", &fields["color"], "a colour", "set its opacity to 0");
        made(&place, error)
    })?;
    let number = |name: &str, other: f64| fields[name].as_f64().unwrap_or(other);
    let opacity = number("opacity", USUAL_OPACITY);
    let scan = number("scan", if opacity > 0.0 { 0.0 } else { 1.0 });
    Ok(LabelLook { rgb: [r, g, b], opacity, scan, tint: number("tint", 0.0) })
}
