//! The processor a binary was built for, and the one it runs on.

/// Ends the process with a sentence if this processor lacks an instruction set the binary was compiled for.
///
/// The standard library's feature test is folded to `true` at compile time for exactly those sets, so the
/// processor is asked directly.
#[cfg(target_arch = "x86_64")]
pub(crate) extern "C" fn refuse_lesser_processor() {
    if !x86::supported() {
        x86::refuse();
    }
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) extern "C" fn refuse_lesser_processor() {}

/// Has the check run before `main`: link-time optimisation compiles the standard library for the newer processor
/// too, and its start-up code then dies of the first such instruction.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
#[used]
// SAFETY: the section holds pointers to functions of this signature (System V ABI, "Initialization and Termination
// Functions"), and this one needs nothing that is set up later.
#[unsafe(link_section = ".init_array")]
static BEFORE_MAIN: extern "C" fn() = refuse_lesser_processor;

/// The widest instruction set the binary was compiled for: `avx512`, `avx2`, `sse2`, `neon` or `portable`.
#[must_use]
pub const fn instruction_set() -> &'static str {
    if cfg!(all(target_feature = "avx512f", target_feature = "avx512vpopcntdq", target_feature = "avx512cd"))
    {
        "avx512"
    } else if cfg!(target_feature = "avx2") {
        "avx2"
    } else if cfg!(target_feature = "sse2") {
        "sse2"
    } else if cfg!(target_feature = "neon") {
        "neon"
    } else {
        "portable"
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{__cpuid, __cpuid_count, __get_cpuid_max};

    const REFUSAL: &[u8] = b"error: this program was built for a newer processor than this one; \
        build it here with `cargo build --release`, or take the build for x86-64-v2 or v3\n";

    /// Says why, and ends the process.
    #[cold]
    pub fn refuse() -> ! {
        // Not through the standard library, which may itself be compiled for the missing set.
        #[cfg(unix)]
        {
            unsafe extern "C" {
                fn write(file: std::ffi::c_int, bytes: *const u8, length: usize) -> isize;
                fn _exit(status: std::ffi::c_int) -> !;
            }
            // SAFETY: the C library's functions with their POSIX signatures; the bytes are static.
            unsafe {
                write(2, REFUSAL.as_ptr(), REFUSAL.len());
                _exit(1)
            }
        }
        #[cfg(not(unix))]
        {
            let _ = std::io::Write::write_all(&mut std::io::stderr(), REFUSAL);
            std::process::exit(1)
        }
    }

    /// A register in which a leaf of `cpuid` reports instruction sets.
    #[derive(Clone, Copy, PartialEq)]
    enum Register {
        Leaf1Ecx,
        Leaf7Ebx,
        Leaf7Ecx,
        Leaf7Edx,
        /// Leaf 7, subleaf 1.
        Leaf7NextEax,
        ExtendedEcx,
    }
    use Register::{ExtendedEcx, Leaf1Ecx, Leaf7Ebx, Leaf7Ecx, Leaf7Edx, Leaf7NextEax};

    const EXTENDED: u32 = 0x8000_0001;

    /// Where each instruction set is reported, and whether this binary was compiled for it.
    struct Requirement {
        register: Register,
        bit: u32,
        compiled: bool,
    }

    macro_rules! requirements {
        ($(($register:ident, $bit:expr, $feature:tt)),* $(,)?) => {
            &[$(Requirement { register: $register, bit: $bit, compiled: cfg!(target_feature = $feature) }),*]
        };
    }

    /// Intel SDM volume 2A, CPUID, tables 3-8 and following. Left out are the sets that every x86-64 has
    /// and those that only an operating system uses.
    const REQUIREMENTS: &[Requirement] = requirements![
        (Leaf1Ecx, 0, "sse3"),
        (Leaf1Ecx, 1, "pclmulqdq"),
        (Leaf1Ecx, 9, "ssse3"),
        (Leaf1Ecx, 12, "fma"),
        (Leaf1Ecx, 13, "cmpxchg16b"),
        (Leaf1Ecx, 19, "sse4.1"),
        (Leaf1Ecx, 20, "sse4.2"),
        (Leaf1Ecx, 22, "movbe"),
        (Leaf1Ecx, 23, "popcnt"),
        (Leaf1Ecx, 25, "aes"),
        (Leaf1Ecx, 28, "avx"),
        (Leaf1Ecx, 29, "f16c"),
        (Leaf7Ebx, 3, "bmi1"),
        (Leaf7Ebx, 5, "avx2"),
        (Leaf7Ebx, 8, "bmi2"),
        (Leaf7Ebx, 16, "avx512f"),
        (Leaf7Ebx, 17, "avx512dq"),
        (Leaf7Ebx, 19, "adx"),
        (Leaf7Ebx, 21, "avx512ifma"),
        (Leaf7Ebx, 28, "avx512cd"),
        (Leaf7Ebx, 29, "sha"),
        (Leaf7Ebx, 30, "avx512bw"),
        (Leaf7Ebx, 31, "avx512vl"),
        (Leaf7Ecx, 1, "avx512vbmi"),
        (Leaf7Ecx, 6, "avx512vbmi2"),
        (Leaf7Ecx, 8, "gfni"),
        (Leaf7Ecx, 9, "vaes"),
        (Leaf7Ecx, 10, "vpclmulqdq"),
        (Leaf7Ecx, 11, "avx512vnni"),
        (Leaf7Ecx, 12, "avx512bitalg"),
        (Leaf7Ecx, 14, "avx512vpopcntdq"),
        (Leaf7Edx, 23, "avx512fp16"),
        (Leaf7NextEax, 4, "avxvnni"),
        (Leaf7NextEax, 5, "avx512bf16"),
        (ExtendedEcx, 5, "lzcnt"),
    ];

    /// The bits of a register that must be set.
    const fn required(register: Register) -> u32 {
        let mut mask = 0;
        let mut index = 0;
        while index < REQUIREMENTS.len() {
            let requirement = &REQUIREMENTS[index];
            if requirement.register as u32 == register as u32 && requirement.compiled {
                mask |= 1 << requirement.bit;
            }
            index += 1;
        }
        mask
    }

    /// Whether this processor and its operating system support what the binary was compiled for.
    ///
    /// This function is itself compiled for those instruction sets. So it has constant masks and comparisons, which
    /// need none of them, and no loop, shift or copy, for which the compiler would take the newest it may.
    #[inline(never)]
    pub fn supported() -> bool {
        let leaf_1 = __cpuid(1);
        if !has_all(leaf_1.ecx, const { required(Leaf1Ecx) }) {
            return false;
        }
        const LEAF_7: bool =
            required(Leaf7Ebx) | required(Leaf7Ecx) | required(Leaf7Edx) | required(Leaf7NextEax) != 0;
        if LEAF_7 {
            if __get_cpuid_max(0).0 < 7 {
                return false;
            }
            let leaf_7 = __cpuid_count(7, 0);
            if !has_all(leaf_7.ebx, const { required(Leaf7Ebx) })
                || !has_all(leaf_7.ecx, const { required(Leaf7Ecx) })
                || !has_all(leaf_7.edx, const { required(Leaf7Edx) })
            {
                return false;
            }
            // The largest subleaf is in EAX; asking beyond it would return something else.
            let needs_next = const { required(Leaf7NextEax) != 0 };
            if needs_next
                && (leaf_7.eax < 1 || !has_all(__cpuid_count(7, 1).eax, const { required(Leaf7NextEax) }))
            {
                return false;
            }
        }
        let needs_extended = const { required(ExtendedEcx) != 0 };
        if needs_extended
            && (__get_cpuid_max(0x8000_0000).0 < EXTENDED
                || !has_all(__cpuid(EXTENDED).ecx, const { required(ExtendedEcx) }))
        {
            return false;
        }
        operating_system_saves_vectors(leaf_1.ecx)
    }

    #[inline(always)]
    fn has_all(reported: u32, required: u32) -> bool {
        reported & required == required
    }

    /// Whether the operating system saves the wide registers that the binary uses (XCR0).
    #[inline(always)]
    fn operating_system_saves_vectors(leaf_1_ecx: u32) -> bool {
        const OSXSAVE: u32 = 1 << 27;
        const AVX_STATE: u32 = 0b110;
        const AVX512_STATE: u32 = 0b1110_0110;
        if !cfg!(target_feature = "avx") {
            return true;
        }
        if !has_all(leaf_1_ecx, OSXSAVE) {
            return false;
        }
        let states: u32;
        // SAFETY: OSXSAVE is set, so `xgetbv` with index 0 exists; it reads XCR0 and touches nothing else.
        unsafe {
            std::arch::asm!("xgetbv", in("ecx") 0, out("eax") states, out("edx") _, options(nomem, nostack));
        }
        has_all(states, if cfg!(target_feature = "avx512f") { AVX512_STATE } else { AVX_STATE })
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn the_processor_that_built_the_tests_is_supported() {
            assert!(supported());
        }

        #[test]
        fn a_missing_bit_is_noticed() {
            assert!(has_all(0b1011, 0b0011));
            assert!(!has_all(0b1001, 0b0011));
            assert!(has_all(0, 0));
        }

        #[test]
        fn only_compiled_sets_are_required() {
            let avx = required(Leaf1Ecx) >> 28 & 1 == 1;
            assert_eq!(avx, cfg!(target_feature = "avx"));
            let avx512 = required(Leaf7Ebx) >> 16 & 1 == 1;
            assert_eq!(avx512, cfg!(target_feature = "avx512f"));
        }
    }
}
