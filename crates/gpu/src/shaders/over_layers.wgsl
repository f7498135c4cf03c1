// Compositing of several layers: at a point of space extinctions add, and colours mix by extinction. Twin of
// crates/splat/src/ray/over_layers.rs. The functions of a layer are in `layer.wgsl`, once per layer.

const MIN_DEPTH: f32 = 1e-20f;
const MAX_DEPTH: f32 = 1e30f;

// Sum over layers of extinction times colour, and of extinction, with one more medium.
fn with_medium(sum: vec4<f32>, rgb: vec3<f32>, depth: f32) -> vec4<f32> {
    let own = min(depth, MAX_DEPTH);
    return sum + vec4<f32>(rgb * own, own);
}

// Colour and opacity of a sum over layers.
fn mixed(sum: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(sum.xyz / max(sum.w, MIN_DEPTH), one_minus_exp_neg(sum.w));
}

// Sums over layers in the space between two sheets, for its front half `near` and its back half `far`; and colour,
// opacity and extent of the last visible layer, which is composited by itself where it is the only one.
struct Mixture {
    near: vec4<f32>,
    far: vec4<f32>,
    only: vec4<f32>,
    only_extent: f32,
    n: u32,
}

fn mix3(a: vec3<f32>, b: vec3<f32>, share: f32) -> vec3<f32> {
    return a + (b - a) * share;
}

// Composites a sheet. `ends`: the layers that end at it, else the layers that go on behind it.
fn add_sheets(ray: Ray, block: u32, sheet: u32, ends: bool, begin: f32, end: f32) {
    var sum = vec4<f32>(0.0f);
    var any = false;
    ADD_SHEETS
    if any {
        let part = extent(ray.interval, begin, end);
        let color = mixed(sum);
        add_fragment(color.xyz, color.w, part.x, part.y);
    }
}

// Composites the space between two sheets.
fn add_slabs(ray: Ray, block: u32, slab: u32) {
    var mixture: Mixture;
    ADD_SLABS
    let s_front = s_of(slab);
    if mixture.n == 0u {
        return;
    }
    if mixture.n == 1u {
        add_fragment(mixture.only.xyz, mixture.only.w, s_front, mixture.only_extent);
        return;
    }
    // Both halves, front to back; and the mean position that light comes from.
    let near = mixed(mixture.near);
    let far = mixed(mixture.far);
    let share = (1.0f - near.w) * far.w;
    let alpha = near.w + share;
    let inverse = 1.0f / max(alpha, MIN_DEPTH);
    let rgb = (near.xyz * near.w + far.xyz * share) * inverse;
    let moment = near.w * 0.25f + share * 0.75f;
    add_fragment(rgb, alpha, s_front, 2.0f * (s_of(slab + 1u) - s_front) * moment * inverse);
}

fn is_done() -> bool {
    return gathered.w >= parameters.frame.number.x;
}

// Slabs of a word that any layer occupies, and the sheets behind them.
fn any_occupied(block: u32, word: u32) -> vec2<u32> {
    var slabs = 0u;
    var sheets = 0u;
    for (var layer = 0u; layer < N_LAYERS; layer++) {
        let own = occupied_word(layer, block, word);
        slabs |= own;
        sheets |= behind(layer, block, word, own);
    }
    return vec2<u32>(slabs, sheets);
}

fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    // The sheet behind the last slab stands for half a slab.
    let last = select(end, end + 1u, !PRE_INTEGRATED && end == parameters.frame.slabs.z);
    for (var word = first / 32u; word * 32u < last; word++) {
        let found = any_occupied(block, word);
        var places = within(select(found.x | found.y, found.x, PRE_INTEGRATED), word, first, last);
        while places != 0u {
            let bit = firstTrailingBit(places);
            places &= places - 1u;
            let place = word * 32u + bit;
            if PRE_INTEGRATED {
                add_slabs(ray, block, place);
            } else {
                let s = s_of(place);
                if ((found.y >> bit) & 1u) == 1u {
                    let half = 0.5f * (s - s_of(place - 1u));
                    add_sheets(ray, block, place, true, s - half, s);
                }
                if ((found.x >> bit) & 1u) == 1u {
                    let half = 0.5f * (s_of(place + 1u) - s);
                    add_sheets(ray, block, place, false, s - half, s + half);
                }
            }
            if is_done() {
                return;
            }
        }
    }
}
