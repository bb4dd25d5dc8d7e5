//! The builds that there are, and what a processor needs for each.

/// The names of the builds that this processor can run, best first.
pub fn suitable() -> impl Iterator<Item = &'static str> {
    BUILDS.iter().filter(|build| (build.is_suitable)()).map(|build| build.name)
}

struct Build {
    name: &'static str,
    is_suitable: fn() -> bool,
}

#[cfg(target_arch = "x86_64")]
macro_rules! has {
    ($($feature:tt),*) => { || $(std::arch::is_x86_feature_detected!($feature))&&* };
}

/// The levels of the x86-64 psABI, of which each has all that is in those below. To AVX-512 comes the counting of bits,
/// which the traversal uses and every processor with AVX-512 since 2019 has.
#[cfg(target_arch = "x86_64")]
const BUILDS: &[Build] = &[
    Build {
        name: "x86-64-v4",
        is_suitable: has!(
            "avx512f",
            "avx512bw",
            "avx512cd",
            "avx512dq",
            "avx512vl",
            "avx512vpopcntdq",
            "avx2",
            "fma"
        ),
    },
    Build { name: "x86-64-v3", is_suitable: has!("avx2", "bmi1", "bmi2", "f16c", "fma", "lzcnt", "movbe") },
    Build {
        name: "x86-64-v2",
        is_suitable: has!("cmpxchg16b", "popcnt", "sse3", "ssse3", "sse4.1", "sse4.2"),
    },
];

#[cfg(not(target_arch = "x86_64"))]
const BUILDS: &[Build] = &[];
