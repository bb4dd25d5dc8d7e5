//! Names the combination of instruction sets that the sixteen-lane traversal has a file of its own for.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(octvox_avx512)");
    println!("cargo::rerun-if-changed=build.rs");
    let features = std::env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    let has = |wanted: &str| features.split(',').any(|feature| feature == wanted);
    let needed = ["avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "avx512vpopcntdq"];
    if needed.iter().all(|feature| has(feature)) {
        println!("cargo::rustc-cfg=octvox_avx512");
    }
}
