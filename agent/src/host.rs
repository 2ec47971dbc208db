//! A competition entry as the mind of boats: a separate Python process decides for the boats of a
//! team. In that process, `host.py` translates between Squall and the entry's interface.
//!
//! As with MOOS boats, this is an exception among minds: decisions come from outside, and the wait
//! for them is limited by the wall clock. Without an answer in time, the boat stops.

use crate::mind::Mind;
use crate::pilot::{Pilot, Spaces};
use crate::policy::Due;
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::angle::wrap_pi;
use primitives::{SimTime, TeamId, VehicleId};
use rules::Field;
use scenario::Scenario;
use scenario::action::{Action, ActionSpace, SetPoint};
use scenario::observation::ObservationSpace;
use scenario::strategy::{Host, Program};
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The program that runs entries; passed as a string, so that it needs no installation.
const PROGRAM: &str = include_str!("host.py");
/// Maximum time for an entry to load its networks and libraries.
const LOAD_LIMIT: Duration = Duration::from_secs(60);
/// Maximum time for an entry to end once the game is over, before it is killed.
const END_LIMIT: Duration = Duration::from_secs(1);
/// Number of consecutive decisions without an answer in time after which an entry is no longer
/// asked; otherwise a game could take hours.
const LATE_MAX: u32 = 3;
/// Maximum number of outdated answers before the answer to the last request.
const OUTDATED_MAX: usize = 64;
/// Maximum size of an answer, bytes.
const ANSWER_MAX: u64 = 4096;
/// The action of a boat without an answer: Pyquaticus' stop.
const STOP: usize = 16;

/// The entries of one group of minds, by team.
#[derive(Default)]
pub(crate) struct Entries(Vec<(TeamId, Host, Arc<Mutex<Entry>>)>);

impl Entries {
    /// The entry for a vehicle; starts it for the first vehicle of a team.
    pub(crate) fn entry(
        &mut self,
        scenario: &Scenario,
        vehicle: VehicleId,
        host: &Host,
    ) -> Arc<Mutex<Entry>> {
        let team = scenario.team_of(vehicle);
        let mut known = self.0.iter();
        if let Some((.., entry)) = known.find(|(t, h, _)| *t == team && h == host) {
            return Arc::clone(entry);
        }
        let entry = Arc::new(Mutex::new(Entry::start(scenario, team, host)));
        self.0.push((team, host.clone(), Arc::clone(&entry)));
        entry
    }
}

/// An entry's process, or the reason why it is not running.
pub(crate) struct Entry {
    process: Result<Process, String>,
    limit: Duration,
    /// Number of consecutive decisions without an answer in time.
    late: u32,
}

/// A running entry.
struct Process {
    child: Child,
    stdin: Option<ChildStdin>,
    answers: Receiver<Vec<u8>>,
    /// The number of the last request.
    number: u64,
}

/// A line of output from the entry's process.
#[derive(Deserialize)]
struct Answer {
    number: u64,
    action: Option<Chosen>,
    error: Option<String>,
}

/// An entry's choice.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
enum Chosen {
    /// The index of one of the discrete actions.
    Index(usize),
    /// A speed in m/s and a turn in degrees clockwise.
    Turn([f64; 2]),
}

impl Entry {
    fn start(scenario: &Scenario, team: TeamId, host: &Host) -> Entry {
        let process = if host.is_allowed {
            Process::start(scenario, team, host)
        } else {
            Err("this process may not run it; to allow it, use --host".to_owned())
        };
        Entry {
            process,
            limit: Duration::from_secs_f64(host.limit_s),
            late: 0,
        }
    }

    /// The entry's choice for a boat.
    ///
    /// # Errors
    /// The reason why there is no choice.
    fn ask(&mut self, request: Value) -> Result<Chosen, String> {
        let process = self.process.as_mut().map_err(|why| why.clone())?;
        let answer = process.ask(request, self.limit);
        match answer {
            Ok(answer) => {
                self.late = 0;
                let wrong = || "it returned no action".to_owned();
                answer
                    .action
                    .ok_or_else(|| answer.error.unwrap_or_else(wrong))
            }
            Err(RecvTimeoutError::Timeout) => {
                let late = format!("no answer within {:?}", self.limit);
                self.late += 1;
                if self.late == LATE_MAX {
                    self.process = Err(format!("{late}, {LATE_MAX} times in a row"));
                }
                Err(late)
            }
            Err(RecvTimeoutError::Disconnected) => {
                let ended = "its process has ended".to_owned();
                self.process = Err(ended.clone());
                Err(ended)
            }
        }
    }
}

impl Process {
    fn start(scenario: &Scenario, team: TeamId, host: &Host) -> Result<Process, String> {
        let mut child = Command::new(&host.python)
            .args(["-B", "-c", PROGRAM, "--serve", &host.path])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("cannot start {}: {error}", host.python))?;
        let (sender, answers) = sync_channel(OUTDATED_MAX);
        if let Some(stdout) = child.stdout.take() {
            std::thread::spawn(move || pass_lines(stdout, &sender));
        }
        let mut process = Process {
            stdin: child.stdin.take(),
            child,
            answers,
            number: 0,
        };
        process.send(&game_of(scenario, team, host));
        match process.answer(LOAD_LIMIT) {
            Ok(Answer { error: None, .. }) => Ok(process),
            Ok(Answer {
                error: Some(error), ..
            }) => Err(format!("cannot be loaded: {error}")),
            Err(RecvTimeoutError::Timeout) => Err(format!("not loaded within {LOAD_LIMIT:?}")),
            Err(RecvTimeoutError::Disconnected) => Err(format!(
                "{} ended while loading it; does it have numpy?",
                host.python
            )),
        }
    }

    fn send(&mut self, message: &Value) {
        if let Some(stdin) = &mut self.stdin {
            // If the process no longer reads, it has ended, and no answer will arrive.
            let _ = writeln!(stdin, "{message}").and_then(|()| stdin.flush());
        }
    }

    fn ask(&mut self, mut request: Value, limit: Duration) -> Result<Answer, RecvTimeoutError> {
        self.number += 1;
        request["number"] = self.number.into();
        self.send(&request);
        self.answer(limit)
    }

    /// The answer to the last request; answers to earlier ones are too late.
    fn answer(&self, limit: Duration) -> Result<Answer, RecvTimeoutError> {
        for _ in 0..OUTDATED_MAX {
            let line = self.answers.recv_timeout(limit)?;
            let answer = serde_json::from_slice(&line);
            let answer = answer.unwrap_or_else(|_| Answer {
                number: self.number,
                action: None,
                error: Some("it wrote to the pipe that carries its actions".to_owned()),
            });
            if answer.number == self.number {
                return Ok(answer);
            }
        }
        Err(RecvTimeoutError::Timeout)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.stdin = None;
        for _ in 0..OUTDATED_MAX {
            if self.answers.recv_timeout(END_LIMIT).is_err() {
                break;
            }
        }
        // A process that has already ended cannot be killed; the wait only reaps it.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Forwards the lines of a process until it ends.
fn pass_lines(stdout: ChildStdout, sender: &SyncSender<Vec<u8>>) {
    let mut stdout = BufReader::new(stdout);
    loop {
        let mut line = vec![];
        let read = (&mut stdout).take(ANSWER_MAX).read_until(b'\n', &mut line);
        if read.unwrap_or(0) == 0 || sender.send(line).is_err() {
            return;
        }
    }
}

/// The first request: everything that is constant during a game, in Pyquaticus' frame.
fn game_of(scenario: &Scenario, team: TeamId, host: &Host) -> Value {
    let field = &scenario.field;
    let teams = [TeamId(0), TeamId(1)];
    let all = || (0..scenario.vehicles.len()).map(VehicleId::at);
    let count = |team| all().filter(|v| scenario.team_of(*v) == team).count();
    let (boats, flags_m) = (teams.map(count), flags_m(field, SimTime::ZERO));
    let is_of_2026 = |space| space == ObservationSpace::Pyquaticus2026;
    let has_power_play = scenario.rules.power_play != SimTime::ZERO;
    let has_disabled = host.observation.map_or(has_power_play, is_of_2026);
    let speeds = all().map(|v| scenario.boat_of(v).speed_max_m_s());
    json!({
        "seed": scenario.seed,
        "team": team.index(),
        "boats": boats,
        "field_m": [field.plan.width_m, field.plan.depth_m],
        "flags_m": flags_m,
        "top_m_s": speeds.fold(0.0, f64::max),
        "cooldown_s": scenario.rules.tag_cooldown.as_s(),
        "score_max": crate::situation::score_max(scenario),
        "has_disabled": has_disabled,
    })
}

/// The home of each team's first flag, along and across the field, m.
fn flags_m(field: &Field, now: SimTime) -> [Option<[f64; 2]>; 2] {
    [TeamId(0), TeamId(1)].map(|team| {
        let flag = field.own_flags(team).next();
        flag.map(|(_, flag)| field.along_across(flag.home(now)).into())
    })
}

/// The mind of a boat for which an entry decides.
pub(crate) struct HostMind {
    pilot: Pilot,
    entry: Arc<Mutex<Entry>>,
    name: String,
    period: SimTime,
    due: Due,
    faults: Option<(String, u64)>,
}

impl HostMind {
    /// The mind of a boat whose program has an entry, which steers directly or through the helm.
    pub(crate) fn new(
        scenario: &Scenario,
        vehicle: VehicleId,
        (program, is_direct): (&Program, bool),
        entry: Arc<Mutex<Entry>>,
    ) -> HostMind {
        // The entry's process drops the values that its competition year does not have.
        let spaces = Spaces {
            observation: ObservationSpace::Pyquaticus2026,
            action: ActionSpace::Pyquaticus,
        };
        let host = program.host();
        let period_s = host.and_then(|host| host.period_s);
        HostMind {
            pilot: if is_direct {
                Pilot::direct(scenario, vehicle, spaces)
            } else {
                Pilot::helm(scenario, vehicle, program, spaces)
            },
            entry,
            name: host.map_or(String::new(), |host| host.path.clone()),
            period: period_s.map_or(SimTime::ZERO, SimTime::from_s),
            due: Due::default(),
            faults: None,
        }
    }

    fn choose(&mut self, picture: &Picture) {
        let observation = self.pilot.observe(picture).iter();
        let observation: Vec<f64> = observation.map(|number| f64::from(*number)).collect();
        let situation = self.pilot.situation();
        let field = &situation.model.field;
        let heading_rad = primitives::math::atan2(
            situation.ahead.dot(field.along),
            situation.ahead.dot(field.across),
        );
        let at_m = <[f64; 2]>::from(field.along_across(situation.at));
        let (psi_rad, top_m_s) = (situation.own.nav.psi_rad, situation.model.speed_max_m_s);
        let numbered = |index: usize| {
            ActionSpace::Pyquaticus.set_point(Action::Discrete(index), psi_rad, top_m_s)
        };
        let mut request = json!({
            "boat": situation.model.rank,
            "at_m": at_m,
            "heading_deg": heading_rad.to_degrees(),
            "observation": observation,
        });
        let mut flags = field.flags.iter();
        if flags.any(|flag| flag.settings.route.is_some()) {
            request["flags_m"] = json!(flags_m(field, situation.now));
        }
        let set_point = match locked(&self.entry).ask(request) {
            Ok(Chosen::Index(index)) => numbered(index),
            Ok(Chosen::Turn([speed_m_s, turn_deg])) => SetPoint {
                turn_rad: turn_deg.to_radians(),
                course_rad: wrap_pi(psi_rad + turn_deg.to_radians()),
                speed_m_s: speed_m_s.clamp(0.0, top_m_s),
            },
            Err(why) => {
                let (_, count) = self.faults.get_or_insert((why, 0));
                *count += 1;
                numbered(STOP)
            }
        };
        self.pilot.steer(set_point);
    }
}

fn locked(entry: &Mutex<Entry>) -> MutexGuard<'_, Entry> {
    entry.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Mind for HostMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        let now = picture.stamp.valid_ns;
        if self.due.is_due(now) {
            self.due.advance(now, self.period);
            self.choose(picture);
        }
        self.pilot.decide(picture)
    }

    fn shares(&self) -> bool {
        self.pilot.shares()
    }

    fn send(&self, messages: &mut Vec<Word>) {
        self.pilot.send(messages);
    }

    fn receive(&mut self, messages: &[Word]) {
        self.pilot.receive(messages);
    }

    fn show(&mut self, shown: bool) {
        self.pilot.show(shown);
    }

    fn faults(&self) -> Option<(String, u64)> {
        let (first, count) = self.faults.as_ref()?;
        Some((format!("the entry {}: {first}", self.name), *count))
    }

    fn report(&self) -> Option<HelmReport> {
        self.pilot.report()
    }
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;

    /// An entry whose Python interpreter is a shell script that loads, then runs `body` for request
    /// `$n`.
    fn entry(folder: &Path, body: &str, is_allowed: bool) -> Entry {
        let game = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/attack_1v1.toml");
        let scenario = scenario::load(&game).unwrap_or_else(|problems| panic!("{problems}"));
        let python = folder.join("python");
        let loaded = r#"read game; echo '{"number":0,"action":0}'; n=0"#;
        let all = "while read request; do n=$((n+1))";
        std::fs::write(
            &python,
            format!("#!/bin/sh\n{loaded}\n{all}\n{body}\ndone\n"),
        )
        .unwrap();
        std::fs::set_permissions(&python, PermissionsExt::from_mode(0o755)).unwrap();
        let host = Host {
            path: "entry".to_owned(),
            python: python.display().to_string(),
            limit_s: 0.3,
            observation: None,
            period_s: None,
            is_allowed,
        };
        Entry::start(&scenario, TeamId(0), &host)
    }

    #[test]
    fn a_late_wrong_or_dead_entry_costs_only_its_own_decisions() {
        let answer = |what: &str| format!(r#"echo "{{\"number\":$n,{what}}}""#);
        let late = "no answer within 300ms";
        let after = format!("{late}, 3 times in a row");
        let error = |why: &str| Err(why.to_owned());
        for (body, want) in [
            (answer(r#"\"action\":4"#), [Ok(Chosen::Index(4)), Ok(Chosen::Index(4))]),
            (
                answer(r#"\"action\":[1.5,-30]"#),
                [Ok(Chosen::Turn([1.5, -30.0])), Ok(Chosen::Turn([1.5, -30.0]))],
            ),
            (answer(r#"\"error\":\"why\""#), [error("why"), error("why")]),
            (answer(r#"\"action\":null"#), [error("it returned no action"), error("it returned no action")]),
            (
                "if [ $n = 2 ]; then echo '{\"number\":1,\"action\":9}'; echo '{\"number\":2,\"action\":3}'; else echo x; fi".to_owned(),
                [error("it wrote to the pipe that carries its actions"), Ok(Chosen::Index(3))],
            ),
            ("exit 1".to_owned(), [error("its process has ended"), error("its process has ended")]),
            ("exec sleep 600".to_owned(), [error(late), error(late)]),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let mut entry = entry(folder.path(), &body, true);
            assert_eq!([(); 2].map(|()| entry.ask(json!({}))), want, "{body}");
            if want[0] == error(late) {
                assert_eq!([(); 2].map(|()| entry.ask(json!({}))), [error(late), error(&after)]);
            }
        }
    }

    #[test]
    fn an_entry_that_another_process_names_is_not_started() {
        let folder = tempfile::tempdir().unwrap();
        let made = folder.path().join("made");
        let body = format!(
            "touch {}; echo '{{\"number\":1,\"action\":3}}'",
            made.display()
        );
        for is_allowed in [false, true] {
            let answer = entry(folder.path(), &body, is_allowed).ask(json!({}));
            assert_eq!((answer.is_ok(), made.exists()), (is_allowed, is_allowed));
        }
    }
}
