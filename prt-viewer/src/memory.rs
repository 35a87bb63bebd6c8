//! How much memory the program took.

/// The most memory that was resident at once, bytes; `None` where the system does not tell.
pub(crate) fn peak_bytes() -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The line `VmHWM: 1234 kB` of Linux's `/proc/self/status`.
fn parse(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_found() {
        assert_eq!(parse("Name:\tprt\nVmPeak:\t  9 kB\nVmHWM:\t  5044 kB\n"), Some(5044 * 1024));
        assert_eq!(parse("Name:\tprt\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_that_is_used_counts() {
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        assert!(peak_bytes().is_some_and(|peak| peak > block.len() as u64));
    }
}
