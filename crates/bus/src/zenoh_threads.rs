//! zenoh's threads in a process. zenoh reads their number from the environment, once, before the
//! first session is opened.

/// The environment variable that configures zenoh's threads.
pub const RUNTIME_VARIABLE: &str = "ZENOH_RUNTIME";

/// A value of [`RUNTIME_VARIABLE`] for a process that is one node: few threads in place of zenoh's
/// pools, which shortens a lockstep round trip by a quarter to a half. Reception has its own
/// thread: a hub that forwards a large message waits in it for a free slot at the sender, which
/// then needs another thread. Accepting links has its own thread too: a link that is never
/// completed is closed with its linger time on.
pub const RUNTIME: &str =
    // One pool of two threads for everything was tried. A hub that forwarded an answer of half a
    // megabyte had both waiting for a free slot in the sender's queue, which had no thread left,
    // and all agents were lost for three seconds.
    "(rx:(worker_threads:1),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// The same for the hub of a game paced by the clock: it may include real boats, and people must be
/// able to stop them. A receiving thread serves no other link while the one it reads has data: each
/// peer that sends without pause occupies one, and an E-stop needs another. In lockstep, where the
/// second one costs time, all boats are simulated.
pub const HUB_RUNTIME: &str =
    // Measured with 250 E-stops under 400,000 messages of garbage a second: 12.4 ms (median) to 124
    // ms with one receiving thread, less than 0.1 ms to 6.6 ms with two.
    "(rx:(worker_threads:4),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// The same for a process with keys. zenoh (1.10, `zenoh-link-tls`) reads and writes a TLS link at
/// once through one object that is not thread-safe: with two threads, rustls' state is overwritten
/// and the process dies. So one thread does everything.
pub(crate) const KEYS_RUNTIME: &str =
    // With two threads and sixteen agents in lockstep the sim died within a minute. Upstream, the
    // stream should be split, or one lock held for both halves; QUIC, with an object per direction,
    // is the alternative.
    "(rx:(handover:app),acc:(handover:app),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";
