//! Runs targets for a few seconds each, or one target on a file.

use squall_fuzz::{TARGETS, Target, named, soak};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

const USAGE: &str = "\
squall-fuzz soak [OPTIONS] [TARGET…]   fuzz these targets, or all
    --seconds N                        seconds for each target (default: 20)
    --seed N                           random seed (default: different in each run)
    --jobs N                           number of targets at a time (default: 1)
squall-fuzz play TARGET FILE           check one input
squall-fuzz seeds FOLDER               write real inputs, one folder per target";

/// The command that runs this program.
const COMMAND: &str =
    "cargo run --release --manifest-path crates/fuzz/Cargo.toml --target-dir target --";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["soak", options @ ..] => soak_all(options),
        // Run by `soak` in a child process, because an input may crash it.
        ["child", target, seconds, seed, current] => {
            child(target, seconds, seed, Path::new(current))
        }
        ["play", target, file] => {
            soak::check(
                &target_of(target),
                &std::fs::read(file).unwrap_or_else(|e| give_up(&format!("{file}: {e}"))),
            );
            println!("no fault");
            ExitCode::SUCCESS
        }
        ["seeds", folder] => seeds(Path::new(folder)),
        _ => give_up(USAGE),
    }
}

fn soak_all(options: &[&str]) -> ExitCode {
    let mut seconds = 20;
    let mut seed = u64::from(std::process::id());
    let mut jobs = 1;
    let mut targets = Vec::new();
    let mut options = options.iter();
    while let Some(option) = options.next() {
        let mut number = || {
            let text = options
                .next()
                .unwrap_or_else(|| give_up(&format!("{option} needs a number\n{USAGE}")));
            text.parse().unwrap_or_else(|_| {
                give_up(&format!("{option} is {text}, expected a whole number"))
            })
        };
        match *option {
            "--seconds" => seconds = number(),
            "--seed" => seed = number(),
            "--jobs" => jobs = number(),
            name => targets.push(target_of(name)),
        }
    }
    if targets.is_empty() {
        targets = TARGETS.to_vec();
    }
    println!("{seconds} s each with seed {seed}");
    let next = AtomicUsize::new(0);
    let is_sound = AtomicBool::new(true);
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                while let Some(target) = targets.get(next.fetch_add(1, Ordering::Relaxed)) {
                    is_sound.fetch_and(soak_one(target, seconds, seed), Ordering::Relaxed);
                }
            });
        }
    });
    if is_sound.into_inner() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Runs a target in a separate process. Returns whether it found no fault.
fn soak_one(target: &Target, seconds: u64, seed: u64) -> bool {
    let folder = failures();
    let current = folder.join(format!("{}-{}-current", target.name, std::process::id()));
    let program = std::env::current_exe()
        .unwrap_or_else(|e| give_up(&format!("cannot find this program: {e}")));
    let mut command = Command::new(program);
    command
        .args([
            "child",
            target.name,
            &seconds.to_string(),
            &seed.to_string(),
        ])
        .arg(&current);
    let status = command
        .status()
        .unwrap_or_else(|e| give_up(&format!("cannot start a process: {e}")));
    if !status.success() {
        let input = soak::left_in(&current).unwrap_or_default();
        let file = folder.join(format!("{}-{seed}", target.name));
        std::fs::write(&file, &input)
            .unwrap_or_else(|e| give_up(&format!("{}: {e}", file.display())));
        println!(
            "{}: FAILED ({status}). Reproduce with: {COMMAND} play {} {}",
            target.name,
            target.name,
            file.display()
        );
    }
    // If the file does not exist, the process did not start.
    drop(std::fs::remove_file(&current));
    status.success()
}

fn child(target: &str, seconds: &str, seed: &str, current: &Path) -> ExitCode {
    limit_memory();
    let target = target_of(target);
    let seconds = seconds.parse().expect("seconds");
    match soak::soak(
        &target,
        Duration::from_secs(seconds),
        seed.parse().expect("a seed"),
        current,
    ) {
        Ok(runs) => {
            println!(
                "{}: {runs} runs, {} per second, no fault",
                target.name,
                runs / seconds.max(1)
            );
            ExitCode::SUCCESS
        }
        Err(_) => ExitCode::FAILURE,
    }
}

/// Limits this process to 4 GiB of memory; it ends if it needs more.
fn limit_memory() {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let most = Some(4 << 30);
    setrlimit(
        Resource::As,
        Rlimit {
            current: most,
            maximum: most,
        },
    )
    .expect("a limit can be lowered");
}

fn seeds(folder: &Path) -> ExitCode {
    for target in TARGETS {
        let folder = folder.join(target.name);
        let written = std::fs::create_dir_all(&folder).and_then(|()| {
            let mut seeds = (target.seeds)().into_iter().enumerate();
            seeds.try_for_each(|(i, seed)| std::fs::write(folder.join(format!("{i:03}")), seed))
        });
        written.unwrap_or_else(|e| give_up(&format!("{}: {e}", folder.display())));
    }
    ExitCode::SUCCESS
}

fn failures() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("artifacts");
    std::fs::create_dir_all(&folder)
        .unwrap_or_else(|e| give_up(&format!("{}: {e}", folder.display())));
    folder
}

fn target_of(name: &str) -> Target {
    let names = TARGETS.map(|target| target.name).join(", ");
    named(name)
        .unwrap_or_else(|| give_up(&format!("unknown target {name}, expected one of {names}")))
}

fn give_up(why: &str) -> ! {
    eprintln!("{why}");
    std::process::exit(2)
}
