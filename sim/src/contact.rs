//! Contact of hulls with each other, with obstacles and with walls.
//!
//! We integrate surge, sway and yaw ourselves, because a rigid-body engine has one mass for all
//! directions and a hull with added mass has three. Where hulls may touch, rapier receives the
//! tick's motion, resolves the contacts and moves the poses. The impulses that rapier applied are
//! converted to changes of the boats' velocities.
//!
//! The engine is rebuilt at every use from the boats concerned, in vehicle order. It therefore has
//! no memory: a snapshot needs none of its state, and boats without contact move identically, bit
//! for bit, whether or not the engine ran for others.

use crate::hull::{HullModel, Planar};
use primitives::angle::wrap_pi;
use primitives::frame::{self, Ned, Rotation};
use primitives::math;
use primitives::near::Pair;
use rapier2d_f64::parry::query;
use rapier2d_f64::prelude::{
    ColliderBuilder, Group, InteractionGroups, InteractionTestMode, MassProperties, PhysicsWorld,
    Pose, RigidBodyBuilder, RigidBodyHandle, Rot2, SharedShape, Vector,
};
use rules::field::{Field, Obstacle, Walls};

/// Maximum closing speed of two hulls (m/s). The distance closed in a tick is rapier's look-ahead
/// for contacts: hulls farther apart cannot touch before the next tick.
const CLOSING_MAX_M_S: f64 = 8.0;
/// Distance beyond rapier's look-ahead within which hulls are passed to rapier, m.
const SPARE_M: f64 = 0.05;
/// Thickness of a wall, and how far it extends beyond the corners, m.
// Walls are thick, so that no boat is pushed out on the far side within one tick.
const WALL_M: f64 = 10.0;
/// Restitution and friction between hulls of wet fibreglass with fenders.
const RESTITUTION: f64 = 0.1;
const FRICTION: f64 = 0.2;

/// Rapier's group for hulls; fixed shapes are in all groups.
const HULLS: Group = Group::GROUP_1;

/// The solid shapes of a game.
#[derive(Clone)]
pub struct ContactModel {
    /// Hull shapes, by kind of boat.
    hulls: Vec<HullShape>,
    /// Obstacles and walls.
    fixed: Vec<Fixed>,
    /// Whether hulls touch each other.
    hulls_are_solid: bool,
    dt_s: f64,
    look_ahead_m: f64,
    /// Distance below which hulls are passed to rapier, m.
    close_m: f64,
}

/// A capsule with a hull's length and beam.
#[derive(Clone)]
struct HullShape {
    capsule: SharedShape,
    half_length_m: f64,
}

/// An obstacle or a wall.
#[derive(Clone)]
struct Fixed {
    shape: SharedShape,
    pose: Pose,
    bounds: Bounds,
}

/// Bounds that a boat must reach before the exact shape is checked.
#[derive(Clone)]
enum Bounds {
    /// A circle: centre and radius.
    Circle(Ned, f64),
    /// A half-plane: a point on its edge, and the unit vector that points out of it.
    Behind(Ned, Ned),
}

/// A boat's motion over one tick: first without contact, then corrected.
#[derive(Clone, Copy, Debug)]
pub struct Displacement {
    /// Kind of boat.
    pub kind: usize,
    /// Pose at the start.
    pub from: primitives::Pose,
    /// Pose at the end.
    pub to: primitives::Pose,
    /// Rotation of the heading at the start.
    pub rotation: Rotation,
    /// Rotation of the heading at the end.
    pub rotation_to: Rotation,
    /// Role in contact.
    pub role: ContactRole,
    /// Velocity change by contact, in body axes.
    pub velocity_change: Planar,
}

/// Role of a boat in contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactRole {
    /// The boat is pushed.
    Dynamic,
    /// The boat stays at rest, whatever hits it.
    Fixed,
    /// The boat keeps its own motion, whatever it hits: a real boat does not feel simulated
    /// contact.
    Kinematic,
}

/// A boat near another shape: their distance, and the line along which they would push each other.
struct Touch {
    boat: usize,
    distance_m: f64,
    normal: Vector,
}

/// One boat in rapier's world.
struct Entry {
    boat: usize,
    body: RigidBodyHandle,
    mass_kg: f64,
    velocity: Vector,
    spin_rad_s: f64,
}

impl ContactModel {
    /// The shapes of boats of these kinds (length and beam, m) and of this field. Hulls that are
    /// not solid pass through each other.
    pub fn new(
        hulls: impl Iterator<Item = (f64, f64)>,
        field: &Field,
        hulls_are_solid: bool,
        dt_s: f64,
    ) -> ContactModel {
        let hull = |(length_m, beam_m): (f64, f64)| {
            // Use a capsule, because rapier resolves it at about half the cost of a box, and a bow
            // is rounder than a box.
            let radius = 0.5 * beam_m.min(length_m);
            let capsule = SharedShape::capsule_x(0.5 * length_m - radius, radius);
            HullShape {
                capsule,
                half_length_m: 0.5 * length_m,
            }
        };
        let mut fixed: Vec<Fixed> = field.plan.obstacles.iter().map(fixed_obstacle).collect();
        if field.plan.walls == Walls::AllRound {
            let inward = [
                field.along,
                field.across.scaled(-1.0),
                field.along.scaled(-1.0),
                field.across,
            ];
            for (i, inward) in inward.into_iter().enumerate() {
                fixed.push(wall(field.corners[i], field.corners[(i + 1) % 4], inward));
            }
        }
        // Without prediction rapier sees a contact only after hulls overlap, and separates them
        // with a spurious velocity.
        let look_ahead_m = CLOSING_MAX_M_S * dt_s;
        let hulls = hulls.map(hull).collect();
        let close_m = look_ahead_m + SPARE_M;
        ContactModel {
            hulls,
            fixed,
            hulls_are_solid,
            dt_s,
            look_ahead_m,
            close_m,
        }
    }

    /// For tests: passes to rapier all hulls within `close_m` of another shape, even where that is
    /// unnecessary. The results must not change.
    #[doc(hidden)]
    pub fn widen(&mut self, close_m: f64) {
        self.close_m = self.close_m.max(close_m);
    }

    /// The largest distance at which two boats may touch in the next tick, m.
    pub fn reach_m(&self) -> f64 {
        2.0 * self
            .hulls
            .iter()
            .map(|hull| hull.half_length_m)
            .fold(0.0, f64::max)
            + self.close_m
    }

    /// Resolves all contacts of a tick. `near` lists the pairs that were within
    /// [`ContactModel::reach_m`] at the start of the tick.
    pub fn resolve(&self, models: &[HullModel], displacements: &mut [Displacement], near: &[Pair]) {
        let mut touches = self.touches(displacements, near);
        if touches.is_empty() {
            return;
        }
        // Process boats in vehicle order, each once, with the direction of its nearest neighbour:
        // other boats passed to rapier must not affect the result.
        touches.sort_by(|a, b| {
            a.boat
                .cmp(&b.boat)
                .then(a.distance_m.total_cmp(&b.distance_m))
        });
        touches.dedup_by_key(|touch| touch.boat);
        self.hand_to_rapier(models, displacements, &touches);
    }

    /// Boats close to another hull or a fixed shape.
    fn touches(&self, displacements: &[Displacement], near: &[Pair]) -> Vec<Touch> {
        let mut touches = Vec::new();
        for pair in near.iter().filter(|_| self.hulls_are_solid) {
            let a = usize::from(pair.a);
            let b = usize::from(pair.b);
            let kind_a = displacements[a].kind;
            let kind_b = displacements[b].kind;
            let reach_m =
                self.hulls[kind_a].half_length_m + self.hulls[kind_b].half_length_m + self.close_m;
            if pair.distance_squared > reach_m * reach_m {
                continue;
            }
            let shape_a = &self.hulls[kind_a].capsule;
            let shape_b = &self.hulls[kind_b].capsule;
            if let Some((distance_m, normal)) = self.close(
                &displacements[a],
                shape_a,
                displacements[b].start(),
                shape_b,
            ) {
                // Only the axis matters, not its sign: the mass along a line is the same in both
                // directions.
                touches.push(Touch {
                    boat: a,
                    distance_m,
                    normal,
                });
                touches.push(Touch {
                    boat: b,
                    distance_m,
                    normal,
                });
            }
        }
        if self.fixed.is_empty() {
            return touches;
        }
        for (boat, displacement) in displacements.iter().enumerate() {
            let HullShape {
                capsule,
                half_length_m,
            } = &self.hulls[displacement.kind];
            let beside = self.fixed.iter().filter(|fixed| {
                fixed.is_beside(displacement.from.at, half_length_m + self.close_m)
            });
            for fixed in beside {
                if let Some((distance_m, normal)) =
                    self.close(displacement, capsule, fixed.pose, &fixed.shape)
                {
                    touches.push(Touch {
                        boat,
                        distance_m,
                        normal,
                    });
                }
            }
        }
        touches
    }

    /// Distance and direction between a hull and a close shape.
    fn close(
        &self,
        displacement: &Displacement,
        hull: &SharedShape,
        other_pose: Pose,
        other: &SharedShape,
    ) -> Option<(f64, Vector)> {
        let found = query::contact(
            &displacement.start(),
            &**hull,
            &other_pose,
            &**other,
            self.close_m,
        );
        found
            .ok()
            .flatten()
            .map(|contact| (contact.dist, contact.normal1))
    }

    fn hand_to_rapier(
        &self,
        models: &[HullModel],
        displacements: &mut [Displacement],
        touches: &[Touch],
    ) {
        // Rebuilding the world loses warm starting, which only a pile-up of boats would need.
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = self.dt_s;
        world.integration_parameters.normalized_prediction_distance = self.look_ahead_m;
        for fixed in &self.fixed {
            let reach_m = |displacement: &Displacement| {
                self.hulls[displacement.kind].half_length_m + self.close_m
            };
            if touches.iter().any(|t| {
                fixed.is_beside(
                    displacements[t.boat].from.at,
                    reach_m(&displacements[t.boat]),
                )
            }) {
                let collider = ColliderBuilder::new(fixed.shape.clone()).position(fixed.pose);
                world.insert_collider(collider.friction(FRICTION).restitution(RESTITUTION), None);
            }
        }
        let enter =
            |touch: &Touch| self.enter(&mut world, models, touch, &displacements[touch.boat]);
        let entries: Vec<Entry> = touches.iter().map(enter).collect();
        world.step();
        for entry in &entries {
            let displacement = &mut displacements[entry.boat];
            leave(&world, entry, &models[displacement.kind], displacement);
        }
    }

    /// The collision groups of hulls, which collide with fixed shapes and, if solid, with other
    /// hulls.
    fn met_by_hulls(&self) -> InteractionGroups {
        let met = if self.hulls_are_solid {
            Group::ALL
        } else {
            Group::ALL - HULLS
        };
        InteractionGroups::new(HULLS, met, InteractionTestMode::And)
    }

    /// Adds a boat to rapier's world, with its mass in the direction of the push.
    fn enter(
        &self,
        world: &mut PhysicsWorld,
        models: &[HullModel],
        touch: &Touch,
        displacement: &Displacement,
    ) -> Entry {
        let model = &models[displacement.kind];
        let moved = displacement.to.at - displacement.from.at;
        let velocity = vector(moved) / self.dt_s;
        let spin_rad_s = wrap_pi(displacement.to.psi_rad - displacement.from.psi_rad) / self.dt_s;
        let normal = frame::body_from_ned(
            displacement.rotation,
            Ned {
                north: touch.normal.x,
                east: touch.normal.y,
            },
        );
        // Rapier has one mass for all directions. It gets the mass with which the hull responds to
        // a push along this contact's normal, 1 / (n_u²/m_u + n_v²/m_v).
        let mass_kg = model.mass_along_kg(normal.ahead, normal.starboard);
        let body = match displacement.role {
            ContactRole::Dynamic => RigidBodyBuilder::dynamic(),
            ContactRole::Fixed => RigidBodyBuilder::fixed(),
            // A real boat pushes others but is not pushed: only its reports move it.
            ContactRole::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
        };
        let body = body
            .pose(displacement.start())
            .linvel(velocity)
            .angvel(spin_rad_s)
            // Rapier would put a body to sleep after some steps at rest; this world exists for only
            // one step.
            .can_sleep(false)
            .additional_mass_properties(MassProperties::new(Vector::ZERO, mass_kg, model.m_yaw));
        let collider = ColliderBuilder::new(self.hulls[displacement.kind].capsule.clone())
            // Otherwise the collider would add its own mass.
            .density(0.0)
            .friction(FRICTION)
            .restitution(RESTITUTION)
            .collision_groups(self.met_by_hulls());
        let (body, _) = world.insert(body, collider);
        Entry {
            boat: touch.boat,
            body,
            mass_kg,
            velocity,
            spin_rad_s,
        }
    }
}

impl Displacement {
    fn start(&self) -> Pose {
        pose(self.from.at, self.rotation)
    }
}

impl Fixed {
    fn is_beside(&self, at: Ned, reach_m: f64) -> bool {
        match self.bounds {
            Bounds::Circle(centre, radius_m) => centre.distance(at) < radius_m + reach_m,
            Bounds::Behind(point, before) => (at - point).dot(before) < reach_m,
        }
    }
}

fn vector(ned: Ned) -> Vector {
    Vector::new(ned.north, ned.east)
}

fn pose(at: Ned, rotation: Rotation) -> Pose {
    Pose::from_parts(
        vector(at),
        Rot2 {
            re: rotation.cos,
            im: rotation.sin,
        },
    )
}

fn fixed_obstacle(obstacle: &Obstacle) -> Fixed {
    match obstacle {
        Obstacle::Circle { centre, radius_m } => Fixed {
            shape: SharedShape::ball(*radius_m),
            pose: pose(*centre, Rotation::NORTH),
            bounds: Bounds::Circle(*centre, *radius_m),
        },
        Obstacle::Polygon { corners } => {
            // A closed polyline keeps the exact shape of any polygon, including concave parts.
            let first = corners[0];
            let count = corners.len() as u32;
            let sides = (0..count).map(|i| [i, (i + 1) % count]).collect();
            let radius_m = corners
                .iter()
                .map(|corner| corner.distance(first))
                .fold(0.0, f64::max);
            Fixed {
                shape: SharedShape::polyline(
                    corners.iter().map(|corner| vector(*corner)).collect(),
                    Some(sides),
                ),
                pose: Pose::IDENTITY,
                bounds: Bounds::Circle(first, radius_m),
            }
        }
    }
}

/// A wall from one corner to the next, as a thick plank: boats have passed through rapier's
/// half-plane, whose bounding box is infinite.
fn wall(from: Ned, to: Ned, inward: Ned) -> Fixed {
    let half_thickness_m = 0.5 * WALL_M;
    let middle = from + (to - from).scaled(0.5);
    Fixed {
        shape: SharedShape::cuboid(half_thickness_m, 0.5 * from.distance(to) + WALL_M),
        pose: pose(
            middle - inward.scaled(half_thickness_m),
            Rotation {
                sin: inward.east,
                cos: inward.north,
            },
        ),
        bounds: Bounds::Behind(from, inward),
    }
}

/// Reads a boat's motion back from rapier's world.
///
/// Uses rapier's impulse rather than its change of velocity: a hull has more mass across than
/// along, so an oblique push does not move it in the direction of the push. Using the change of
/// velocity along the push would add energy.
fn leave(world: &PhysicsWorld, entry: &Entry, model: &HullModel, displacement: &mut Displacement) {
    let body = &world.bodies[entry.body];
    let mut colliders = body.colliders().iter();
    let touched = colliders.any(|c| {
        world
            .narrow_phase
            .contact_pairs_with(*c)
            .any(|pair| pair.has_any_active_contact())
    });
    // A boat without contact keeps our own motion bit for bit, not rapier's integration of it.
    if !touched || displacement.role != ContactRole::Dynamic {
        return;
    }
    let at = body.translation();
    let rotation = body.rotation();
    displacement.to.at = Ned {
        north: at.x,
        east: at.y,
    };
    displacement.to.psi_rad = math::atan2(rotation.im, rotation.re);
    // Do not use rapier's sine and cosine: a snapshot contains only the angle.
    displacement.rotation_to = displacement.to.rotation();
    let impulse = (body.linvel() - entry.velocity) * entry.mass_kg;
    let impulse = frame::body_from_ned(
        displacement.rotation,
        Ned {
            north: impulse.x,
            east: impulse.y,
        },
    );
    let twist = (body.angvel() - entry.spin_rad_s) * model.m_yaw;
    displacement.velocity_change = model.velocity_change(Planar {
        surge: impulse.ahead,
        sway: impulse.starboard,
        yaw: twist,
    });
}
