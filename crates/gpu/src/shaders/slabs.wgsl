// Occupied slabs of a block as bit masks, made on the CPU by `BasePlaneArrays::tile`
// (crates/splat/src/render/plan_arrays.rs).

fn occupied_word(layer: u32, block: u32, word: u32) -> u32 {
    return occupied[(layer * parameters.frame.blocks.y + block) * parameters.frame.blocks.w + word];
}

// Mask of the sheets behind the slabs of a word, `own`, and behind the last slab of the word before.
fn behind(layer: u32, block: u32, word: u32, own: u32) -> u32 {
    var carried = 0u;
    if word > 0u {
        carried = occupied_word(layer, block, word - 1u) >> 31u;
    }
    return (own << 1u) | carried;
}

// Masks of a word: the sheets in front of or behind the layer's slabs from `first` to before `end`, and the sheets
// behind a slab.
fn sheets_around(layer: u32, block: u32, word: u32, first: u32, end: u32) -> vec2<u32> {
    let own = occupied_word(layer, block, word);
    let slabs_behind = behind(layer, block, word, own);
    return vec2<u32>(within(own, word, first, end) | within(slabs_behind, word, first + 1u, end + 1u), slabs_behind);
}

// Bits of a word that stand for numbers from `first` to before `end`.
fn within(bits: u32, word: u32, first: u32, end: u32) -> u32 {
    var kept = bits;
    let start = word * 32u;
    if end <= start || first >= start + 32u {
        return 0u;
    }
    if first > start {
        kept &= 0xffffffffu << (first - start);
    }
    if end < start + 32u {
        kept &= (1u << (end - start)) - 1u;
    }
    return kept;
}
