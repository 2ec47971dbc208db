//! Open water: one boat on a sea without walls, obstacles, opponents or rules that bite.

use game::boat::Boat;
use game::field::{Plan, Walls};
use game::frame::LatLon;
use game::id::TeamId;
use game::link::Sharing;
use game::rules::{CaptureAt, Points, TagChoice, TaggedBoat, UntagAt, UntagOn};
use game::scenario::{Source, StartPosition, Team, Vehicle};
use game::sea::{Current, Sea};
use game::{Field, Ned, Pose, Rules, Scenario, SimTime};

/// Extent of the field each way, m. It ends nothing: a boat sails on beyond it, and so does the sea. Only eddies that
/// are drawn by lot are laid over it.
const FIELD_M: f64 = 1000.0;
/// Density of sea water, kg/m³.
const SEA_WATER_KG_M3: f64 = 1025.0;

/// The sea of a trial that names none: salt water at rest, no wind.
#[must_use]
pub fn still_sea() -> Sea {
    Sea { name: "still".into(), water_density_kg_m3: SEA_WATER_KG_M3, ..Sea::at_rest() }
}

/// Gives `sea` this mean current in place of its own. What else flows in it (tide, shear, eddies) stays.
pub fn set_mean_current(sea: &mut Sea, speed_m_s: f64, toward_deg: f64) {
    let toward = Ned::toward_deg(toward_deg);
    let wander = sea.current.wander.map(|wander| game::sea::Wander { toward, ..wander });
    sea.current = Current { mean_m_s: toward.scaled(speed_m_s), wander, ..sea.current.clone() };
}

/// A game of one boat that lies in the middle of nowhere, pointing north, at the datum.
#[must_use]
pub fn open_water(boat: &Boat, sea: &Sea, tick: SimTime, seed: u64) -> Scenario {
    let team = |name: &str| Team { name: name.to_owned() };
    Scenario {
        name: "trial".into(),
        seed,
        tick,
        ticks_per_decision: 1,
        patience_s: 0.0,
        order_ttl_s: 0.0,
        field: field(),
        rules: rules(),
        sea: sea.clone(),
        link: None,
        teams: vec![team("blue"), team("red")],
        boats: vec![boat.clone()],
        strategies: vec![],
        vehicles: vec![Vehicle {
            name: "boat".into(),
            team: TeamId(0),
            boat: 0,
            strategy: 0,
            start_position: StartPosition::At(Pose::default()),
            source: Source::Simulated,
        }],
        drawn: vec![],
        recipe: None,
    }
}

fn field() -> Field {
    Field::new(Plan {
        name: "open_water".into(),
        datum: LatLon::default(),
        corner: Ned::from_xy(-0.5 * FIELD_M, -0.5 * FIELD_M),
        along_deg: 90.0,
        width_m: FIELD_M,
        depth_m: FIELD_M,
        flag_inset_m: 0.125 * FIELD_M,
        extra_flags: vec![],
        obstacles: vec![],
        walls: Walls::None,
    })
}

/// Rules under which nothing that one boat does has a consequence, and no game ends.
fn rules() -> Rules {
    Rules {
        name: "trial".into(),
        points: Points { grab: 0, capture: 0, tag: 0 },
        grab_radius_m: 0.0,
        tag_radius_m: 0.0,
        untag_radius_m: 0.0,
        capture_radius_m: 0.0,
        collision_distance_m: 0.0,
        capture_at: CaptureAt::OwnFlag,
        capture_needs_own_flag: false,
        untag_at: UntagAt::OwnFlag,
        untag_on: UntagOn::Inside,
        tag_cooldown: SimTime::ZERO,
        tag_choice: TagChoice::Nearest,
        boundary_tags: false,
        tagged_boat: TaggedBoat::DrivesItself,
        tagged_speed_factor: 1.0,
        outside_speed_factor: 1.0,
        sharing: Sharing::default(),
        flag_keepout_m: 0.0,
        win_score: None,
        time_limit: SimTime::NEVER,
        power_play: SimTime::ZERO,
    }
}
