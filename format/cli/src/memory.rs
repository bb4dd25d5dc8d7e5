//! How much memory there is, and how much of it the process uses.

/// The largest resident set of this process so far, in bytes; `None` where the system does not tell.
///
/// Read from `VmHWM` in `/proc/self/status` (Linux).
#[must_use]
pub fn peak_memory_bytes() -> Option<u64> {
    field("/proc/self/status", "VmHWM:")
}

/// The resident set of this process at this moment, in bytes; `None` where the system does not tell.
///
/// Read from `VmRSS` in `/proc/self/status` (Linux).
#[must_use]
pub fn memory_in_use_bytes() -> Option<u64> {
    field("/proc/self/status", "VmRSS:")
}

/// Memory that programs can still have without anything being swapped out, in bytes; `None` where the system does not
/// tell.
///
/// Read from `MemAvailable` in `/proc/meminfo` (Linux).
#[must_use]
pub fn available_memory_bytes() -> Option<u64> {
    field("/proc/meminfo", "MemAvailable:")
}

/// A field given in kibibytes.
fn field(path: &str, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find(|line| line.starts_with(name))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    kibibytes.checked_mul(1024)
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
        assert!(super::memory_in_use_bytes().unwrap() <= super::peak_memory_bytes().unwrap());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn there_is_memory() {
        assert!(super::available_memory_bytes().unwrap() > 1 << 20);
    }
}
