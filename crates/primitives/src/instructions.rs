//! Which instructions of the processor the longest loops use, chosen while the program runs.
//!
//! The program is compiled for every processor of its kind. The loops that take most of the time, those of a helm's solver and
//! those over the components of waves, are compiled again for processors that have wider registers: the same operations, one by
//! one, on more numbers at a time. No operation is fused with another or put elsewhere, so all of them come to the same bits.

/// A set of instructions that this machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instructions(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    /// What every processor of this kind has.
    Baseline,
    /// Registers of 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Registers of 512 bits.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// A calculation that is compiled for each set of instructions. What it calls must be inlined into it, or that part stays as
/// it is for all.
pub trait Kernel {
    /// What it comes to.
    type Output;

    /// Does it. To be marked `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

impl Instructions {
    /// All sets that this machine has, the plainest first.
    #[must_use]
    pub fn of_this_machine() -> Vec<Instructions> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut, reason = "there is one"))]
        let mut sets = vec![Instructions(Set::Baseline)];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                sets.push(Instructions(Set::Avx2));
            }
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                sets.push(Instructions(Set::Avx512));
            }
        }
        sets
    }

    /// The fastest set that this machine has.
    #[must_use]
    pub fn best() -> Instructions {
        Instructions::of_this_machine().pop().unwrap_or(Instructions(Set::Baseline))
    }

    /// Does a calculation with these instructions.
    #[inline]
    #[cfg_attr(
        target_arch = "x86_64",
        expect(
            unsafe_code,
            reason = "code for a processor that was found while the program runs cannot be called otherwise"
        )
    )]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Baseline => with_baseline(kernel),
            // SAFETY: only `of_this_machine` makes this value, on a processor that has these instructions.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { with_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => unsafe { with_avx512(kernel) },
        }
    }
}

/// Not inlined, as the others cannot be: what is done with the result has no say in how the kernel is compiled.
#[inline(never)]
fn with_baseline<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn with_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
