//! The threads of zenoh in a process. zenoh reads them from the environment, once, before the first session is opened.

/// The environment variable by which zenoh is told its threads.
pub const RUNTIME_VARIABLE: &str = "ZENOH_RUNTIME";

/// A value of [`RUNTIME_VARIABLE`] for a process that is one node: few threads in place of zenoh's pools,
/// which takes a quarter to a half off a lockstep round trip. What is received has one to itself: a hub that passes
/// something large on waits in it for the sender to make room, which must then have another thread to run in. So have links
/// that somebody begins to open: one that is never finished is closed with its linger time on.
pub const RUNTIME: &str =
    // One pool of two threads for everything was tried: a hub that forwarded an answer of half
    // a megabyte had both waiting for room in the sender's queue, which had no thread left to
    // run in, and all agents were lost for three seconds.
    "(rx:(worker_threads:1),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// The same for the hub of a game that goes by the clock: real boats may be in it, and people must be able to stop them. A thread
/// that receives looks at no other link while there is something to read on the one it reads; so each peer that sends without
/// end holds one, and an E-stop comes by another. In lockstep, where the second one costs time, all boats are simulated.
pub const HUB_RUNTIME: &str =
    // Measured with 250 E-stops under 400,000 messages of garbage a second: 12.4 ms (median) to
    // 124 ms with one thread that receives, less than 0.1 ms to 6.6 ms with two.
    "(rx:(worker_threads:4),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// The same for a process with keys. A TLS link of zenoh (1.10, `zenoh-link-tls`) is read and written at once through one object that
/// only one thread may use at a time: with two, rustls' state is overwritten, and the process dies. So one thread does everything.
pub(crate) const KEYS_RUNTIME: &str =
    // With two threads and sixteen agents in lockstep the sim died within a minute. Upstream,
    // the stream should be split, or one lock be held for both halves; QUIC, whose directions
    // are two objects, is the other way out.
    "(rx:(handover:app),acc:(handover:app),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";
