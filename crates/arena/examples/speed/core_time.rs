//! CPU time, for programs that measure speed.

/// CPU time of this thread, s: other load on the machine is not counted.
pub(crate) fn core_time_s() -> f64 {
    let path = "/proc/thread-self/schedstat";
    // Linux updates this time only when it schedules: without the yield, it may be 10 ms old.
    std::thread::yield_now();
    let text = std::fs::read_to_string(path)
        .unwrap_or_else(|e| panic!("{path}: {e} (this program needs Linux)"));
    let first = text
        .split_whitespace()
        .next()
        .and_then(|time_ns| time_ns.parse::<f64>().ok());
    first.unwrap_or_else(|| panic!("{path} is {text:?}, expected three numbers")) * 1e-9
}
