//! Selects at run time which processor instructions the hottest loops use.
//!
//! The program is compiled for the baseline of each architecture. The hottest loops, in a helm's
//! solver and over the wave components, are also compiled for processors with wider registers: the
//! same operations on more numbers at a time. No operation is fused or reordered, so all variants
//! give the same bits.

/// An instruction set that this machine supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instructions(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    /// Supported by every processor of the architecture.
    Baseline,
    /// 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// A calculation compiled for each instruction set. Functions it calls must be inlined into it;
/// otherwise they stay at the baseline.
pub trait Kernel {
    /// The result.
    type Output;

    /// Runs the calculation. Mark it `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

impl Instructions {
    /// All instruction sets that this machine supports, baseline first.
    pub fn of_this_machine() -> Vec<Instructions> {
        #[cfg_attr(
            not(target_arch = "x86_64"),
            expect(unused_mut, reason = "there is only one")
        )]
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

    /// The fastest instruction set that this machine supports.
    pub fn best() -> Instructions {
        Instructions::of_this_machine()
            .pop()
            .unwrap_or(Instructions(Set::Baseline))
    }

    /// Runs a calculation with these instructions.
    #[inline]
    #[cfg_attr(
        target_arch = "x86_64",
        expect(
            unsafe_code,
            reason = "code for instructions detected at run time cannot be called otherwise"
        )
    )]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Baseline => with_baseline(kernel),
            // SAFETY: only `of_this_machine` creates this value, on a processor with these
            // instructions.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { with_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => unsafe { with_avx512(kernel) },
        }
    }
}

/// Not inlined, like the other variants, which cannot be: otherwise the caller's use of the result
/// would affect how the kernel is compiled.
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
