//! Instruction-level parallelism: two vectors of sixteen, so that operations on one fill the latency of the other.

use super::{Entry, Math, Simd, Wide};

/// Operations on two vectors of sixteen numbers.
#[derive(Clone, Copy, Debug)]
pub struct Pair<S>(pub S);

macro_rules! twice {
    ($($name:ident)*) => {$(
        #[inline(always)]
        fn $name(self, a: Self::F, b: Self::F) -> Self::F {
            (self.0.$name(a.0, b.0), self.0.$name(a.1, b.1))
        }
    )*};
}

impl<S: Simd> Math for Pair<S> {
    type F = (S::F, S::F);
    type M = (S::M, S::M);

    twice!(add sub mul div min max);

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        (self.0.splat(x), self.0.splat(x))
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        (self.0.abs(a.0), self.0.abs(a.1))
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        (self.0.lt(a.0, b.0), self.0.lt(a.1, b.1))
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        (self.0.le(a.0, b.0), self.0.le(a.1, b.1))
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        (self.0.and(a.0, b.0), self.0.and(a.1, b.1))
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        (self.0.or(a.0, b.0), self.0.or(a.1, b.1))
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        (self.0.select(m.0, a.0, b.0), self.0.select(m.1, a.1, b.1))
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
        let [a, b] = [self.0.look_up(table, position.0), self.0.look_up(table, position.1)];
        [(a[0], b[0]), (a[1], b[1]), (a[2], b[2]), (a[3], b[3])]
    }
    #[inline(always)]
    fn exp2_neg(self, shifted: Self::F) -> Self::F {
        (self.0.exp2_neg(shifted.0), self.0.exp2_neg(shifted.1))
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::F) -> Self::F {
        (self.0.rsqrt_guess(a.0), self.0.rsqrt_guess(a.1))
    }
}

impl<S: Simd> Wide for Pair<S> {
    type One = S;
    const N: usize = 2;

    #[inline(always)]
    fn one(self) -> S {
        self.0
    }
    #[inline(always)]
    fn join(self, a: S::F, b: S::F) -> Self::F {
        (a, b)
    }
    #[inline(always)]
    fn part(self, x: Self::F) -> [S::F; 2] {
        [x.0, x.1]
    }
    #[inline(always)]
    fn all_bits(self, m: Self::M) -> [u16; 2] {
        [self.0.bits(m.0), self.0.bits(m.1)]
    }
}
