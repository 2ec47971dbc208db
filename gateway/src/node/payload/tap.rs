//! Records the bytes between a payload and its clients, and decodes them if the payload is a sonde.

use super::super::clock::Clock;
use super::super::machine_check::free_mib;
use super::remarks::Remarks;
use super::shell::Shell;
use crate::payload::exo2::{Conversation, Measurement, Sonde};
use crate::payload::{PayloadEncoder, PayloadPort};
use bus::clock;
use parking_lot::Mutex;
use recording::{BulkRecorder, Entry};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// How often the free disk space is checked.
const SPACE_EVERY: Duration = Duration::from_secs(1);

/// Records a payload's connections. Without a recorder it does nothing.
pub(super) struct Taps(Option<Arc<Recording>>, AtomicU32);

struct Recording {
    recorder: BulkRecorder,
    clock: Clock,
    encoder: Mutex<PayloadEncoder>,
    /// The state of the sonde, if it is one.
    sonde: Option<Mutex<Sonde>>,
    space: Space,
    remarks: Arc<Remarks>,
}

/// The disk of the recording: with less free space than this, the rest is for the boat's own bytes.
struct Space {
    file: PathBuf,
    min_mib: u64,
    /// When it was checked, and whether there was enough space.
    seen: Mutex<Option<(Instant, bool)>>,
}

/// Records one connection.
pub(super) struct Tap {
    recording: Option<Arc<Recording>>,
    conversation: Mutex<Conversation>,
}

impl Taps {
    pub(super) fn new(port: &PayloadPort, shell: &Shell, remarks: &Arc<Remarks>) -> Taps {
        let recording = |(recorder, file)| {
            let sonde = port.exo2.map(|_| Mutex::default());
            let space = Space { file, min_mib: shell.space_min_mib, seen: Mutex::default() };
            let (encoder, remarks) = (Mutex::new(PayloadEncoder::new(&port.name)), Arc::clone(remarks));
            Arc::new(Recording { recorder, clock: shell.clock, encoder, sonde, space, remarks })
        };
        Taps(shell.record.clone().map(recording), AtomicU32::new(0))
    }

    /// The number of a new connection, and its recorder.
    pub(super) fn open(&self) -> (u32, Tap) {
        let number = self.1.fetch_add(1, Ordering::Relaxed).wrapping_add(1);
        (number, Tap { recording: self.0.clone(), conversation: Mutex::default() })
    }

    /// The state of the sonde; `None` if its values are not wanted.
    pub(super) fn sonde(&self) -> Option<Sonde> {
        self.0.as_ref()?.sonde.as_ref().map(|sonde| sonde.lock().clone())
    }
}

impl Tap {
    /// Records bytes of the connection of this number, to the payload if `outward`.
    pub(super) fn record_bytes(&self, connection: u32, outward: bool, bytes: &[u8]) {
        self.record(connection, outward, bytes, |conversation, sonde| conversation.read_bytes(outward, bytes, sonde));
    }

    /// Records that the sending side has closed the connection.
    pub(super) fn end(&self, connection: u32, outward: bool) {
        self.record(connection, outward, &[], |conversation, sonde| {
            conversation.end(outward, sonde).into_iter().collect()
        });
    }

    fn record(
        &self,
        connection: u32,
        outward: bool,
        bytes: &[u8],
        read: impl FnOnce(&mut Conversation, &mut Sonde) -> Vec<Measurement>,
    ) {
        let Some(Recording { recorder, clock, encoder, sonde, space, remarks }) = self.recording.as_deref() else {
            return;
        };
        let at = clock.now();
        let mut encoder = encoder.lock();
        // The boat's own recording needs the space: a camera at 1 MB a second fills a disk in a
        // day.
        if space.is_enough() {
            recorder.record(encoder.bytes(at, connection, outward, bytes));
        } else {
            remarks.make(&format!("its bytes are not recorded: the disk has less than {} MiB free", space.min_mib));
        }
        let Some(sonde) = sonde else { return };
        let measured = read(&mut self.conversation.lock(), &mut sonde.lock());
        let entries: Vec<Entry> = measured.iter().map(|measurement| encoder.values(at, measurement)).collect();
        entries.into_iter().for_each(|entry| recorder.record(entry));
    }
}

impl Space {
    fn is_enough(&self) -> bool {
        let mut seen = self.seen.lock();
        match *seen {
            Some((at, is_enough)) if clock::since(at) < SPACE_EVERY => is_enough,
            _ => {
                // If the free space is unknown, the recorder will detect a full disk.
                let is_enough = free_mib(&self.file).map_or(true, |free_mib| free_mib >= self.min_mib);
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
            let (kind, facts) = (Kind::Gateway, Facts::new());
            let opening = Opening { kind, began_utc_ns: 0, facts, more: vec![], teams: vec![] };
            let recorder = Recorder::begin(NewFile::create(&file).expect("a file"), &opening).expect("it begins");
            let (input, output) = loop_input();
            let port = "sonde=tcp://127.0.0.1:1,exo2".parse().expect("a port");
            let record = Some((recorder.bulk(), file.clone()));
            let shell = Shell { record, space_min_mib: min_mib, clock: Clock::start(), calls: input.calls };
            let remarks = Arc::new(Remarks::new("sonde", shell.calls.clone()));
            let (number, tap) = Taps::new(&port, &shell, &remarks).open();
            for (outward, bytes) in [(true, "para\r"), (false, "1\r"), (true, "data\r"), (false, "20.5\r")] {
                tap.record_bytes(number, outward, bytes.as_bytes());
            }
            drop(recorder);
            let bag = Bag::open(&file).expect("a recording");
            assert_eq!(["payload/sonde", "values/sonde"].map(|topic| bag.on(topic).count()), want, "{min_mib} MiB");
            assert_eq!(output.calls.take_now().is_some(), min_mib > 0, "it says so");
        }
    }
}
