//! Hulls that touch: each other, obstacles and walls.
//!
//! We integrate surge, sway and yaw ourselves, since a rigid-body engine knows one mass for all
//! directions and a hull with added mass has three. Where hulls may touch, rapier is handed the tick's
//! motion, resolves the contacts and moves the poses; what it changed in velocity goes back.
//!
//! The engine is built anew from the boats concerned, in vehicle order, every time it is asked. It therefore
//! remembers nothing: a snapshot needs none of its state, and boats that touch nobody are the same bytes
//! whether it was asked about others or not.

use crate::hull::HullModel;
use game::angle::wrap_pi;
use game::field::{Field, Obstacle, Walls};
use game::frame::{self, Ned};
use game::math;
use game::near::Pair;
use rapier2d_f64::parry::query;
use rapier2d_f64::prelude::{
    ColliderBuilder, MassProperties, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, Rot2, SharedShape, Vector,
};

/// Hulls nearer than this are handed to rapier, m. More than its own look-ahead below.
const CLOSE_M: f64 = 0.25;
/// How far ahead rapier looks for contacts, m: what the fastest pair closes in a tick.
const LOOK_AHEAD_M: f64 = 0.2;
/// Restitution and friction of hull on hull: fendered glass fibre, wet.
const RESTITUTION: f64 = 0.1;
const FRICTION: f64 = 0.2;

/// The solid shapes of a game.
#[derive(Clone)]
pub struct ContactModel {
    /// By kind of boat: a capsule as long and as wide as the hull, and half its length.
    hulls: Vec<(SharedShape, f64)>,
    /// Obstacles and walls.
    fixed: Vec<Fixed>,
    dt_s: f64,
}

#[derive(Clone)]
struct Fixed {
    shape: SharedShape,
    pose: Pose,
    /// A circle round it; walls have none.
    bounds: Option<(Ned, f64)>,
}

/// A boat's motion over one tick, as it would be without contact; then as it is.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Kind of boat.
    pub kind: usize,
    /// Where it was at the beginning.
    pub from: game::Pose,
    /// Where it is at the end.
    pub to: game::Pose,
    /// Sine and cosine of the heading at the beginning.
    pub turn: (f64, f64),
    /// Whether it can move at all.
    pub fixed: bool,
    /// What contact added to the velocity over the ground, m/s.
    pub kick_m_s: Ned,
    /// What contact added to the yaw rate, rad/s.
    pub kick_rad_s: f64,
}

/// A shape near a boat, with the direction in which it would be pushed.
struct Touch {
    boat: usize,
    normal: Vector,
}

/// One boat in rapier's hands.
struct Entry {
    boat: usize,
    body: RigidBodyHandle,
    velocity: Vector,
    spin_rad_s: f64,
}

impl ContactModel {
    /// The shapes of these kinds of boat (length and beam, m) on this field.
    #[must_use]
    pub fn new(hulls: impl Iterator<Item = (f64, f64)>, field: &Field, dt_s: f64) -> ContactModel {
        let capsule = |(length_m, beam_m): (f64, f64)| {
            let radius = 0.5 * beam_m.min(length_m);
            (SharedShape::capsule_x(0.5 * length_m - radius, radius), 0.5 * length_m)
        };
        let mut fixed: Vec<Fixed> = field.plan.obstacles.iter().map(fixed_obstacle).collect();
        if field.plan.walls == Walls::AllRound {
            let inward = [field.along, field.across.scaled(-1.0), field.along.scaled(-1.0), field.across];
            for (corner, inward) in field.corners.iter().zip(inward) {
                let shape = SharedShape::halfspace(vector(inward));
                fixed.push(Fixed { shape, pose: pose(*corner, (0.0, 1.0)), bounds: None });
            }
        }
        ContactModel { hulls: hulls.map(capsule).collect(), fixed, dt_s }
    }

    /// The largest distance between two boats at which they may be about to touch, m.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        2.0 * self.hulls.iter().map(|hull| hull.1).fold(0.0, f64::max) + CLOSE_M
    }

    /// Resolves all contacts of a tick; `near` are the pairs within [`ContactModel::reach_m`] at its beginning.
    pub fn resolve(&self, models: &[HullModel], passages: &mut [Passage], near: &[Pair]) {
        let mut touches = self.touches(passages, near);
        if touches.is_empty() {
            return;
        }
        // In vehicle order, each boat once, with the first direction found for it.
        touches.sort_by_key(|touch| touch.boat);
        touches.dedup_by_key(|touch| touch.boat);
        self.hand_to_rapier(models, passages, &touches);
    }

    /// Boats that are close to another hull or something fixed.
    fn touches(&self, passages: &[Passage], near: &[Pair]) -> Vec<Touch> {
        let mut touches = Vec::new();
        for pair in near {
            let (a, b) = (usize::from(pair.a), usize::from(pair.b));
            let (kind_a, kind_b) = (passages[a].kind, passages[b].kind);
            let reach_m = self.hulls[kind_a].1 + self.hulls[kind_b].1 + CLOSE_M;
            if pair.distance_squared > reach_m * reach_m {
                continue;
            }
            let (shape_a, shape_b) = (&self.hulls[kind_a].0, &self.hulls[kind_b].0);
            if let Some(normal) = close(passages[a].start(), shape_a, passages[b].start(), shape_b) {
                touches.push(Touch { boat: a, normal });
                touches.push(Touch { boat: b, normal });
            }
        }
        if self.fixed.is_empty() {
            return touches;
        }
        for (boat, passage) in passages.iter().enumerate() {
            let (shape, half_length_m) = &self.hulls[passage.kind];
            let beside = self.fixed.iter().filter(|fixed| fixed.is_beside(passage.from.at, half_length_m + CLOSE_M));
            for fixed in beside {
                if let Some(normal) = close(passage.start(), shape, fixed.pose, &fixed.shape) {
                    touches.push(Touch { boat, normal });
                }
            }
        }
        touches
    }

    fn hand_to_rapier(&self, models: &[HullModel], passages: &mut [Passage], touches: &[Touch]) {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = self.dt_s;
        world.integration_parameters.normalized_prediction_distance = LOOK_AHEAD_M;
        for fixed in &self.fixed {
            let reach_m = |passage: &Passage| self.hulls[passage.kind].1 + CLOSE_M;
            if touches.iter().any(|t| fixed.is_beside(passages[t.boat].from.at, reach_m(&passages[t.boat]))) {
                let collider = ColliderBuilder::new(fixed.shape.clone()).position(fixed.pose);
                world.insert_collider(collider.friction(FRICTION).restitution(RESTITUTION), None);
            }
        }
        let enter = |touch: &Touch| {
            let passage = &passages[touch.boat];
            enter(&mut world, &self.hulls[passage.kind].0, (models, self.dt_s), touch, passage)
        };
        let entries: Vec<Entry> = touches.iter().map(enter).collect();
        world.step();
        for entry in &entries {
            leave(&world, entry, &mut passages[entry.boat]);
        }
    }
}

impl Passage {
    fn start(&self) -> Pose {
        pose(self.from.at, self.turn)
    }
}

impl Fixed {
    fn is_beside(&self, at: Ned, reach_m: f64) -> bool {
        self.bounds.is_none_or(|(centre, radius_m)| centre.distance(at) < radius_m + reach_m)
    }
}

fn vector(ned: Ned) -> Vector {
    Vector::new(ned.north, ned.east)
}

fn pose(at: Ned, (sin, cos): (f64, f64)) -> Pose {
    Pose::from_parts(vector(at), Rot2 { re: cos, im: sin })
}

fn fixed_obstacle(obstacle: &Obstacle) -> Fixed {
    match obstacle {
        Obstacle::Circle { centre, radius_m } => Fixed {
            shape: SharedShape::ball(*radius_m),
            pose: pose(*centre, (0.0, 1.0)),
            bounds: Some((*centre, *radius_m)),
        },
        Obstacle::Polygon { corners } => {
            // A closed line, so that any polygon keeps its exact shape, bays included.
            let first = corners[0];
            let count = corners.len() as u32;
            let sides = (0..count).map(|i| [i, (i + 1) % count]).collect();
            let radius_m = corners.iter().map(|corner| corner.distance(first)).fold(0.0, f64::max);
            Fixed {
                shape: SharedShape::polyline(corners.iter().map(|corner| vector(*corner)).collect(), Some(sides)),
                pose: Pose::IDENTITY,
                bounds: Some((first, radius_m)),
            }
        }
    }
}

/// The direction between two shapes that are close.
fn close(pose_a: Pose, shape_a: &SharedShape, pose_b: Pose, shape_b: &SharedShape) -> Option<Vector> {
    let found = query::contact(&pose_a, &**shape_a, &pose_b, &**shape_b, CLOSE_M);
    found.ok().flatten().map(|contact| contact.normal1)
}

/// Puts a boat into rapier's world with the mass it has in the direction of the push.
fn enter(
    world: &mut PhysicsWorld,
    shape: &SharedShape,
    (models, dt_s): (&[HullModel], f64),
    touch: &Touch,
    passage: &Passage,
) -> Entry {
    let model = &models[passage.kind];
    let moved = passage.to.at - passage.from.at;
    let velocity = vector(moved) / dt_s;
    let spin_rad_s = wrap_pi(passage.to.psi_rad - passage.from.psi_rad) / dt_s;
    let normal = frame::body_from_ned(passage.turn, Ned { north: touch.normal.x, east: touch.normal.y });
    let mass = model.mass_along_kg(normal.ahead, normal.starboard);
    let body = if passage.fixed { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() }
        .pose(passage.start())
        .linvel(velocity)
        .angvel(spin_rad_s)
        .can_sleep(false)
        .additional_mass_properties(MassProperties::new(Vector::ZERO, mass, model.yaw_inertia_kg_m2()));
    let collider = ColliderBuilder::new(shape.clone()).density(0.0).friction(FRICTION).restitution(RESTITUTION);
    let (body, _) = world.insert(body, collider);
    Entry { boat: touch.boat, body, velocity, spin_rad_s }
}

/// Takes a boat out of rapier's world; without an active contact its own motion stands.
fn leave(world: &PhysicsWorld, entry: &Entry, passage: &mut Passage) {
    let body = &world.bodies[entry.body];
    let mut colliders = body.colliders().iter();
    let touched =
        colliders.any(|c| world.narrow_phase.contact_pairs_with(*c).any(|pair| pair.has_any_active_contact()));
    if !touched || passage.fixed {
        return;
    }
    let (at, rotation) = (body.translation(), body.rotation());
    passage.to.at = Ned { north: at.x, east: at.y };
    passage.to.psi_rad = math::atan2(rotation.im, rotation.re);
    let kick = body.linvel() - entry.velocity;
    passage.kick_m_s = Ned { north: kick.x, east: kick.y };
    passage.kick_rad_s = body.angvel() - entry.spin_rad_s;
}
