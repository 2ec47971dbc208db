//! Random changes of known sentences for some seconds, on stable: `cargo run --release --example soak -- 20 [seed]`.

use squall_gateway_fuzz::target;
use std::path::Path;
use std::time::{Duration, Instant};

/// xorshift64*: the soak needs no good randomness, only a lot of it.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % sides.max(1)
    }
}

/// Bytes with a meaning to the codec.
const SIGNIFICANT: &[u8] = b"$*,\r\n.-+ 0123456789AFLTCGRNSEWVMK!\x00\x7f\x80\xff";

#[expect(clippy::disallowed_methods, reason = "how long it runs is all that the clock decides")]
fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("seconds, then a seed"));
    let seconds = arguments.next().unwrap_or(20);
    let seed = arguments.next().unwrap_or_else(|| u64::from(std::process::id()) + 1);
    println!("soak of {seconds} s with seed {seed}");
    let seeds = seeds();
    let mut dice = Dice(seed.max(1));
    let (begin, mut runs) = (Instant::now(), 0_u64);
    for seed in &seeds {
        target(seed);
    }
    while begin.elapsed() < Duration::from_secs(seconds) {
        for _ in 0..100 {
            let bytes = changed(&seeds, &mut dice);
            if std::panic::catch_unwind(|| target(&bytes)).is_err() {
                println!("fails after {runs} runs: {}", bytes.escape_ascii());
                std::process::exit(1);
            }
            runs += 1;
        }
    }
    println!("{runs} runs, no fault");
}

fn seeds() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("the seeds are there").flatten().map(|e| e.path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).expect("a seed can be read")).collect()
}

/// One to three seeds in a row with up to eight changes.
fn changed(seeds: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = Vec::new();
    for _ in 0..=dice.roll(3) {
        bytes.extend_from_slice(&seeds[dice.roll(seeds.len())]);
    }
    for _ in 0..dice.roll(9) {
        let at = dice.roll(bytes.len());
        let end = (at + dice.roll(12)).min(bytes.len());
        match dice.roll(6) {
            0 if !bytes.is_empty() => bytes[at] = dice.roll(256) as u8,
            1 => bytes.insert(at, SIGNIFICANT[dice.roll(SIGNIFICANT.len())]),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                let to = dice.roll(bytes.len());
                bytes.splice(to..to, copy.repeat(1 + dice.roll(30)));
            }
            4 => bytes.truncate(end),
            _ if !bytes.is_empty() => bytes[at] = SIGNIFICANT[dice.roll(SIGNIFICANT.len())],
            _ => bytes.push(b'$'),
        }
    }
    bytes
}
