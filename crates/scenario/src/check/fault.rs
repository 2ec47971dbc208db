//! Checks the faults of a game against the affected boats.

use crate::boat::{Boat, Drive};
use crate::fault::{Fault, FaultKind};
use crate::read::Document;
use crate::{Vehicle, raw};
use primitives::id::VehicleId;

pub(super) fn faults(
    document: &Document<raw::Game>,
    vehicles: &[Vehicle],
    boats: &[Boat],
) -> Vec<Fault> {
    let mut faults = vec![];
    for (name, fault) in &document.raw.fault {
        let path = format!("fault.{name}");
        document.is_name(&path, "fault", name);
        if !document.is_sound(&path) {
            continue;
        }
        let mut fault = Fault {
            name: name.clone(),
            ..fault.clone()
        };
        check_keys(document, &path, &fault);
        let known: Vec<&str> = vehicles.iter().map(|v| v.name.as_str()).collect();
        for (i, boat) in fault.boats.iter().enumerate() {
            if !known.contains(&boat.as_str()) {
                let message = format!("boats has {boat:?}, expected any of {}", known.join(", "));
                document.note(&format!("{path}.boats.{i}"), message);
            }
        }
        let is_hit =
            |(_, v): &(usize, &Vehicle)| fault.boats.is_empty() || fault.boats.contains(&v.name);
        let hit: Vec<_> = vehicles.iter().enumerate().filter(is_hit).collect();
        fault.vehicles = hit.iter().map(|(i, _)| VehicleId::at(*i)).collect();
        let lacking = hit.iter().find_map(|(_, vehicle)| {
            let boat = &boats[vehicle.boat];
            Some((&vehicle.name, &boat.name, lacks(fault.kind, boat)?))
        });
        if let Some((vehicle, boat, lacks)) = lacking {
            let message = format!(
                "{name} affects {vehicle}, whose boat {boat} has no {lacks}, which this fault requires"
            );
            document.note(&path, message);
        }
        faults.push(fault);
    }
    faults
}

fn check_keys(document: &Document<raw::Game>, path: &str, fault: &Fault) {
    if fault.at_s.is_some() == fault.every_s.is_some() {
        let found = if fault.at_s.is_some() {
            "both at_s and every_s"
        } else {
            "neither at_s nor every_s"
        };
        document.note(path, format!("{path} has {found}, expected one of them"));
    }
    for (key, kind, given) in [
        ("offset_m", FaultKind::GpsOffset, fault.offset_m),
        ("offset_deg", FaultKind::CompassOffset, fault.offset_deg),
    ] {
        let is_given = given.is_some();
        if is_given != (fault.kind == kind) {
            let message = match is_given {
                true => format!("{key} is given, but this kind of fault does not use it"),
                false => format!("{key} is missing, but this kind of fault requires it"),
            };
            document.note(&format!("{path}.{key}"), message);
        }
    }
}

/// The part that this kind of fault requires and the boat lacks.
fn lacks(kind: FaultKind, boat: &Boat) -> Option<&'static str> {
    match kind {
        FaultKind::AgentLost | FaultKind::LinkLost => None,
        FaultKind::GpsFrozen | FaultKind::GpsLost | FaultKind::GpsOffset => {
            boat.sensors.gps.is_none().then_some("gps")
        }
        FaultKind::CompassOffset => boat.sensors.compass.is_none().then_some("compass"),
        _ => matches!(boat.drive, Drive::Kinematic(_)).then_some("thrusters"),
    }
}
