//! Links Embree 3, Debian's package libembree-dev.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-lib=dylib=embree3");
}
