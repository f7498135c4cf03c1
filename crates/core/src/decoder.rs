//! Decoders: samples computed on demand, for compressed volumes and for volumes larger than memory.

/// Source of the samples of any box of a volume.
pub trait Decoder: Send + Sync {
    /// Samples along x, y, z.
    fn size(&self) -> [usize; 3];

    /// Writes the samples of the box from `lo` to before `hi`, which lies inside the volume, as `[z][y][x]`. The same
    /// sample comes out with the same bits in every box.
    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]);
}
