//! The shoreside as a MOOS community: publishes the frames for observers as variables for
//! pMarineViewer.

use crate::boat::mode_of;
use crate::clock::MoosClock;
use crate::community::{Community, Value};
use crate::game::{self, flag_of};
use crate::share::Share;
use crate::wire::Msg;
use bus::{Bus, Latest, Patience, SimState, SimWatch, Watched};
use gateway::geodesy::LocalFrame;
use messages::Frame;
use messages::topic::{self, GameName};
use primitives::{Ned, TeamId, VehicleId, codec};
use rules::event::{Event, TagCause};
use scenario::Scenario;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

/// Interval (s, wall-clock time) at which drawings are published again, for viewers that connect
/// late.
const REDRAW_S: f64 = 5.0;
/// Interval at which the shoreside reads commands while no frame arrives.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// Distance (m) at which a flag is drawn behind its carrier.
const ASTERN_M: f64 = 3.0;
/// The variables that people at the shoreside set for all boats (`_ALL`) or for one.
const COMMANDS: [&str; 5] = [
    "DEPLOY",
    "RETURN",
    "STATION_KEEP",
    "MOOS_MANUAL_OVERRIDE",
    "ACTION",
];

/// The communities of boats to which the shoreside passes commands.
pub(crate) type Boats = Vec<Arc<Watched<Community>>>;

/// The shoreside during a game.
pub(crate) struct Shoreside<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) frame: LocalFrame,
    pub(crate) community: Arc<Watched<Community>>,
    pub(crate) share: Option<Share>,
    pub(crate) boats: Boats,
    pub(crate) moos: MoosClock,
    /// When drawings are due again, MOOS time in s.
    pub(crate) redraw_s: f64,
}

/// The variables that the shoreside reads: commands, and the start-up of a viewer.
pub(crate) fn reads(scenario: &Scenario) -> BTreeSet<String> {
    let names = scenario
        .vehicles
        .iter()
        .map(|vehicle| vehicle.name.to_uppercase());
    let names: Vec<String> = names.chain(["ALL".to_owned()]).collect();
    let commands = COMMANDS
        .iter()
        .flat_map(|command| names.iter().map(move |name| format!("{command}_{name}")));
    commands.chain(["PMV_CONNECT".to_owned()]).collect()
}

impl Shoreside<'_> {
    /// Publishes frames until the game is over, the sim is lost, or `is_stopped` returns true.
    pub(crate) fn serve(
        &mut self,
        bus: &Bus,
        game: &GameName,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<(), bus::BusError> {
        let frames = Arc::new(Latest::new(1));
        let incoming = Arc::clone(&frames);
        let receive = move |bytes: &[u8]| {
            if let Ok(frame) = codec::decode::<Frame>(bytes) {
                incoming.put(0, frame);
            }
        };
        let _frames = bus.subscribe(topic::frame(game), receive)?;
        let sim = SimWatch::open(bus, game, Patience::of_player(Duration::from_secs(60)))?;
        while !is_stopped() && matches!(sim.state(), SimState::Alive) {
            let community = Arc::clone(&self.community);
            if let Some(Some(frame)) = frames.take(LOOK_AGAIN).into_iter().next() {
                sim.hears();
                community.visit(|community| self.publish(community, &frame));
                if frame.over {
                    return Ok(());
                }
            }
            community.visit(|community| {
                self.pass_drawings(community);
                self.pass_commands(community);
            });
        }
        Ok(())
    }

    fn publish(&mut self, community: &mut Community, frame: &Frame) {
        let scenario = self.scenario;
        let now_s = self.moos.now_s();
        let mut sent = Vec::new();
        for (i, boat) in frame
            .vehicles
            .iter()
            .enumerate()
            .take(scenario.vehicles.len())
        {
            let vehicle = VehicleId::at(i);
            let name = scenario.vehicles[i].name.to_uppercase();
            let mode = if boat.agent_lost {
                "MINDLESS"
            } else {
                mode_of(boat.tagged, boat.carrying)
            };
            let report =
                game::node_report(scenario, &self.frame, (vehicle, &boat.nav, mode), now_s);
            sent.push(community.publish("NODE_REPORT", report));
            for (key, value) in [
                ("HAS_FLAG", boat.carrying >= 0),
                ("TAGGED", boat.tagged),
                ("ONFIELD", !boat.outside),
            ] {
                sent.extend(community.publish_change(&format!("{key}_{name}"), flag_of(value)));
            }
        }
        for logged in frame.logged(scenario) {
            if let Event::Tagged {
                vehicle,
                cause: TagCause::Opponent(by),
            } = logged.event
            {
                let [name, by] =
                    [vehicle, by].map(|vehicle| &scenario.vehicles[vehicle.index()].name);
                let key = format!("TAG_RESULT_{}", by.to_uppercase());
                let text = format!("event={},source={by},tagged={name}", logged.tick);
                sent.push(community.publish(&key, Value::Text(text)));
            }
        }
        let tagged = frame
            .vehicles
            .iter()
            .enumerate()
            .filter(|(_, boat)| boat.tagged);
        let tagged: Vec<VehicleId> = tagged.map(|(i, _)| VehicleId::at(i)).collect();
        let state = if frame.over { "stop" } else { "play" };
        sent.extend(community.publish_change("AQUATICUS_GAME_ALL", Value::Text(state.to_owned())));
        game::publish(
            community,
            scenario,
            frame.stamp.valid_ns,
            (&frame.flags, &frame.score, &tagged),
            &mut |msg| sent.push(msg),
        );
        for (i, flag) in scenario.field.flags.iter().enumerate() {
            let carrier = frame
                .flags
                .get(i)
                .and_then(|view| frame.vehicles.get(usize::try_from(view.carrier).ok()?));
            let astern = |nav: &messages::picture::Nav| {
                nav.at() + Ned::toward_deg(nav.psi_rad.to_degrees()).scaled(-ASTERN_M)
            };
            let marker = game::marker(
                scenario,
                i,
                carrier.map_or(flag.home(frame.stamp.valid_ns), |boat| astern(&boat.nav)),
            );
            let key = format!("VIEW_MARKER {i}");
            // One variable carries the markers of all flags, so each flag is checked for changes
            // separately.
            if community.is_change(&key, &marker) {
                sent.push(community.publish("VIEW_MARKER", Value::Text(marker)));
            }
        }
        if now_s >= self.redraw_s {
            self.redraw_s = now_s + REDRAW_S * self.moos.warp;
            sent.extend(self.draw_field(community));
            community.forget_all();
        }
        if let Some(share) = &self.share {
            sent.iter().for_each(|msg| share.send(msg));
        }
    }

    fn draw_field(&self, community: &mut Community) -> Vec<Msg> {
        let scenario = self.scenario;
        let mut polygons: Vec<String> = (0..2)
            .map(|team| game::zone(scenario, TeamId(team)))
            .collect();
        polygons.push(format!(
            "{},label=field,edge_color=white,vertex_size=1",
            game::points(&scenario.field.corners)
        ));
        for (i, obstacle) in scenario.field.plan.obstacles.iter().enumerate() {
            if let rules::field::Obstacle::Polygon { corners } = obstacle {
                polygons.push(format!(
                    "{},label=obstacle_{i},edge_color=gray,fill_color=gray",
                    game::points(corners)
                ));
            }
        }
        polygons
            .into_iter()
            .map(|polygon| community.publish("VIEW_POLYGON", Value::Text(polygon)))
            .collect()
    }

    /// Passes on the drawings of helms connected to this bridge, for example their next waypoints.
    fn pass_drawings(&self, community: &mut Community) {
        for boat in &self.boats {
            for msg in boat.visit(|boat| std::mem::take(&mut boat.drawings)) {
                let text = msg.as_text().unwrap_or_default().to_owned();
                let sent = community.publish(&msg.key, Value::Text(text));
                self.share.iter().for_each(|share| share.send(&sent));
            }
        }
    }

    /// Passes people's commands to the boats connected to this bridge.
    fn pass_commands(&mut self, community: &mut Community) {
        let mut heard = community.take_heard();
        if let Some(share) = &mut self.share {
            let known = reads(self.scenario);
            heard.extend(
                share
                    .receive()
                    .into_iter()
                    .filter(|msg| known.contains(&msg.key)),
            );
            community.malformed = share.malformed;
        }
        for msg in heard {
            if msg.key == "PMV_CONNECT" {
                self.redraw_s = f64::NEG_INFINITY;
            }
            for boat in &self.boats {
                boat.visit(|boat| pass_command(boat, &msg));
            }
        }
    }
}

/// Passes a command to this boat if it is for this boat or for all boats.
fn pass_command(boat: &mut Community, msg: &Msg) {
    let own = format!("_{}", boat.name.to_uppercase());
    let command = msg
        .key
        .strip_suffix(&own)
        .or_else(|| msg.key.strip_suffix("_ALL"));
    if let Some(command) = command {
        boat.command(Msg {
            key: command.to_owned(),
            ..msg.clone()
        });
    }
}

/// Checks that the node's keys, if any, give access to the true state.
pub(crate) fn check_keys(bus: &Bus) -> Result<(), String> {
    use bus::keys::Identity;
    match &bus.keys {
        Some(keys)
            if !matches!(
                keys.identity,
                Identity::Observer | Identity::Operator | Identity::Gateway(_)
            ) =>
        {
            Err(format!(
                "{}: the keys of {} give no access to the true state of the game: start the shoreside in a second `squall moos` \
                 with an observer's keys",
                keys.folder.display(),
                keys.identity
            ))
        }
        _ => Ok(()),
    }
}
