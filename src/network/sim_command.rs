//! `squall sim`: serves one game.

use super::hub_args::{HubArgs, token_text, unique_game_name};
use super::pace_args::PaceArgs;
use crate::game_args::GameArgs;
use crate::screen::{self, Screen};
use crate::stop;
use crate::style::Names;
use anyhow::{Context, Result, bail};
use bus::Token;
use command_line::printer::Printer;
use messages::topic::GameName;
use recording::NewFile;
use sim::node::{GameRecorder, ProgressMessage, Settings};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    play: GameArgs,
    #[command(flatten)]
    pace: PaceArgs,
    /// Records the game to this file, which must not already exist
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Name of the game on the network [default: the file name and a random number]
    #[arg(long, value_name = "NAME", value_parser = GameName::new)]
    game: Option<GameName>,
    /// Simulates only the water and these boats, without a referee, for `squall gateway emulate`
    /// and `squall gateway sitl`
    #[arg(long, value_name = "NAME", num_args = 1..)]
    afloat: Vec<String>,
    #[command(flatten)]
    hub: HubArgs,
    /// Prints all reports as JSON lines, and exits when standard input closes
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let scenario = args.play.load()?;
    let seed = args.play.seed(&scenario);
    let scenario = if args.afloat.is_empty() {
        scenario
    } else {
        sim::afloat(&scenario, seed, &args.afloat)?
    };
    args.play.check_result_file()?;
    if !args.for_parent {
        args.play.remark_on_rehearsal()?;
    }
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    let game = match &args.game {
        Some(game) => game.clone(),
        None => unique_game_name(&scenario.name)?,
    };
    let net = args.hub.net()?;
    let token = net.token.clone();
    let mut screen = Screen::new(Names::of(&scenario));
    let for_parent = args.for_parent;
    let shown = token.clone();
    let printer = Printer::start(move |message| {
        if for_parent {
            screen::print(&(serde_json::to_string(message).expect("a message is JSON") + "\n"));
        } else {
            screen.show(message);
            if let (ProgressMessage::Open { .. }, Some(token)) = (message, &shown) {
                screen.line(&token_text(token));
            }
        }
    });
    let entry = bus::Entry {
        game: game.as_str().to_owned(),
        endpoint: net.local_endpoint().unwrap_or_default(),
        pid: std::process::id(),
        token: token.as_ref().map(Token::hex),
        is_water: !args.afloat.is_empty(),
    };
    let record = |path: &PathBuf| {
        let file = if args.for_parent {
            NewFile::of_child(path)
        } else {
            NewFile::create(path)
        };
        let file = file.with_context(|| format!("cannot record to {}", path.display()))?;
        anyhow::Ok(GameRecorder::on_network(
            file,
            game.as_str(),
            &args.pace.pace.to_string(),
            env!("SQUALL_COMMIT"),
        ))
    };
    let mut recorder = args.record.as_ref().map(record).transpose()?;
    let settings = Settings {
        game,
        net,
        pace: args.pace.pace,
        join_limit: Duration::from_secs_f64(args.pace.join_s),
        speed: args.pace.speed,
        stop: stop.clone(),
    };
    // Register before the sim answers, so that a node that finds the game also finds its token. If
    // registration fails, users only have to pass the game's address.
    let registration = bus::register(&entry);
    if let Err(error) = &registration {
        screen::remark(&format!(
            "the game can be found only by its address: {error}"
        ));
    }
    let tell = &mut |message| printer.print(message);
    let mut report = sim::node::serve(&scenario, seed, &settings, recorder.as_mut(), tell)?;
    drop(registration);
    report.run.recording_problem = recorder.and_then(|recorder| recorder.end(&report).problem());
    let written = args.play.write_result(&report);
    let cut_short = report.run.cut_short;
    let problem = report.run.recording_problem.clone();
    printer.end(ProgressMessage::Done(Box::new(report)));
    written?;
    // A parent reads the problem from the report and prints it itself.
    if let (Some(problem), false) = (problem, args.for_parent) {
        bail!(problem);
    }
    Ok(if cut_short {
        stop::interrupted()
    } else {
        ExitCode::SUCCESS
    })
}
