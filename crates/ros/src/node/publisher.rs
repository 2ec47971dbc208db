//! Publishes a game's frames, pictures and gateway statuses to ROS 2.

use super::graph::{Graph, Topic};
use crate::convert::Motion;
use crate::message::{
    Clock, DiagnosticArray, Imu, MarkerArray, NavSatFix, Odometry, TfMessage, TwistStamped,
};
use crate::name::Node;
use crate::{diagnostics, markers};
use bus::{BusError, Watched, clock};
use gateway::geodesy::LocalFrame;
use messages::external::GatewayStatus;
use messages::refusal::Refusals;
use messages::{Frame, Picture, Stamp};
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Interval at which diagnostics and field markers are sent.
const SELDOM: Duration = Duration::from_secs(1);

/// The newest status of each gateway and its time of arrival, by boat.
pub(super) type Statuses = Watched<BTreeMap<String, (GatewayStatus, Instant)>>;

/// The topics of one boat's motion.
struct MotionTopics {
    base_link: String,
    odom: Topic<Odometry>,
    fix: Topic<NavSatFix>,
    imu: Topic<Imu>,
    velocity: Topic<TwistStamped>,
}

impl MotionTopics {
    /// Topics under `prefix`, for example `blue_1` or `blue_1/truth`.
    fn open(graph: &mut Graph, node: &Node, prefix: &str) -> Result<MotionTopics, BusError> {
        Ok(MotionTopics {
            base_link: format!("{prefix}/base_link"),
            odom: graph.publisher(node, &format!("/{prefix}/odom"))?,
            fix: graph.publisher(node, &format!("/{prefix}/fix"))?,
            imu: graph.publisher(node, &format!("/{prefix}/imu"))?,
            velocity: graph.publisher(node, &format!("/{prefix}/velocity"))?,
        })
    }

    fn send(&mut self, motion: &Motion, map: &LocalFrame) -> Result<(), BusError> {
        let base_link = &self.base_link;
        self.odom.send(|| motion.odometry(base_link))?;
        self.imu.send(|| motion.imu(base_link))?;
        self.velocity.send(|| motion.velocity())?;
        self.fix
            .send(|| motion.fix(base_link, map.lat_lon(motion.nav.at())))
    }
}

/// All topics that the bridge publishes.
pub(super) struct Publisher {
    scenario: Arc<Scenario>,
    game: String,
    driven: Vec<String>,
    map: LocalFrame,
    clock: Topic<Clock>,
    tf: Topic<TfMessage>,
    field: Topic<MarkerArray>,
    game_markers: Topic<MarkerArray>,
    diagnostics: Topic<DiagnosticArray>,
    frame: Topic<Frame>,
    /// The truth, by vehicle; empty if it is not published.
    truth: Vec<MotionTopics>,
    /// Measurements of driven boats.
    measured: BTreeMap<VehicleId, MotionTopics>,
    /// The pictures of driven boats' teams.
    pictures: BTreeMap<u8, Topic<Picture>>,
    /// The newest game time seen.
    now: SimTime,
    seldom_at: Option<Instant>,
}

impl Publisher {
    /// Declares all topics: `nodes` are the boats' nodes, by vehicle; `driven` are the boats that
    /// the bridge drives.
    pub(super) fn open(
        graph: &mut Graph,
        (squall, nodes): (&Node, &[Node]),
        (game, scenario): (&str, Arc<Scenario>),
        driven: &[VehicleId],
        shows_truth: bool,
    ) -> Result<Publisher, BusError> {
        let true_nodes = if shows_truth { nodes } else { &[] };
        let truth = true_nodes
            .iter()
            .map(|node| MotionTopics::open(graph, node, &format!("{}/truth", node.name)));
        let truth = truth.collect::<Result<_, _>>()?;
        let (mut measured, mut pictures) = (BTreeMap::new(), BTreeMap::new());
        for boat in driven {
            let node = &nodes[boat.index()];
            measured.insert(*boat, MotionTopics::open(graph, node, &node.name)?);
            let team = scenario.team_of(*boat);
            let topic = format!("/squall/{}/picture", scenario.teams[team.index()].name);
            if let Entry::Vacant(entry) = pictures.entry(team.0) {
                entry.insert(graph.publisher(squall, &topic)?);
            }
        }
        Ok(Publisher {
            map: LocalFrame::new(scenario.field.plan.datum),
            game: game.to_owned(),
            driven: driven
                .iter()
                .map(|boat| nodes[boat.index()].name.clone())
                .collect(),
            clock: graph.publisher(squall, "/clock")?,
            tf: graph.publisher(squall, "/tf")?,
            field: graph.publisher(squall, "/squall/field")?,
            game_markers: graph.publisher(squall, "/squall/markers")?,
            diagnostics: graph.publisher(squall, "/diagnostics")?,
            frame: graph.publisher(squall, "/squall/frame")?,
            truth,
            measured,
            pictures,
            scenario,
            now: SimTime::ZERO,
            seldom_at: None,
        })
    }

    /// Sends the game time, once per decision.
    fn tick(&mut self, stamp: Stamp) -> Result<(), BusError> {
        if stamp.valid_ns <= self.now && stamp.seq > 0 {
            return Ok(());
        }
        self.now = stamp.valid_ns;
        self.clock.send(|| Clock {
            clock: stamp.valid_ns.into(),
        })
    }

    /// Sends the truth. `bytes` is the encoded frame.
    pub(super) fn send_frame(&mut self, bytes: Vec<u8>, frame: &Frame) -> Result<(), BusError> {
        self.tick(frame.stamp)?;
        if self.truth.is_empty() {
            return Ok(());
        }
        self.frame.send_bytes(bytes)?;
        let motions: Vec<Motion> = frame
            .vehicles
            .iter()
            .map(|boat| Motion::truth(frame.stamp, boat))
            .collect();
        let truth = &self.truth;
        self.tf.send(|| TfMessage {
            transforms: truth
                .iter()
                .zip(&motions)
                .map(|(boat, motion)| motion.transform(&boat.base_link))
                .collect(),
        })?;
        for (topics, motion) in self.truth.iter_mut().zip(&motions) {
            topics.send(motion, &self.map)?;
        }
        self.game_markers
            .send(|| markers::game(&self.scenario, frame))
    }

    /// Sends measurements of a team's driven boats.
    pub(super) fn send_picture(&mut self, picture: &Picture) -> Result<(), BusError> {
        self.tick(picture.stamp)?;
        for boat in &picture.own {
            let Some(topics) = self.measured.get_mut(&boat.vehicle) else {
                continue;
            };
            let motion = Motion::measured(picture.stamp, boat);
            topics.send(&motion, &self.map)?;
            self.tf.send(|| TfMessage {
                transforms: vec![motion.transform(&topics.base_link)],
            })?;
        }
        self.pictures
            .get_mut(&picture.team)
            .map_or(Ok(()), |topic| topic.send(|| picture.clone()))
    }

    /// Sends diagnostics and field markers, once a second.
    pub(super) fn send_seldom(
        &mut self,
        statuses: &Statuses,
        refused: Refusals,
    ) -> Result<(), BusError> {
        if self.seldom_at.is_some_and(|at| clock::since(at) < SELDOM) {
            return Ok(());
        }
        self.seldom_at = Some(clock::now());
        self.field
            .send(|| markers::field(&self.scenario, self.now))?;
        self.diagnostics.send(|| {
            let gateways = statuses.visit(|statuses| statuses.clone());
            let gateways = gateways
                .values()
                .map(|(status, at)| diagnostics::gateway(status, clock::since(*at)));
            let own = diagnostics::bridge(&self.game, &self.driven, refused);
            diagnostics::array(self.now, std::iter::once(own).chain(gateways).collect())
        })
    }
}
