//! The machine that a study is made on.

use super::record::Machine;

/// This one.
pub fn this_machine() -> Machine {
    Machine {
        processor: processor().unwrap_or_else(|| std::env::consts::ARCH.into()),
        threads: rayon::current_num_threads(),
        instruction_set: octvox_cli::instruction_set().into(),
        memory_bytes: octvox_cli::available_memory_bytes().unwrap_or(0),
        system: std::env::consts::OS.into(),
        program: format!("voxtrace {}", env!("CARGO_PKG_VERSION")),
    }
}

/// What the processor calls itself, where the system tells.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
