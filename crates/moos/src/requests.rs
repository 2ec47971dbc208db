//! Answers to requests for tags and grabs. Only the referee decides; it judges by positions and
//! needs no request. The answer to a request states the referee's decision, or why the rules do not
//! allow the request.

use crate::community::Value;
use messages::Picture;
use messages::picture::OwnBoat;
use primitives::{SimTime, VehicleId};
use rules::Ability;
use rules::event::{Event, TagCause};
use scenario::Scenario;

/// The variables with requests.
pub(crate) const READS: [&str; 2] = ["TAG_REQUEST", "FLAG_GRAB_REQUEST"];

/// The requests of one boat that await a decision, and the number of answers so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Requests {
    tag_until: Option<SimTime>,
    grab_until: Option<SimTime>,
    count: u64,
}

/// An answer: variable and value.
pub(crate) type Answer = (String, Value);

impl Requests {
    /// Answers a request at once if the rules do not allow it. Otherwise returns `None`, and
    /// [`Requests::judge`] answers later.
    pub(crate) fn receive(
        &mut self,
        scenario: &Scenario,
        picture: &Picture,
        own: &OwnBoat,
        (key, text): (&str, &str),
    ) -> Option<Answer> {
        let name = &scenario.vehicles[own.vehicle.index()].name;
        let asked_by = text
            .split(',')
            .find_map(|word| word.trim().strip_prefix("vname="));
        let is_own = asked_by == Some(name.as_str());
        let rules = &scenario.rules;
        let until = |look: SimTime| Some(picture.stamp.valid_ns + look + scenario.decision() * 2);
        if key == "TAG_REQUEST" {
            let refused = match own {
                _ if !is_own => Some("invalid_vehicle_name"),
                OwnBoat { tagged: true, .. } => Some("selftagged"),
                _ if !scenario
                    .field
                    .is_own_side(scenario.team_of(own.vehicle), own.nav.at()) =>
                {
                    Some("zone")
                }
                _ if !Ability::from(own).may_tag(picture.stamp.valid_ns) => Some("freq"),
                _ => None,
            };
            match refused {
                Some(reason) => Some(self.tag_answer(name, &format!("result=rejected_{reason}"))),
                None => {
                    self.tag_until = until(rules.tag_look_period);
                    None
                }
            }
        } else {
            let refused = match own {
                _ if !is_own => Some("invalid_vehicle_name"),
                OwnBoat { carrying: 0.., .. } => Some("vehicle already has flag"),
                OwnBoat { tagged: true, .. } => Some("vehicle is tagged"),
                _ if !Ability::from(own).acts() => Some("vehicle is out of play"),
                _ => None,
            };
            match refused {
                Some(reason) => Some(grab_answer(&format!("Nothing grabbed - {reason}"))),
                None => {
                    self.grab_until = until(rules.flag_look_period);
                    None
                }
            }
        }
    }

    /// The answers after a picture: the referee's decisions, requested or not, and rejections of
    /// requests that were not granted in time.
    pub(crate) fn judge(
        &mut self,
        scenario: &Scenario,
        picture: &Picture,
        own: VehicleId,
    ) -> Vec<Answer> {
        let name = |vehicle: VehicleId| scenario.vehicles[vehicle.index()].name.as_str();
        let mut answers = Vec::new();
        for event in picture
            .events
            .iter()
            .filter_map(messages::EventRecord::logged)
            .map(|logged| logged.event)
        {
            if !scenario.has(event) {
                continue;
            }
            match event {
                Event::Tagged {
                    vehicle,
                    cause: TagCause::Opponent(by),
                } if by == own => {
                    self.tag_until = None;
                    answers.push(self.tag_answer(name(own), &format!("tagged={}", name(vehicle))));
                }
                Event::Grabbed { vehicle, flag } if vehicle == own => {
                    self.grab_until = None;
                    let team = scenario.field.flags[flag.index()].team;
                    answers.push(grab_answer(&format!(
                        "grabbed={}",
                        scenario.teams[team.index()].name
                    )));
                }
                _ => {}
            }
        }
        let now = picture.stamp.valid_ns;
        if self.tag_until.take_if(|until| now >= *until).is_some() {
            answers.push(self.tag_answer(name(own), "tagged=none"));
        }
        if self.grab_until.take_if(|until| now >= *until).is_some() {
            answers.push(grab_answer("nothing_grabbed"));
        }
        answers
    }

    fn tag_answer(&mut self, name: &str, result: &str) -> Answer {
        self.count += 1;
        let text = format!("event={},source={name},{result}", self.count);
        (
            format!("TAG_RESULT_{}", name.to_uppercase()),
            Value::Text(text),
        )
    }
}

fn grab_answer(text: &str) -> Answer {
    ("FLAG_GRAB_REPORT".to_owned(), Value::Text(text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::EventRecord;
    use messages::Stamp;
    use messages::picture::Nav;
    use primitives::{FlagId, Ned};
    use rules::event::Logged;
    use std::path::Path;

    fn scenario() -> Scenario {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
        scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
    }

    fn at(point: Ned) -> OwnBoat {
        OwnBoat::new(
            VehicleId(0),
            Nav {
                north_m: point.north,
                east_m: point.east,
                ..Nav::default()
            },
        )
    }

    fn picture(s: f64, events: &[Event]) -> Picture {
        let now = SimTime::from_s(s);
        let record = |event: &Event| {
            EventRecord::from(Logged {
                tick: 1,
                at: now,
                event: *event,
            })
        };
        let stamp = Stamp {
            valid_ns: now,
            ..Stamp::default()
        };
        Picture {
            stamp,
            events: events.iter().map(record).collect(),
            ..Picture::default()
        }
    }

    fn text(answer: &Answer) -> &str {
        if let Value::Text(text) = &answer.1 {
            text
        } else {
            panic!("{answer:?}")
        }
    }

    #[test]
    fn requests_that_the_rules_do_not_allow_are_answered_at_once() {
        let scenario = scenario();
        let home = at(scenario.field.flags[0].start);
        let away = at(scenario.field.flags[1].start);
        let never = SimTime::from_s(1e6);
        for (own, key, value, want) in [
            (
                home,
                "TAG_REQUEST",
                "vname=red_one",
                "result=rejected_invalid_vehicle_name",
            ),
            (
                home,
                "TAG_REQUEST",
                "",
                "result=rejected_invalid_vehicle_name",
            ),
            (
                OwnBoat {
                    tagged: true,
                    ..home
                },
                "TAG_REQUEST",
                "vname=blue_one",
                "result=rejected_selftagged",
            ),
            (
                away,
                "TAG_REQUEST",
                "vname=blue_one",
                "result=rejected_zone",
            ),
            (
                OwnBoat {
                    tag_ready_ns: never,
                    ..home
                },
                "TAG_REQUEST",
                "vname=blue_one",
                "result=rejected_freq",
            ),
            (
                away,
                "FLAG_GRAB_REQUEST",
                "vname=x",
                "Nothing grabbed - invalid_vehicle_name",
            ),
            (
                OwnBoat {
                    carrying: 1,
                    ..away
                },
                "FLAG_GRAB_REQUEST",
                "vname=blue_one",
                "already has flag",
            ),
            (
                OwnBoat {
                    tagged: true,
                    ..away
                },
                "FLAG_GRAB_REQUEST",
                "vname=blue_one",
                "is tagged",
            ),
            (
                OwnBoat {
                    outside: true,
                    ..away
                },
                "FLAG_GRAB_REQUEST",
                "vname=blue_one",
                "out of play",
            ),
        ] {
            let answer =
                Requests::default().receive(&scenario, &picture(1.0, &[]), &own, (key, value));
            let answer = answer.unwrap_or_else(|| panic!("{key} {value} {own:?}"));
            assert!(text(&answer).contains(want), "{answer:?}, expected {want}");
        }
    }

    #[test]
    fn the_referees_decision_or_its_absence_is_the_answer() {
        let scenario = scenario();
        let own = at(scenario.field.flags[0].start);
        let mut requests = Requests::default();
        for key in READS {
            assert_eq!(
                requests.receive(&scenario, &picture(1.0, &[]), &own, (key, "vname=blue_one")),
                None,
                "{key}"
            );
        }
        assert_eq!(
            requests.judge(&scenario, &picture(1.1, &[]), own.vehicle),
            []
        );
        let none = requests.judge(&scenario, &picture(2.0, &[]), own.vehicle);
        assert_eq!(
            none.iter().map(text).collect::<Vec<_>>(),
            ["event=1,source=blue_one,tagged=none", "nothing_grabbed"]
        );
        assert_eq!(
            requests.judge(&scenario, &picture(3.0, &[]), own.vehicle),
            [],
            "once"
        );
        let tag = |by| Event::Tagged {
            vehicle: VehicleId(2),
            cause: TagCause::Opponent(VehicleId(by)),
        };
        let grab = |by| Event::Grabbed {
            vehicle: VehicleId(by),
            flag: FlagId(1),
        };
        let others = picture(3.5, &[tag(1), grab(1), tag(99)]);
        assert_eq!(
            requests.judge(&scenario, &others, own.vehicle),
            [],
            "other boats' successes"
        );
        let events = [tag(0), grab(0)];
        let decided = requests.judge(&scenario, &picture(4.0, &events), own.vehicle);
        assert_eq!(
            decided
                .iter()
                .map(|answer| answer.0.as_str())
                .collect::<Vec<_>>(),
            ["TAG_RESULT_BLUE_ONE", "FLAG_GRAB_REPORT"]
        );
        assert_eq!(
            decided.iter().map(text).collect::<Vec<_>>(),
            ["event=2,source=blue_one,tagged=red_one", "grabbed=red"]
        );
    }
}
