//! A payload that is passed through, as shared by its threads. Records the bytes between it and its
//! clients, and decodes them if it is a sonde.

use super::super::clock::Clock;
use super::super::loop_input::Call;
use super::super::machine_check::free_mib;
use super::Shell;
use super::turn::Turn;
use crate::payload::exo2::{Conversation, Measurement, Sonde};
use crate::payload::{PayloadEncoder, PayloadPort};
use bus::{InboxSender, clock};
use parking_lot::Mutex;
use recording::{BulkRecorder, Entry};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// How often the free disk space is checked.
const SPACE_EVERY: Duration = Duration::from_secs(1);
/// Minimum time between remarks.
const REMARK_EVERY: Duration = Duration::from_secs(10);

/// State shared by the threads of a payload.
pub(super) struct Payload {
    pub(super) port: PayloadPort,
    pub(super) turn: Turn,
    calls: InboxSender<Call>,
    remarked: Mutex<Option<Instant>>,
    /// The number of connections so far.
    connections: AtomicU32,
    recording: Option<Recording>,
}

struct Recording {
    recorder: BulkRecorder,
    clock: Clock,
    encoder: Mutex<PayloadEncoder>,
    /// The state of the sonde, if it is one.
    sonde: Option<Mutex<Sonde>>,
    file: PathBuf,
    /// With less free disk space than this, the rest is for the boat's own bytes, MiB.
    space_min_mib: u64,
    /// When the free space was checked, and whether there was enough.
    space: Mutex<Option<(Instant, bool)>>,
}

/// What a sonde and its client say to each other over a connection.
pub(super) type Talk = Mutex<Conversation>;

impl Payload {
    pub(super) fn new(port: &PayloadPort, shell: &Shell) -> Payload {
        let recording = |(recorder, file)| Recording {
            recorder,
            clock: shell.clock,
            encoder: Mutex::new(PayloadEncoder::new(&port.name)),
            sonde: port.exo2.map(|_| Mutex::default()),
            file,
            space_min_mib: shell.space_min_mib,
            space: Mutex::default(),
        };
        Payload {
            port: port.clone(),
            turn: Turn::default(),
            calls: shell.calls.clone(),
            remarked: Mutex::default(),
            connections: AtomicU32::new(0),
            recording: shell.record.clone().map(recording),
        }
    }

    /// Logs a remark, unless one was logged just now.
    pub(super) fn remark(&self, text: &str) {
        let mut remarked = self.remarked.lock();
        if remarked.is_some_and(|at| clock::since(at) < REMARK_EVERY) {
            return;
        }
        *remarked = Some(clock::now());
        // A loop whose queue is full has worse to report.
        self.calls
            .offer(Call::Remark(format!("payload {}: {text}", self.port.name)));
    }

    /// The number of a new connection, and its conversation.
    pub(super) fn open(&self) -> (u32, Talk) {
        (
            self.connections
                .fetch_add(1, Ordering::Relaxed)
                .wrapping_add(1),
            Talk::default(),
        )
    }

    /// The state of the sonde; `None` if its values are not wanted.
    pub(super) fn sonde(&self) -> Option<Sonde> {
        self.recording
            .as_ref()?
            .sonde
            .as_ref()
            .map(|sonde| sonde.lock().clone())
    }

    /// Records bytes of the connection of this number, to the payload if `outward`.
    pub(super) fn record_bytes(&self, talk: &Talk, connection: u32, outward: bool, bytes: &[u8]) {
        self.record(connection, outward, bytes, |sonde| {
            talk.lock().read_bytes(outward, bytes, sonde)
        });
    }

    /// Records that the sending side has closed the connection.
    pub(super) fn record_end(&self, talk: &Talk, connection: u32, outward: bool) {
        self.record(connection, outward, &[], |sonde| {
            talk.lock().end(outward, sonde).into_iter().collect()
        });
    }

    /// Without a recorder this does nothing.
    fn record(
        &self,
        connection: u32,
        outward: bool,
        bytes: &[u8],
        read: impl FnOnce(&mut Sonde) -> Vec<Measurement>,
    ) {
        let Some(recording) = &self.recording else {
            return;
        };
        let at = recording.clock.now();
        let mut encoder = recording.encoder.lock();
        // The boat's own recording needs the space: a camera at 1 MB a second fills a disk in a
        // day.
        if recording.has_space() {
            recording
                .recorder
                .record(encoder.bytes(at, connection, outward, bytes));
        } else {
            let min_mib = recording.space_min_mib;
            self.remark(&format!(
                "its bytes are not recorded: the disk has less than {min_mib} MiB free"
            ));
        }
        let Some(sonde) = &recording.sonde else {
            return;
        };
        let measured = read(&mut sonde.lock());
        let entries: Vec<Entry> = measured
            .iter()
            .map(|measurement| encoder.values(at, measurement))
            .collect();
        entries
            .into_iter()
            .for_each(|entry| recording.recorder.record(entry));
    }
}

impl Recording {
    fn has_space(&self) -> bool {
        let mut seen = self.space.lock();
        match *seen {
            Some((at, is_enough)) if clock::since(at) < SPACE_EVERY => is_enough,
            _ => {
                // If the free space is unknown, the recorder will detect a full disk.
                let is_enough =
                    free_mib(&self.file).map_or(true, |free_mib| free_mib >= self.space_min_mib);
                *seen = Some((clock::now(), is_enough));
                is_enough
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::loop_input::loop_input;
    use super::*;
    use recording::{Bag, Facts, Kind, NewFile, Opening, Recorder};

    #[test]
    fn a_disk_that_is_nearly_full_is_left_to_the_boat_but_for_a_sondes_values() {
        let folder = tempfile::tempdir().expect("a folder");
        for (min_mib, want) in [(0, [4, 1]), (u64::MAX, [0, 1])] {
            let file = folder.path().join(format!("{min_mib}.mcap"));
            let kind = Kind::Gateway;
            let facts = Facts::new();
            let opening = Opening {
                kind,
                began_utc_ns: 0,
                facts,
                more: vec![],
                teams: vec![],
            };
            let recorder = Recorder::begin(NewFile::create(&file).expect("a file"), &opening)
                .expect("it begins");
            let (input, output) = loop_input();
            let port = "sonde=tcp://127.0.0.1:1,exo2".parse().expect("a port");
            let record = Some((recorder.bulk(), file.clone()));
            let shell = Shell {
                record,
                space_min_mib: min_mib,
                clock: Clock::start(),
                calls: input.calls,
            };
            let payload = Payload::new(&port, &shell);
            let (number, talk) = payload.open();
            for (outward, bytes) in [
                (true, "para\r"),
                (false, "1\r"),
                (true, "data\r"),
                (false, "20.5\r"),
            ] {
                payload.record_bytes(&talk, number, outward, bytes.as_bytes());
            }
            drop(recorder);
            let bag = Bag::open(&file).expect("a recording");
            assert_eq!(
                ["payload/sonde", "values/sonde"].map(|topic| bag.on(topic).count()),
                want,
                "{min_mib} MiB"
            );
            assert_eq!(output.calls.take_now().is_some(), min_mib > 0, "it says so");
        }
    }
}
