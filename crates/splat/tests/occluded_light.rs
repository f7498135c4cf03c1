//! Shadows and ambient occlusion: which places are dark is known from the geometry.

use glam::DVec3;
use wavesplat_core::{Camera, Kernel, Light, LightFrame, Picture, Projection, RenderOptions, Shading};
use wavesplat_splat::render;
use wavesplat_splat::source::slices::Slices;
use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

fn fine(shading: Shading) -> RenderOptions {
    RenderOptions { sheets_per_slice: 8.0, oversampling: 3.0, shading: Some(shading), ..RenderOptions::default() }
}

/// A plate above a floor, in the light of the first light only.
fn plate() -> Phantom {
    Phantom::sample([30, 30, 24], glam::DAffine3::IDENTITY, |p| {
        let plate = (16.0..19.0).contains(&p.z) && (10.0..20.0).contains(&p.x) && (10.0..20.0).contains(&p.y);
        if plate || p.z < 4.0 { 200.0 } else { 0.0 }
    })
}

#[test]
fn shadows_fall_where_the_light_does_not_get() {
    let phantom = plate();
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(90.0, 0.0), (110.0, 0.95)], None);
    // From above; the light comes from the side, so the shadow lies beside the plate.
    let camera = Camera::new(
        DVec3::new(14.5, 14.5, 60.0),
        DVec3::new(14.5, 14.5, 12.0),
        DVec3::Y,
        Projection::Orthographic { parallel_scale: 15.0 },
    )
    .unwrap();
    let light = Light { frame: LightFrame::World, to_light: DVec3::new(0.7, 0.0, 1.0), rgb: [1.0; 3] };
    let draw = |shadow: f32| {
        let shading = Shading { lights: vec![light], shadow, ..Shading::headlight() };
        let options = RenderOptions { width_px: 30, height_px: 30, ..fine(shading) };
        render(&Slices::new(&volume, Kernel::Linear), &tf, &camera, &options, &()).unwrap().0
    };
    let (lit, shadowed) = (draw(0.0), draw(1.0));
    // Pixel x is index x. The plate's shadow is moved by about 0.7 * 13 towards lower x.
    let share = |x: usize| shadowed.rgba[15 * 30 + x][1] / lit.rgba[15 * 30 + x][1];
    assert!(share(6) < 0.4, "in the shadow: {}", share(6));
    assert!(share(15) > 0.9, "on the plate: {}", share(15));
    assert!(share(25) > 0.9, "on the floor in the light: {}", share(25));
}

#[test]
fn ambient_occlusion_darkens_hollows_more_than_faces() {
    let phantom = Phantom::sample([32, 32, 20], glam::DAffine3::IDENTITY, |p| {
        let in_shaft = (p.x - 8.0).abs() < 2.5 && (p.y - 16.0).abs() < 2.5 && p.z > 3.0;
        if p.z < 14.0 && !in_shaft { 200.0 } else { 0.0 }
    });
    let volume = phantom.volume();
    let tf = opacity_ramp(&[(90.0, 0.0), (110.0, 0.95)], None);
    let camera = camera_towards(phantom.centre(), DVec3::Z, 60.0, Projection::Orthographic { parallel_scale: 16.0 });
    let draw = |ambient_occlusion: f32, shading: Shading| {
        let shading = Shading { ambient_occlusion, occlusion_radius: Some(8.0), ..shading };
        let options = RenderOptions { width_px: 32, height_px: 32, ..fine(shading) };
        render(&Slices::new(&volume, Kernel::Linear), &tf, &camera, &options, &()).unwrap().0
    };
    let (open, closed) = (draw(0.0, Shading::headlight()), draw(1.0, Shading::headlight()));
    let brightness = |picture: &Picture, in_shaft: bool| {
        let pixels = picture.rgba.iter().enumerate().filter(|(i, _)| {
            let (x, y) = (i % 32, i / 32);
            let inside = (14..18).contains(&y) && ((6..10).contains(&x) || (22..26).contains(&x));
            let face = (14..18).contains(&y) && (14..18).contains(&x);
            if in_shaft { inside } else { face }
        });
        pixels.map(|(_, p)| f64::from(p[1])).fold(f64::INFINITY, f64::min)
    };
    let face = brightness(&closed, false) / brightness(&open, false);
    let shaft = brightness(&closed, true) / brightness(&open, true);
    assert!(face > 0.8, "{face}");
    assert!(shaft < 0.6 * face, "{shaft} and {face}");
}
