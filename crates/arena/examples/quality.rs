//! How sensibly the strategies of a tournament play, and who wins: `squall tournament --quality` without the rest of Squall.
//!
//! `cargo run --release -p squall-arena --example quality -- TOURNAMENT [GAMES] [SEED] [JOBS]` plays so many games a pairing; by
//! default as many as the file says, from its seed on, on one thread. The same seeds are the same games.

use agent::MindRunner;
use analysis::Step;
use analysis::quality::{GameQuality, MindState, Quality};
use arena::tournament::{Observer, Plan, Report, play_observed};
use messages::Order;
use rules::event::EventCursor;
use scenario::{Scenario, load_tournament};
use sim::Contest;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::AtomicBool;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| args.get(i).and_then(|arg| arg.parse().ok());
    let mut tournament = load_tournament(Path::new(&args[0])).unwrap_or_else(|e| panic!("{e}"));
    tournament.games = number(1).unwrap_or(u64::from(tournament.games)) as u32;
    tournament.seed = number(2).unwrap_or(tournament.seed);
    let jobs = number(3).and_then(|jobs| NonZeroUsize::new(jobs as usize)).unwrap_or(NonZeroUsize::MIN);
    let plan = Plan::new(&tournament).unwrap_or_else(|e| panic!("{e}"));
    let observer = Observer {
        begin: |scenario: &Scenario| (GameQuality::new(scenario), EventCursor::default()),
        see: |(quality, cursor): &mut (GameQuality, EventCursor), contest: &Contest, runner: &MindRunner| {
            let minds: Vec<_> = runner.minds().map(|(_, mind)| mind.report().map(MindState::from)).collect();
            let orders = runner.orders().map(|(_, order): (_, Order)| order);
            quality.add(&Step::of_frame(contest.scenario(), &contest.frame(cursor), orders), &minds);
        },
    };
    let (mut records, mut sum) = (vec![], Quality::default());
    for (record, seen) in play_observed(&plan, jobs, &AtomicBool::new(false), &observer, |_| ()) {
        seen.into_iter().for_each(|(quality, _)| sum.merge(&quality.end()));
        records.push(record);
    }
    print!("{sum}");
    let report = Report::new(&plan, &records);
    println!("\nscore a game, and won, drawn and lost");
    for row in &report.entries {
        let half = row.score.half_width().unwrap_or(f64::NAN);
        println!(
            "{:24}{:>7.2} ± {half:<5.2}{:>6}{:>6}{:>6}",
            row.name, row.score.mean, row.wins, row.draws, row.losses
        );
    }
    for cell in report.matrix.iter().filter(|cell| cell.row < cell.column) {
        let (row, column, games) = (&cell.row, &cell.column, cell.games);
        println!("{row} - {column}: {} won of {games}, {:+.2} a game", cell.wins, cell.score_difference);
    }
}
