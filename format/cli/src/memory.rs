//! How much memory the process has used.

/// The largest resident set of this process so far, in bytes; `None` where the system does not tell.
///
/// Read from `VmHWM` in `/proc/self/status` (Linux).
#[must_use]
pub fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn peak_grows_with_an_allocation() {
        let before = super::peak_memory_bytes().unwrap();
        let block = vec![1u8; 64 << 20];
        let after = super::peak_memory_bytes().unwrap();
        assert!(std::hint::black_box(&block)[77] == 1);
        assert!(after >= before.max(64 << 20), "{before} then {after}");
    }
}
