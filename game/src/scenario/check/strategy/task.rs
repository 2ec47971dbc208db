//! What behaviours do, checked: one function a kind.

use super::expression::{Wanted, expression, place_of, places_allowed};
use crate::frame::Ned;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{
    Amount, At, RawAttractor, RawAvoidCollision, RawAvoidObstacle, RawConstantHeading, RawConstantSpeed, RawCutRange,
    RawEllipse, RawIntercept, RawLoiter, RawMaxSpeed, RawMemoryTurnLimit, RawOpRegion, RawPolicy, RawShield,
    RawStationKeep, RawTask, RawTrail, RawWaypoint, Whereabouts,
};
use crate::strategy::{
    Attractor, AvoidCollision, AvoidObstacle, Boat, ConstantHeading, ConstantSpeed, Contacts, CutRange, Expression,
    FullStop, Grade, Intercept, Loiter, MaxSpeed, MemoryTurnLimit, OpRegion, Parameter, Place, Policy, Proposer, Shape,
    Shield, StationKeep, Task, Timer, Trail, Turn, Variable, Waypoint,
};

/// Ranges of what behaviours have in common.
const SPEED_M_S: (f64, f64) = (0.0, 60.0);
const RADIUS_M: (f64, f64) = (0.0, 1000.0);
const REACH_M: (f64, f64) = (0.0, 10_000.0);
const GIVEUP_M: (f64, f64) = (0.0, 100_000.0);
const LEG_S: (f64, f64) = (0.1, 600.0);
const WAIT_S: (f64, f64) = (0.0, 600.0);
const WIDTH_DEG: (f64, f64) = (0.0, 180.0);
const TURN_DEG: (f64, f64) = (-360.0, 360.0);
const SHARE: (f64, f64) = (0.0, 1.0);
/// Points of a path, corners of a polygon.
const MOST_POINTS: usize = 1000;
/// Farther from the datum than this nobody sails, m.
const FAR_M: f64 = 1e6;

/// A behaviour whose keys are being checked.
pub(super) struct Keys<'a> {
    pub(super) diagnostics: &'a mut Diagnostics,
    pub(super) variables: &'a [Variable],
    /// Where the behaviour stands.
    pub(super) owner: usize,
    /// Its name.
    pub(super) name: &'a str,
}

type Number<'a> = Option<&'a At<Amount>>;

impl Keys<'_> {
    /// A number or an expression, or the default.
    pub(super) fn number(&mut self, key: &str, given: Number<'_>, range: (f64, f64), default: f64) -> Parameter {
        let expression = given.and_then(|given| self.given(key, given, range));
        Parameter { expression: expression.unwrap_or(Expression::Constant(default)), range }
    }

    /// A number or an expression that must be there.
    pub(super) fn required(&mut self, key: &str, given: Number<'_>, range: (f64, f64)) -> Parameter {
        if given.is_none() {
            self.missing(key, &format!("{} to {}", range.0, range.1));
        }
        self.number(key, given, range, range.0)
    }

    fn missing(&mut self, key: &str, expected: &str) {
        let key = format!("behaviour.{}.{key}", self.name);
        self.diagnostics.note_missing(self.owner, &key, expected);
    }

    fn given(&mut self, key: &str, given: &At<Amount>, range: (f64, f64)) -> Option<Expression> {
        let expression = match &given.value {
            Amount::Number(number) => {
                let value = At { value: *number, at: given.at };
                return self.diagnostics.number(key, Some(&value), range.0..=range.1).map(Expression::Constant);
            }
            Amount::Text(text) => {
                let text = At { value: text.clone(), at: given.at };
                expression(self.diagnostics, self.variables, key, &text, Wanted::Number)?
            }
        };
        match expression.constant() {
            Some(value) => {
                let value = At { value, at: given.at };
                self.diagnostics.number(key, Some(&value), range.0..=range.1).map(|_| expression)
            }
            None => Some(expression),
        }
    }

    /// Notes that the first of two numbers is greater than the second, where both are known beforehand.
    fn in_order(&mut self, low: (&str, Number<'_>, &Parameter), high: (&str, Number<'_>, &Parameter)) {
        let (Some(a), Some(b)) = (low.2.constant(), high.2.constant()) else { return };
        let Some(at) = low.1.or(high.1).map(|given| given.at) else { return };
        if a > b {
            self.diagnostics.note(at, format!("{} is {a}, expected at most {}, which is {b}", low.0, high.0));
        }
    }

    fn place(&mut self, key: &str, given: &At<Whereabouts>) -> Option<Place> {
        match &given.value {
            Whereabouts::Position([x, y]) if x.abs() <= FAR_M && y.abs() <= FAR_M => {
                Some(Place::At(Ned::from_xy(*x, *y)))
            }
            Whereabouts::Position([x, y]) => {
                let message = format!("{key} is [{x}, {y}], expected both within {FAR_M} of 0");
                self.diagnostics.note(given.at, message.replace("NaN", "nan"));
                None
            }
            Whereabouts::Point(name) => {
                let place = place_of(name);
                if place.is_none() {
                    let message = format!("{key} is {name:?}, expected [x, y], {}", &places_allowed(name)[9..]);
                    self.diagnostics.note(given.at, message);
                }
                place
            }
        }
    }

    fn required_place(&mut self, key: &str, given: Option<&At<Whereabouts>>) -> Option<Place> {
        match given {
            Some(given) => self.place(key, given),
            None => {
                self.missing(key, "[x, y], or the name of a place or a boat");
                None
            }
        }
    }

    fn places(&mut self, key: &str, given: &At<Vec<At<Whereabouts>>>, least: usize) -> Option<Vec<Place>> {
        let count = given.value.len();
        if !(least..=MOST_POINTS).contains(&count) {
            self.diagnostics.note(given.at, format!("{key} has {count} entries, expected {least} to {MOST_POINTS}"));
            return None;
        }
        let places: Vec<Option<Place>> = given.value.iter().map(|place| self.place(key, place)).collect();
        places.into_iter().collect()
    }

    fn boat(&mut self, key: &str, given: Option<&At<String>>) -> Option<Boat> {
        let names: Vec<&str> = Boat::all().map(Boat::name).collect();
        let Some(given) = given else {
            self.missing(key, &format!("one of {}", names.join(", ")));
            return None;
        };
        let boat = Boat::all().find(|boat| boat.name() == given.value);
        if boat.is_none() {
            let guess = crate::scenario::explain::nearest(&given.value, &names);
            let guess = guess.map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
            let message = format!("{key} is {:?}, expected one of {}{guess}", given.value, names.join(", "));
            self.diagnostics.note(given.at, message);
        }
        boat
    }
}

/// Checks what a behaviour does.
pub(super) fn task(keys: &mut Keys<'_>, raw: &RawTask) -> Option<Task> {
    Some(match raw {
        RawTask::Waypoint(raw) => Task::Waypoint(waypoint(keys, raw)?),
        RawTask::Loiter(raw) => Task::Loiter(loiter(keys, raw)?),
        RawTask::StationKeep(raw) => Task::StationKeep(station_keep(keys, raw)),
        RawTask::CutRange(raw) => Task::CutRange(cut_range(keys, raw)?),
        RawTask::Trail(raw) => Task::Trail(trail(keys, raw)?),
        RawTask::Intercept(raw) => Task::Intercept(intercept(keys, raw)?),
        RawTask::AvoidCollision(raw) => Task::AvoidCollision(avoid_collision(keys, raw)),
        RawTask::AvoidObstacle(raw) => Task::AvoidObstacle(avoid_obstacle(keys, raw)),
        RawTask::OpRegion(raw) => Task::OpRegion(op_region(keys, raw)),
        RawTask::MaxSpeed(raw) => Task::MaxSpeed(max_speed(keys, raw)),
        RawTask::ConstantHeading(raw) => Task::ConstantHeading(constant_heading(keys, raw)),
        RawTask::ConstantSpeed(raw) => Task::ConstantSpeed(constant_speed(keys, raw)),
        RawTask::MemoryTurnLimit(raw) => Task::MemoryTurnLimit(memory_turn_limit(keys, raw)),
        RawTask::Timer(_) => Task::Timer(Timer {}),
        RawTask::FullStop(_) => Task::FullStop(FullStop {}),
        RawTask::Shield(raw) => Task::Shield(shield(keys, raw)?),
        RawTask::Attractor(raw) => Task::Attractor(attractor(keys, raw)?),
        RawTask::Policy(raw) => Task::Policy(policy(keys, raw)),
    })
}

fn waypoint(keys: &mut Keys<'_>, raw: &RawWaypoint) -> Option<Waypoint> {
    let points = match &raw.points {
        Some(points) => keys.places("points", points, 1),
        None => {
            keys.missing("points", "a list of places");
            None
        }
    };
    let waypoint = Waypoint {
        points: vec![],
        reverse: raw.reverse.as_ref().is_some_and(|reverse| reverse.value),
        repeat: keys.number("repeat", raw.repeat.as_ref(), (0.0, 1e6), 0.0),
        speed_m_s: keys.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S, 5.0),
        capture_radius_m: keys.number("capture_radius_m", raw.capture_radius_m.as_ref(), (0.1, 1000.0), 3.0),
        slip_radius_m: keys.number("slip_radius_m", raw.slip_radius_m.as_ref(), RADIUS_M, 15.0),
        lead_m: keys.number("lead_m", raw.lead_m.as_ref(), RADIUS_M, 0.0),
        course_share: keys.number("course_share", raw.course_share.as_ref(), SHARE, 0.5),
    };
    points.map(|points| Waypoint { points, ..waypoint })
}

fn loiter(keys: &mut Keys<'_>, raw: &RawLoiter) -> Option<Loiter> {
    let shape = match (&raw.polygon, &raw.ellipse) {
        (Some(polygon), None) => keys.places("polygon", polygon, 3).map(Shape::Corners),
        (None, Some(given)) => ellipse(keys, given),
        (None, None) => {
            keys.missing("ellipse", "it or polygon");
            None
        }
        (Some(_), Some(given)) => {
            keys.diagnostics.note(given.at, "ellipse is given with polygon, expected one of them");
            None
        }
    };
    let (turn, speed) = (raw.turn.as_ref().map_or(Turn::Best, |turn| turn.value), raw.speed_m_s.as_ref());
    let speed_m_s = keys.number("speed_m_s", speed, SPEED_M_S, 5.0);
    let capture_radius_m = keys.number("capture_radius_m", raw.capture_radius_m.as_ref(), (0.1, 1000.0), 3.0);
    let slip_radius_m = keys.number("slip_radius_m", raw.slip_radius_m.as_ref(), RADIUS_M, 15.0);
    let acquire_m = keys.number("acquire_m", raw.acquire_m.as_ref(), REACH_M, 10.0);
    shape.map(|shape| Loiter { shape, turn, speed_m_s, capture_radius_m, slip_radius_m, acquire_m })
}

fn ellipse(keys: &mut Keys<'_>, given: &At<RawEllipse>) -> Option<Shape> {
    let raw = &given.value;
    let mut inner = Keys { diagnostics: keys.diagnostics, variables: keys.variables, owner: given.at, name: keys.name };
    let centre = inner.required_place("ellipse.centre", raw.centre.as_ref());
    let along_m = keys.diagnostics.required(given.at, "ellipse.along_m", raw.along_m.as_ref(), 1.0..=1e4);
    let across_m = keys.diagnostics.required(given.at, "ellipse.across_m", raw.across_m.as_ref(), 1.0..=1e4);
    let corners = keys.diagnostics.whole("corners", raw.corners.as_ref(), 3..=1000, 24) as usize;
    centre.map(|centre| Shape::Ellipse { centre, along_m, across_m, corners })
}

fn station_keep(keys: &mut Keys<'_>, raw: &RawStationKeep) -> StationKeep {
    let at = raw.at.as_ref().and_then(|at| keys.place("at", at));
    let (inner, outer) = (raw.inner_radius_m.as_ref(), raw.outer_radius_m.as_ref());
    let inner_radius_m = keys.number("inner_radius_m", inner, RADIUS_M, 4.0);
    let outer_radius_m = keys.number("outer_radius_m", outer, RADIUS_M, 15.0);
    keys.in_order(("inner_radius_m", inner, &inner_radius_m), ("outer_radius_m", outer, &outer_radius_m));
    StationKeep {
        at,
        inner_radius_m,
        outer_radius_m,
        outer_speed_m_s: keys.number("outer_speed_m_s", raw.outer_speed_m_s.as_ref(), SPEED_M_S, 1.2),
        transit_speed_m_s: keys.number("transit_speed_m_s", raw.transit_speed_m_s.as_ref(), SPEED_M_S, 2.5),
    }
}

fn cut_range(keys: &mut Keys<'_>, raw: &RawCutRange) -> Option<CutRange> {
    let contact = keys.boat("contact", raw.contact.as_ref());
    let patience = keys.number("patience", raw.patience.as_ref(), (0.0, 100.0), 50.0);
    let time_on_leg_s = keys.number("time_on_leg_s", raw.time_on_leg_s.as_ref(), LEG_S, 15.0);
    let giveup_m = keys.number("giveup_m", raw.giveup_m.as_ref(), GIVEUP_M, 0.0);
    contact.map(|contact| CutRange { contact, patience, time_on_leg_s, giveup_m })
}

fn trail(keys: &mut Keys<'_>, raw: &RawTrail) -> Option<Trail> {
    let contact = keys.boat("contact", raw.contact.as_ref());
    let range_m = keys.number("range_m", raw.range_m.as_ref(), REACH_M, 50.0);
    let angle_deg = keys.number("angle_deg", raw.angle_deg.as_ref(), TURN_DEG, 180.0);
    let radius_m = keys.number("radius_m", raw.radius_m.as_ref(), RADIUS_M, 5.0);
    let speed_m_s = keys.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S, 5.0);
    contact.map(|contact| Trail { contact, range_m, angle_deg, radius_m, speed_m_s })
}

fn intercept(keys: &mut Keys<'_>, raw: &RawIntercept) -> Option<Intercept> {
    let contact = keys.boat("contact", raw.contact.as_ref());
    let speed_m_s = keys.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S, 5.0);
    let giveup_m = keys.number("giveup_m", raw.giveup_m.as_ref(), GIVEUP_M, 0.0);
    contact.map(|contact| Intercept { contact, speed_m_s, giveup_m })
}

/// The two distances and the two closest points of approach of what keeps clear, in order.
fn clearances(keys: &mut Keys<'_>, given: [Number<'_>; 4], defaults: [f64; 4]) -> [Parameter; 4] {
    let names = ["inner_m", "outer_m", "cpa_min_m", "cpa_max_m"];
    let parameters: [Parameter; 4] = std::array::from_fn(|i| keys.number(names[i], given[i], REACH_M, defaults[i]));
    for (low, high) in [(0, 1), (2, 3)] {
        keys.in_order((names[low], given[low], &parameters[low]), (names[high], given[high], &parameters[high]));
    }
    parameters
}

fn avoid_collision(keys: &mut Keys<'_>, raw: &RawAvoidCollision) -> AvoidCollision {
    let given = [raw.inner_m.as_ref(), raw.outer_m.as_ref(), raw.cpa_min_m.as_ref(), raw.cpa_max_m.as_ref()];
    let [inner_m, outer_m, cpa_min_m, cpa_max_m] = clearances(keys, given, [9.0, 15.0, 3.0, 6.0]);
    AvoidCollision {
        contacts: raw.contacts.as_ref().map_or(Contacts::All, |contacts| contacts.value),
        inner_m,
        outer_m,
        cpa_min_m,
        cpa_max_m,
        time_on_leg_s: keys.number("time_on_leg_s", raw.time_on_leg_s.as_ref(), LEG_S, 20.0),
        grade: raw.grade.as_ref().map_or(Grade::Linear, |grade| grade.value),
    }
}

fn avoid_obstacle(keys: &mut Keys<'_>, raw: &RawAvoidObstacle) -> AvoidObstacle {
    let given = [raw.inner_m.as_ref(), raw.outer_m.as_ref(), raw.cpa_min_m.as_ref(), raw.cpa_max_m.as_ref()];
    let [inner_m, outer_m, cpa_min_m, cpa_max_m] = clearances(keys, given, [4.0, 15.0, 1.0, 4.0]);
    let time_on_leg_s = keys.number("time_on_leg_s", raw.time_on_leg_s.as_ref(), LEG_S, 20.0);
    AvoidObstacle { inner_m, outer_m, cpa_min_m, cpa_max_m, time_on_leg_s }
}

fn op_region(keys: &mut Keys<'_>, raw: &RawOpRegion) -> OpRegion {
    OpRegion {
        margin_m: keys.number("margin_m", raw.margin_m.as_ref(), (-1000.0, 1000.0), 0.0),
        save_m: keys.number("save_m", raw.save_m.as_ref(), RADIUS_M, 6.0),
        halt_m: keys.number("halt_m", raw.halt_m.as_ref(), GIVEUP_M, 30.0),
        exit_s: keys.number("exit_s", raw.exit_s.as_ref(), WAIT_S, 1.0),
        entry_s: keys.number("entry_s", raw.entry_s.as_ref(), WAIT_S, 1.0),
        recovery_speed_m_s: keys.number("recovery_speed_m_s", raw.recovery_speed_m_s.as_ref(), SPEED_M_S, 0.5),
        lookahead_s: keys.number("lookahead_s", raw.lookahead_s.as_ref(), WAIT_S, 6.0),
    }
}

fn max_speed(keys: &mut Keys<'_>, raw: &RawMaxSpeed) -> MaxSpeed {
    MaxSpeed {
        speed_m_s: keys.required("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S),
        tolerance_m_s: keys.number("tolerance_m_s", raw.tolerance_m_s.as_ref(), SPEED_M_S, 0.5),
        range_m: keys.number("range_m", raw.range_m.as_ref(), REACH_M, 20.0),
        angle_deg: keys.number("angle_deg", raw.angle_deg.as_ref(), WIDTH_DEG, 55.0),
        contacts: raw.contacts.as_ref().map_or(Contacts::All, |contacts| contacts.value),
    }
}

fn constant_heading(keys: &mut Keys<'_>, raw: &RawConstantHeading) -> ConstantHeading {
    ConstantHeading {
        heading_deg: keys.required("heading_deg", raw.heading_deg.as_ref(), TURN_DEG),
        peak_width_deg: keys.number("peak_width_deg", raw.peak_width_deg.as_ref(), WIDTH_DEG, 10.0),
        base_width_deg: keys.number("base_width_deg", raw.base_width_deg.as_ref(), WIDTH_DEG, 170.0),
    }
}

fn constant_speed(keys: &mut Keys<'_>, raw: &RawConstantSpeed) -> ConstantSpeed {
    ConstantSpeed {
        speed_m_s: keys.required("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S),
        peak_width_m_s: keys.number("peak_width_m_s", raw.peak_width_m_s.as_ref(), SPEED_M_S, 0.0),
        base_width_m_s: keys.number("base_width_m_s", raw.base_width_m_s.as_ref(), SPEED_M_S, 0.2),
    }
}

fn memory_turn_limit(keys: &mut Keys<'_>, raw: &RawMemoryTurnLimit) -> MemoryTurnLimit {
    MemoryTurnLimit {
        memory_s: keys.number("memory_s", raw.memory_s.as_ref(), LEG_S, 20.0),
        turn_range_deg: keys.number("turn_range_deg", raw.turn_range_deg.as_ref(), WIDTH_DEG, 45.0),
    }
}

fn shield(keys: &mut Keys<'_>, raw: &RawShield) -> Option<Shield> {
    let guarded = keys.required_place("guarded", raw.guarded.as_ref());
    let against = match &raw.against {
        Some(against) => keys.boat("against", Some(against)),
        None => Some(Boat::NearestAttacker),
    };
    let distance_m = keys.number("distance_m", raw.distance_m.as_ref(), REACH_M, 10.0);
    let radius_m = keys.number("radius_m", raw.radius_m.as_ref(), RADIUS_M, 3.0);
    let speed_m_s = keys.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S, 5.0);
    let (guarded, against) = (guarded?, against?);
    Some(Shield { guarded, against, distance_m, radius_m, speed_m_s })
}

fn attractor(keys: &mut Keys<'_>, raw: &RawAttractor) -> Option<Attractor> {
    let to = keys.required_place("to", raw.to.as_ref());
    let (inner, outer) = (raw.inner_m.as_ref(), raw.outer_m.as_ref());
    let inner_m = keys.number("inner_m", inner, REACH_M, 10.0);
    let outer_m = keys.number("outer_m", outer, REACH_M, 50.0);
    keys.in_order(("inner_m", inner, &inner_m), ("outer_m", outer, &outer_m));
    let speed_m_s = keys.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S, 5.0);
    to.map(|to| Attractor { to, inner_m, outer_m, speed_m_s })
}

fn policy(keys: &mut Keys<'_>, raw: &RawPolicy) -> Policy {
    Policy {
        by: raw.by.as_ref().map_or(Proposer::Program, |by| by.value),
        ttl_s: keys.number("ttl_s", raw.ttl_s.as_ref(), (0.01, 600.0), 1.0),
        peak_width_deg: keys.number("peak_width_deg", raw.peak_width_deg.as_ref(), WIDTH_DEG, 10.0),
        base_width_deg: keys.number("base_width_deg", raw.base_width_deg.as_ref(), WIDTH_DEG, 60.0),
        course_share: keys.number("course_share", raw.course_share.as_ref(), SHARE, 0.5),
    }
}
