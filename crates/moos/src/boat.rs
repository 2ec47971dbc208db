//! A boat as a MOOS community: its mind publishes each picture as variables, and orders what the
//! community's applications request.

use crate::back_seat::{self, BackSeat};
use crate::clock::MoosClock;
use crate::community::{Community, Value};
use crate::game::{self, flag_of};
use crate::requests::{self, Requests};
use crate::wire::DRAWINGS;
use agent::Mind;
use bus::Watched;
use gateway::geodesy::LocalFrame;
use messages::picture::{Contact, Nav, OwnBoat};
use messages::{Order, Picture};
use primitives::angle::compass_deg_from_rad;
use primitives::{SimTime, VehicleId, math};
use rules::Ability;
use scenario::Scenario;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The variables of a community that the bridge reads.
pub fn reads() -> BTreeSet<String> {
    back_seat::READS
        .iter()
        .chain(&requests::READS)
        .chain(&DRAWINGS)
        .chain(&["IVPHELM_STATE"])
        .map(|name| (*name).to_owned())
        .collect()
}

/// Maximum number of drawings waiting for the shoreside.
const DRAWINGS_MAX: usize = 256;
/// Silence (s) after which a helm that reports again counts as restarted.
const HELM_SILENCE_S: f64 = 3.0;

/// The initial values of a community, so that no operator must press a button to begin a game.
const START: [(&str, bool); 5] = [
    ("DEPLOY", true),
    ("RETURN", false),
    ("STATION_KEEP", false),
    ("MOOS_MANUAL_OVERRIDE", false),
    ("MOOS_MANUAL_OVERIDE", false),
];

/// The mind of a boat that MOOS applications control. The applications follow a clock, so the game
/// must be paced by a clock too.
pub struct BoatMind {
    scenario: Arc<Scenario>,
    frame: LocalFrame,
    vehicle: VehicleId,
    community: Arc<Watched<Community>>,
    moos: MoosClock,
    back_seat: BackSeat,
    requests: Requests,
    /// The time of the last published sighting of each contact.
    seen: BTreeMap<VehicleId, SimTime>,
    has_begun: bool,
    /// When the helm last reported its state.
    helm_at: Option<SimTime>,
    /// Whether the boat was at its own flag in the last picture.
    was_home: bool,
}

impl BoatMind {
    /// The mind of `vehicle`, whose applications are in this community.
    pub fn new(
        scenario: Arc<Scenario>,
        vehicle: VehicleId,
        community: Arc<Watched<Community>>,
        moos: MoosClock,
    ) -> BoatMind {
        BoatMind {
            frame: LocalFrame::new(scenario.field.plan.datum),
            scenario,
            vehicle,
            community,
            moos,
            back_seat: BackSeat::default(),
            requests: Requests::default(),
            seen: BTreeMap::new(),
            has_begun: false,
            helm_at: None,
            was_home: false,
        }
    }

    fn step(&mut self, community: &mut Community, picture: &Picture, own: &OwnBoat) -> Order {
        let now = picture.stamp.valid_ns;
        if !self.has_begun && community.is_reachable() {
            self.has_begun = true;
            // Discard the mission's own initial values, such as `DEPLOY = false`.
            drop(community.take_heard());
            for (key, value) in START {
                community.publish(key, flag_of(value));
            }
            community.publish("AQUATICUS_GAME", Value::Text("play".to_owned()));
        }
        self.publish_nav(community, own);
        self.publish_others(community, picture);
        self.publish_game(community, picture, own);
        let mut answers = self.requests.judge(&self.scenario, picture, self.vehicle);
        for msg in community.take_heard() {
            if msg.key == "IVPHELM_STATE" {
                let before = self.helm_at.replace(now);
                if before.is_none_or(|before| (now - before).as_s() > HELM_SILENCE_S) {
                    // Publish everything again: a mission's own initial values may have replaced
                    // those of the game.
                    community.forget_all();
                }
            } else if DRAWINGS.contains(&msg.key.as_str()) {
                community.drawings.push(msg);
                let excess = community.drawings.len().saturating_sub(DRAWINGS_MAX);
                community.drawings.drain(..excess);
            } else if !self.back_seat.receive(&msg, now) {
                let text = (msg.key.as_str(), msg.as_text().unwrap_or_default());
                answers.extend(self.requests.receive(&self.scenario, picture, own, text));
            }
        }
        for (key, value) in answers {
            community.publish(&key, value);
        }
        let order = self.back_seat.order(now, self.scenario.order_ttl_s);
        community.refusals = self.back_seat.refusals;
        order
    }

    fn publish_nav(&self, community: &mut Community, own: &OwnBoat) {
        let nav = &own.nav;
        let at = self.frame.lat_lon(nav.at());
        let heading_deg = compass_deg_from_rad(nav.psi_rad);
        let over_ground = nav.velocity_m_s();
        let course_rad = math::atan2(over_ground.east, over_ground.north);
        for (key, value) in [
            ("NAV_X", nav.east_m),
            ("NAV_Y", nav.north_m),
            ("NAV_LAT", at.lat_deg),
            ("NAV_LONG", at.lon_deg),
            ("NAV_HEADING", heading_deg),
            // Anticlockwise, rad, as published by MOOS simulators.
            ("NAV_YAW", -nav.psi_rad),
            ("NAV_SPEED", nav.speed_m_s()),
            ("NAV_HEADING_OVER_GROUND", compass_deg_from_rad(course_rad)),
            ("NAV_SPEED_OVER_GROUND", nav.speed_m_s()),
            ("NAV_DEPTH", 0.0),
        ] {
            community.publish(key, Value::Number(value));
        }
        let mode = if own.tagged {
            "TAGGED"
        } else {
            self.back_seat.mode()
        };
        self.report(
            community,
            "NODE_REPORT_LOCAL",
            (own.vehicle, nav, mode),
            self.moos.now_s(),
        );
    }

    /// Reports the teammates, and each new sighting of another boat with the time of the sighting.
    fn publish_others(&mut self, community: &mut Community, picture: &Picture) {
        let now_s = self.moos.now_s();
        for mate in picture
            .own
            .iter()
            .filter(|mate| mate.vehicle != self.vehicle)
        {
            let mode = mode_of(mate.tagged, mate.carrying);
            self.report(
                community,
                "NODE_REPORT",
                (mate.vehicle, &mate.nav, mode),
                now_s,
            );
        }
        for contact in &picture.contacts {
            let is_known = contact.vehicle.index() < self.scenario.vehicles.len();
            if is_known
                && self.seen.insert(contact.vehicle, contact.seen_ns) != Some(contact.seen_ns)
            {
                let seen_s = now_s - (picture.stamp.valid_ns - contact.seen_ns).as_s().max(0.0);
                let mode = mode_of(contact.tagged, contact.carrying);
                self.report(
                    community,
                    "NODE_REPORT",
                    (contact.vehicle, &nav_of(contact), mode),
                    seen_s,
                );
            }
        }
    }

    fn report(
        &self,
        community: &mut Community,
        key: &str,
        boat: (VehicleId, &Nav, &str),
        at_s: f64,
    ) {
        community.publish_at(
            key,
            game::node_report(&self.scenario, &self.frame, boat, at_s),
            at_s,
        );
    }

    fn publish_game(&mut self, community: &mut Community, picture: &Picture, own: &OwnBoat) {
        let scenario = &self.scenario;
        let team = scenario.team_of(own.vehicle);
        let field = &scenario.field;
        let (at, now) = (own.nav.at(), picture.stamp.valid_ns);
        let is_home = field
            .own_flags(team)
            .any(|(_, flag)| flag.home(now).distance(at) < scenario.rules.radii_of(flag).untag_m);
        if is_home && !std::mem::replace(&mut self.was_home, is_home) {
            // Missions set `TAGGED` themselves to send a boat home; publishing it again corrects
            // the value.
            ["TAGGED", "HAS_FLAG"]
                .iter()
                .for_each(|key| community.forget(key));
        }
        self.was_home = is_home;
        let is_intruder = |contact: &&Contact| {
            !contact.tagged && contact.team != team && field.is_own_side(team, nav_of(contact).at())
        };
        for (key, value) in [
            ("TAGGED", own.tagged),
            ("HAS_FLAG", own.carrying >= 0),
            ("ONFIELD", !own.outside),
            ("CANTAG", Ability::from(own).may_tag(picture.stamp.valid_ns)),
            ("SELF_IN_MY_ZONE", field.is_own_side(team, at)),
            (
                "ENEMY_IN_ZONE",
                picture.contacts.iter().any(|contact| is_intruder(&contact)),
            ),
        ] {
            community.publish_change(key, flag_of(value));
        }
        let own_tagged = picture
            .own
            .iter()
            .filter(|boat| boat.tagged)
            .map(|boat| boat.vehicle);
        let tagged = picture
            .contacts
            .iter()
            .filter(|boat| boat.tagged)
            .map(|boat| boat.vehicle);
        let mut tagged: Vec<VehicleId> = own_tagged.chain(tagged).collect();
        tagged.retain(|vehicle| vehicle.index() < scenario.vehicles.len());
        tagged.sort_unstable();
        game::publish(
            community,
            scenario,
            picture.stamp.valid_ns,
            (&picture.flags, &picture.score, &tagged),
            &mut |_| {},
        );
    }
}

impl Mind for BoatMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        let Some(own) = picture.own(self.vehicle).copied() else {
            return Order::Hold;
        };
        let community = Arc::clone(&self.community);
        community.visit(|community| self.step(community, picture, &own))
    }
}

/// Publishes the end of the game, for a helm that is still running.
pub(crate) fn publish_end(community: &mut Community) {
    community.publish("AQUATICUS_GAME", Value::Text("stop".to_owned()));
    community.publish("DEPLOY", flag_of(false));
    community.publish("MOOS_MANUAL_OVERRIDE", flag_of(true));
}

pub(crate) fn mode_of(is_tagged: bool, carrying: i16) -> &'static str {
    match (is_tagged, carrying) {
        (true, _) => "TAGGED",
        (false, 0..) => "CARRYING",
        (false, _) => "PLAYING",
    }
}

/// A contact's motion; its whole velocity is taken as surge.
fn nav_of(contact: &Contact) -> Nav {
    Nav {
        north_m: contact.north_m,
        east_m: contact.east_m,
        psi_rad: contact.psi_rad,
        surge_m_s: math::length(contact.velocity_north_m_s, contact.velocity_east_m_s),
        ..Nav::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::community::Address;
    use messages::Stamp;
    use messages::picture::FlagView;
    use primitives::TeamId;
    use std::path::Path;
    use std::time::Duration;

    const MOOS: MoosClock = MoosClock { warp: 1.0 };

    /// A picture in which the first boat is tagged and has sighted an opponent in its zone half a
    /// second earlier.
    fn picture(scenario: &Scenario, s: f64) -> Picture {
        let stamp = Stamp {
            valid_ns: SimTime::from_s(s),
            seq: 1,
            ..Stamp::default()
        };
        let at = scenario.field.flags[0].start;
        let nav = Nav {
            north_m: at.north + 20.0,
            east_m: at.east,
            psi_rad: 1.0,
            surge_m_s: 1.5,
            ..Nav::default()
        };
        let own = OwnBoat {
            tagged: true,
            ..OwnBoat::new(VehicleId(0), nav)
        };
        let contact = Contact {
            vehicle: VehicleId(2),
            team: TeamId(1),
            seen_ns: SimTime::from_s(s - 0.5),
            north_m: at.north,
            east_m: at.east,
            psi_rad: 0.0,
            velocity_north_m_s: 0.3,
            velocity_east_m_s: 0.4,
            tagged: false,
            carrying: 0,
        };
        let flags = vec![FlagView { carrier: 2 }, FlagView { carrier: -1 }];
        Picture {
            stamp,
            own: vec![own],
            contacts: vec![contact],
            flags,
            score: vec![0, 1],
            ..Picture::default()
        }
    }

    /// A boat and an application in its community that reads these variables.
    fn boat(scenario: &Scenario, variables: &[&str]) -> (BoatMind, Community) {
        let address: Address = ":0".parse().unwrap();
        let served = Community::open("blue_one", &address, reads(), MOOS).unwrap();
        let place = served
            .place
            .strip_prefix("MOOSDB at ")
            .expect("its address")
            .to_owned();
        let variables = variables.iter().map(|name| (*name).to_owned()).collect();
        let application =
            Community::open("peer", &Address::Connect(place), variables, MOOS).unwrap();
        let served = Arc::new(Watched::new(served));
        (
            BoatMind::new(Arc::new(scenario.clone()), VehicleId(0), served, MOOS),
            application,
        )
    }

    #[test]
    fn applications_read_pictures_as_variables_and_their_requests_become_orders() {
        let scenario = scenario();
        let flag = scenario.field.flags[0].start;
        let expected = [
            ("NAV_X", flag.east.to_string()),
            ("NAV_SPEED", "1.5".to_owned()),
            ("TAGGED", "true".to_owned()),
            ("HAS_FLAG", "false".to_owned()),
            ("ENEMY_IN_ZONE", "true".to_owned()),
            ("TAGGED_VEHICLES", "blue_one".to_owned()),
            ("BLUE_FLAG_GRABBED", "true".to_owned()),
            ("RED_SCORES", "1".to_owned()),
            ("AQUATICUS_GAME", "play".to_owned()),
            ("DEPLOY", "true".to_owned()),
        ];
        let names: Vec<&str> = expected
            .iter()
            .map(|(name, _)| *name)
            .chain(["NODE_REPORT"])
            .collect();
        let (mut mind, mut application) = boat(&scenario, &names);
        let mut values = BTreeMap::new();
        let start = bus::clock::now();
        let mut s = 1.0;
        while values.len() < names.len() || mind.decide(&picture(&scenario, s)) == Order::Hold {
            assert!(
                bus::clock::since(start) < Duration::from_secs(20),
                "{values:?}"
            );
            for msg in application.take_heard() {
                values.insert(
                    msg.key.clone(),
                    msg.as_text()
                        .map_or_else(|| msg.number.to_string(), str::to_owned),
                );
            }
            application.publish("DESIRED_HEADING", Value::Number(90.0));
            application.publish("DESIRED_SPEED", Value::Number(1.5));
            mind.decide(&picture(&scenario, s));
            bus::clock::rest(Duration::from_millis(10));
        }
        for (name, want) in &expected {
            assert_eq!(values.get(*name), Some(want), "{name}");
        }
        let report = &values["NODE_REPORT"];
        for part in [
            "NAME=red_one,",
            "SPD=0.50,",
            "HDG=0.00,",
            "GROUP=red,",
            "MODE=CARRYING,",
            "LAT=",
            "LON=",
            "COLOR=red",
        ] {
            assert!(report.contains(part), "{report} lacks {part}");
        }
        s += 2.0;
        let silent = picture(&scenario, s + scenario.order_ttl_s);
        drop(application);
        mind.decide(&picture(&scenario, s));
        assert_eq!(mind.decide(&silent), Order::Hold, "the helm is silent");
        assert_eq!(
            mind.decide(&Picture {
                own: vec![],
                ..silent
            }),
            Order::Hold,
            "its own boat is unknown"
        );
    }

    fn scenario() -> Scenario {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
        scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_helm_that_starts_late_gets_the_games_values_again_and_its_drawings_are_kept() {
        let scenario = scenario();
        let (mut mind, mut application) = boat(&scenario, &["ENEMY_IN_ZONE"]);
        let heard = |mind: &mut BoatMind, application: &mut Community| {
            let start = bus::clock::now();
            loop {
                mind.decide(&picture(&scenario, 1.0));
                if let Some(msg) = application.take_heard().pop() {
                    return msg.as_text().map(str::to_owned);
                }
                assert!(bus::clock::since(start) < Duration::from_secs(20));
                bus::clock::rest(Duration::from_millis(10));
            }
        };
        let wait_for = |mind: &BoatMind, application: &mut Community, presence| {
            let start = bus::clock::now();
            while mind.community.visit(|community| community.presence()) != presence {
                assert!(bus::clock::since(start) < Duration::from_secs(20));
                application.take_heard();
                bus::clock::rest(Duration::from_millis(10));
            }
        };
        wait_for(&mind, &mut application, (false, true));
        while !application.is_reachable() {
            bus::clock::rest(Duration::from_millis(10));
        }
        for (key, text) in [("DEPLOY", "false"), ("IVPHELM_STATE", "PARK")] {
            application.publish(key, Value::Text(text.to_owned()));
        }
        wait_for(&mind, &mut application, (true, true));
        mind.decide(&picture(&scenario, 1.0));
        assert_eq!(mind.back_seat.mode(), "DRIVE", "the game has begun");
        assert_eq!(heard(&mut mind, &mut application).as_deref(), Some("true"));
        for (key, text) in [
            ("ENEMY_IN_ZONE", "false"),
            ("VIEW_POINT", "x=1,y=2,label=one"),
            ("VIEW_POINT", "x=3,y=4,label=two"),
            ("IVPHELM_STATE", "DRIVE"),
        ] {
            application.publish(key, Value::Text(text.to_owned()));
        }
        assert_eq!(heard(&mut mind, &mut application).as_deref(), Some("true"));
        let drawings = mind.community.visit(|community| community.drawings.clone());
        assert_eq!(drawings.len(), 2, "{drawings:?}");
    }

    #[test]
    fn a_database_that_connects_late_gets_the_starting_values() {
        let scenario = scenario();
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let place = port.local_addr().unwrap().to_string();
        let remote = Address::Connect(place.clone());
        let community = Community::open("blue_one", &remote, reads(), MOOS).unwrap();
        let community = Arc::new(Watched::new(community));
        let mut mind = BoatMind::new(Arc::new(scenario.clone()), VehicleId(0), community, MOOS);
        mind.decide(&picture(&scenario, 1.0));
        drop(port);
        let wanted = BTreeSet::from(["MOOS_MANUAL_OVERRIDE".to_owned()]);
        let address = place.parse().unwrap();
        let mut database = Community::open("blue_one", &address, wanted, MOOS).unwrap();
        let start = bus::clock::now();
        while database.take_heard().is_empty() {
            assert!(bus::clock::since(start) < Duration::from_secs(20));
            mind.decide(&picture(&scenario, 2.0));
            bus::clock::rest(Duration::from_millis(10));
        }
    }
}
