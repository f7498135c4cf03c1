//! Captured dispatches for a browser's WebGPU to draw, with the CPU's texels beside them. Where `WAVESPLAT_CAPTURES`
//! names a folder they are written there, for `web/browser/gpu.test.ts`.

mod scenes;

use std::fmt::Write;

use scenes::{Case, Stored};
use serde_json::{Value, json};
use wavesplat_core::{Composite, Kernel, RenderOptions, Shading};
use wavesplat_gpu::capture::{Capture, capture};
use wavesplat_splat::render::frame::{draw_base_planes, slices_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::{ColorField, Layer};

fn cases() -> Vec<Case> {
    let hard = vec![(120.0, 0.0), (122.0, 0.95)];
    let in_shadow = Shading { ambient_occlusion: 0.7, shadow: 0.6, ..Shading::default() };
    vec![
        Case::default(),
        Case {
            name: "hard, cubic, 16 bits",
            opacity: hard.clone(),
            stored: Stored::U16,
            kernel: Kernel::Bspline3,
            ..Case::default()
        },
        Case { name: "holes", stored: Stored::F32WithHoles, ..Case::default() },
        Case { name: "occlusion and shadow", shading: Some(in_shadow), ..Case::default() },
        Case { name: "two layers, hard", n_layers: 2, opacity: hard, ..Case::default() },
        Case { name: "isosurface", composite: Composite::FirstHit { iso_value: 90.0 }, ..Case::default() },
        Case { name: "maximum", composite: Composite::Maximum, ..Case::default() },
    ]
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn document(name: &str, captured: &Capture, texels: &[[f32; 4]]) -> Value {
    let textures: Vec<Value> = captured
        .textures
        .iter()
        .map(|t| json!({"binding": t.binding, "format": t.format, "size": t.size, "bytes": hex(&t.bytes)}))
        .collect();
    json!({
        "name": name,
        "shader": captured.shader,
        "buffers": captured.buffers.iter().map(|bytes| hex(bytes)).collect::<Vec<_>>(),
        "state_bytes": captured.n_state_bytes,
        "groups": captured.groups,
        "textures": textures,
        // Texels of the CPU, in the order of the state.
        "texels": texels.as_flattened(),
    })
}

#[test]
fn a_dispatch_has_what_a_browser_needs() {
    for (k, case) in cases().iter().enumerate() {
        case.with_plan(&mut |plan, layers| {
            let slices = slices_of(layers);
            let captured = capture(plan, &slices).unwrap();
            let (pictures, _) = draw_base_planes(plan, &slices, &()).unwrap();
            let [n_u, n_v] = pictures[0].plane.size;
            let rows: Vec<&[[f32; 4]]> = (0..n_v).map(|j| pictures[0].row(j)).collect();
            let texel = |i: usize, j: usize| if i < n_u && j < n_v { rows[j][i] } else { [0.0; 4] };
            let texels: Vec<[f32; 4]> = captured
                .blocks
                .iter()
                .flat_map(|[i, j]| (0..128).map(move |k| (i + k % 16, j + k / 16)))
                .map(|(i, j)| texel(i, j))
                .collect();
            // Colour and opacity, and, where cut faces have even light, the entry of the ray.
            let per_ray = if case.composite == Composite::Over { 32 } else { 16 };
            assert_eq!(captured.n_state_bytes, per_ray * texels.len(), "{}", case.name);
            assert!(texels.iter().filter(|texel| texel[3] > 0.05).count() > 300, "{}", case.name);
            for texture in &captured.textures {
                let n_bytes = match texture.format {
                    "r8unorm" => 1,
                    "rg8unorm" => 2,
                    "rgba32float" => 16,
                    _ => 4,
                };
                assert_eq!(texture.bytes.len(), n_bytes * texture.size.iter().product::<usize>());
            }
            if let Some(folder) = std::env::var_os("WAVESPLAT_CAPTURES") {
                std::fs::create_dir_all(&folder).unwrap();
                let path = std::path::Path::new(&folder).join(format!("{k}.json"));
                std::fs::write(path, document(case.name, &captured, &texels).to_string()).unwrap();
            }
        });
    }
}

/// No shader has the colours of a second field: such plans are left to the CPU, with the reason that reports have.
#[test]
fn layers_that_another_field_colours_are_left_to_the_cpu() {
    Case::default().with_plan(&mut |plan, layers| {
        let Layer { slices, transfer_function, cache, .. } = layers[0];
        let colored = [Layer { color: Some(ColorField { slices, transfer_function, cache }), ..layers[0] }];
        let options = RenderOptions { width_px: plan.size_px[0], height_px: plan.size_px[1], ..Default::default() };
        let plan = Plan::new(plan.simd, &colored, &plan.camera, &options).unwrap();
        let refused = capture(&plan, &slices_of(&colored)).err().unwrap();
        assert_eq!(refused.to_string(), "layers that another field colours are drawn by the CPU");
    });
}
