//! `squall train`: trains a policy according to a training file.

mod files;

use crate::jobs_args::JobsArgs;
use crate::progress::Progress;
use crate::{clock, output_file, screen, stop};
use anyhow::{Context, Result, bail};
use command_line::number::whole;
use files::Files;
use learn::environment::{RecordingLog, RecordingNames, Recordings, check_recording_folder};
use learn::train::{Evaluated, Played, Trainer};
use learn::training::Training;
use scenario::{Kind, argument_for};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Size limit of a state, bytes: enough for a league of networks of the maximum size.
const STATE_BYTES_MAX: u64 = 4 << 30;
/// Minimum time between two saved states. SIGTERM does not wait for the end of an update, and
/// everything after the last saved state is lost.
const SAVE_EVERY: Duration = Duration::from_secs(10);
/// Reciprocal of the maximum fraction of time spent saving.
const SAVE_SHARE: u32 = 20;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Training to run: a file or a name
    #[arg(value_parser = crate::scenario_files::file_of(Kind::of::<Training>()))]
    training: PathBuf,
    /// Folder for the policy and all tables [default: runs/train/NAME]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Resumes the training in the output folder; the result is the same as without interruption
    #[arg(long)]
    resume: bool,
    /// Stops after this many samples, as with Ctrl-C
    #[arg(long, value_name = "SAMPLES", value_parser = whole::<u64>(0, u64::MAX))]
    until: Option<u64>,
    /// Random seed [default: the seed in the file]
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0, i64::MAX as u64))]
    seed: Option<u64>,
    #[command(flatten)]
    jobs: JobsArgs,
    /// Records every Nth episode to games/ in the output folder, for `squall replay`; does not
    /// affect the policy
    #[arg(long, value_name = "N", value_parser = whole::<NonZeroU64>(1, u64::MAX))]
    record_every: Option<NonZeroU64>,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut training = scenario::load_file::<Training>(&args.training)?;
    training.seed = args.seed.unwrap_or(training.seed);
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("runs/train").join(&training.name));
    // Learning uses all threads, however few games are played.
    let jobs = args.jobs.threads(usize::MAX).get();
    let stop = stop::on_ctrl_c()?;
    // The samples in the saved state; locked while the files of an update are incomplete.
    let saved = Arc::new(Mutex::new(0));
    let held = Arc::clone(&saved);
    stop::when_late(&stop, move || {
        let samples = held.lock().unwrap_or_else(PoisonError::into_inner);
        screen::remark(&stopped("during an update; saved", *samples));
        std::process::exit(130);
    });
    let mut trainer = begin(args, training, &folder, jobs)?;
    let kept = || saved.lock().unwrap_or_else(PoisonError::into_inner);
    *kept() = trainer.samples().0;
    let mut files = Files::open(&folder, &base(&args.training, trainer.training()), &trainer)?;
    let recordings = args
        .record_every
        .map(|every| record(&mut trainer, &folder, every))
        .transpose()?;
    let (done, all) = trainer.samples();
    let progress = Progress::of(all, "samples");
    progress.begin_at(done);
    let size = trainer.model().context("cannot export the policy")?.len();
    progress.print(&format!(
        "training {} in {}: model of {} kB",
        trainer.training().name,
        folder.display(),
        size / 1000
    ));
    if done > 0 {
        progress.print(&format!("resuming after {done} samples"));
    }
    let mut told_stage = None;
    let mut next_save = clock::now() + SAVE_EVERY;
    while !trainer.is_over() {
        let is_enough = args.until.is_some_and(|until| trainer.samples().0 >= until);
        if is_enough || stop.load(Ordering::Relaxed) {
            let _complete = kept();
            progress.end();
            let samples = trainer.samples().0;
            if samples > done {
                files.keep_state(samples, &trainer.state())?;
            }
            screen::remark(&stopped("after", samples));
            return Ok(if is_enough {
                ExitCode::SUCCESS
            } else {
                stop::interrupted()
            });
        }
        let update = trainer.update()?;
        let mut complete = kept();
        let stage = &trainer.training().stage[update.stage].name;
        if told_stage.replace(update.stage) != Some(update.stage) {
            progress.print(&format!("stage {stage}"));
        }
        progress.set(update.samples);
        files.update(&trainer, &update)?;
        recordings
            .iter()
            .flat_map(|log| log.take_problems())
            .for_each(|problem| progress.print(&problem));
        if let Some(evaluated) = &update.evaluated {
            files.models(&trainer, update.is_best)?;
            progress.print(&line(evaluated, update.is_best));
            let how = play_command(&trainer, &folder).filter(|_| update.is_best);
            how.iter()
                .for_each(|how| progress.print(&format!("           {how}")));
        }
        let began = clock::now();
        if update.games_restart || began >= next_save {
            files.keep_state(update.samples, &trainer.state())?;
            *complete = update.samples;
            next_save = clock::now() + SAVE_EVERY.max(began.elapsed() * SAVE_SHARE);
        }
    }
    progress.end();
    finish(&trainer, &folder)
}

fn stopped(when: &str, samples: u64) -> String {
    let next = if samples > 0 {
        "; --resume continues from there"
    } else {
        ""
    };
    format!("stopped {when} {samples} samples{next}")
}

/// The strategy whose helm uses the policy: that of the last stage that names one or, by default,
/// `policy.toml` in the folder of strategies next to the training file's folder.
fn base(file: &Path, training: &Training) -> PathBuf {
    let helm = training
        .stage
        .iter()
        .rev()
        .find_map(|stage| stage.helm.clone());
    let beside = || {
        file.parent()
            .unwrap_or(Path::new(""))
            .join("..")
            .join(Kind::STRATEGY.folder())
            .join("policy.toml")
    };
    helm.unwrap_or_else(beside)
}

fn begin(args: &Args, training: Training, folder: &Path, jobs: usize) -> Result<Trainer> {
    let path = Files::state(folder);
    if args.resume {
        let state = primitives::input_file::read(&path, STATE_BYTES_MAX);
        let state = state.with_context(|| {
            format!(
                "cannot read {}, from which --resume continues",
                path.display()
            )
        })?;
        return Trainer::resume(training, jobs, &state).with_context(|| path.display().to_string());
    }
    if path.exists() {
        bail!(
            "{} already contains a training run; continue it with --resume, or choose another folder with --out",
            folder.display()
        );
    }
    Ok(Trainer::new(training, jobs)?)
}

/// Records every `every`-th episode; returns the recording errors.
fn record(trainer: &mut Trainer, folder: &Path, every: NonZeroU64) -> Result<Arc<RecordingLog>> {
    let folder = Files::games(folder);
    let log = Arc::<RecordingLog>::default();
    check_recording_folder(&folder)
        .with_context(|| format!("cannot record to {}", folder.display()))?;
    let names = RecordingNames::ByNumber;
    let commit = env!("SQUALL_COMMIT").to_owned();
    trainer.watch(
        Recordings {
            folder,
            names,
            every: every.get(),
            commit,
        }
        .watches(Arc::clone(&log)),
    )?;
    Ok(log)
}

/// An evaluation, on one line.
fn line(evaluated: &Evaluated, is_best: bool) -> String {
    let against = |(name, played): &(String, Played)| {
        let [won, drawn, lost] = played.results;
        let [own, theirs] = played.points;
        format!(
            "{name} {won}-{drawn}-{lost}, {own:.1} : {theirs:.1}, out {:.1}",
            played.left_field
        )
    };
    let all: Vec<String> = evaluated.played.iter().map(against).collect();
    let best = if is_best { "  best" } else { "" };
    format!(
        "{:>8.2} M  won {:>3.0} %  {}{best}",
        evaluated.samples as f64 * 1e-6,
        100.0 * evaluated.won(),
        all.join("; ")
    )
}

/// The command that plays the best policy in the game of the last stage.
fn play_command(trainer: &Trainer, folder: &Path) -> Option<String> {
    let strategy = folder.join("best.toml");
    let stage = trainer.training().stage.last()?;
    let sea = stage
        .sea
        .as_ref()
        .map_or(String::new(), |sea| format!(" --sea {}", argument_for(sea)));
    let command = || {
        format!(
            "squall run {}{sea} --blue {}",
            argument_for(&stage.game),
            argument_for(&strategy)
        )
    };
    strategy.exists().then(command)
}

fn finish(trainer: &Trainer, folder: &Path) -> Result<ExitCode> {
    let Some(best) = trainer.best() else {
        return Ok(ExitCode::SUCCESS);
    };
    let digest = onnx::Network::read(&best.onnx)
        .context("cannot export the policy")?
        .digest();
    let samples = best.samples;
    let won = 100.0 * best.won;
    let mut text = format!("best after {samples} samples: won {won:.0} %, digest {digest:032x}\n");
    if let Some(how) = play_command(trainer, folder) {
        text += &format!("play it with: {how}\n");
    }
    screen::print(&text);
    output_file::write(
        &folder.join("digest.txt"),
        "the digest",
        format!("{digest:032x}\n"),
    )?;
    Ok(ExitCode::SUCCESS)
}
