//! A gateway file, checked.

use super::boat::thrust_map;
use crate::gateway::{
    BatteryWatch, CompassFrame, ControlWatch, Drive, Gateway, Geofence, Halt, Limits, Loops, LowBattery, NavWatch,
    SURVEYOR_THRUST_MAP,
};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{
    At, RawBatteryWatch, RawControlWatch, RawGateway, RawGeofence, RawHalt, RawLimits, RawLoops, RawNavWatch,
};
use crate::scenario::read::Document;

/// Checks a gateway.
pub(in crate::scenario) fn gateway(diagnostics: &mut Diagnostics, document: &Document<RawGateway>) -> Option<Gateway> {
    let faults = diagnostics.faults();
    let raw = document.raw.clone();
    let declination_deg = diagnostics.number("declination_deg", raw.declination_deg.as_ref(), -180.0..=180.0);
    let gateway = Gateway {
        name: document.name.clone(),
        drive: raw.drive.map_or(Drive::Thrust, Drive::from),
        declination_rad: declination_deg.map(f64::to_radians),
        compass: raw.compass.map_or(CompassFrame::Magnetic, CompassFrame::from),
        rate_hz: number(diagnostics, "rate_hz", &raw.rate_hz, (1.0, 20.0), 10.0),
        order_ttl_s: number(diagnostics, "order_ttl_s", &raw.order_ttl_s, (0.1, 10.0), 1.0),
        upload_gap_s: number(diagnostics, "upload_gap_s", &raw.upload_gap_s, (0.005, 5.0), 0.1),
        limits: limits(diagnostics, &raw.limits.unwrap_or_default()),
        nav: nav(diagnostics, &raw.nav.unwrap_or_default()),
        fence: fence(diagnostics, &raw.fence.unwrap_or_default()),
        halt: halt(diagnostics, &raw.halt.unwrap_or_default()),
        battery: battery(diagnostics, &raw.battery.unwrap_or_default()),
        control: control(diagnostics, &raw.control.unwrap_or_default()),
        loops: loops(diagnostics, &raw.loops.unwrap_or_default()),
    };
    (diagnostics.faults() == faults).then_some(gateway)
}

fn number(
    diagnostics: &mut Diagnostics,
    key: &str,
    given: &Option<At<f64>>,
    (low, high): (f64, f64),
    default: f64,
) -> f64 {
    diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
}

fn limits(diagnostics: &mut Diagnostics, raw: &RawLimits) -> Limits {
    Limits {
        speed_max_m_s: number(diagnostics, "speed_max_m_s", &raw.speed_max_m_s, (0.1, 20.0), 3.0),
        thrust_max_pct: number(diagnostics, "thrust_max_pct", &raw.thrust_max_pct, (1.0, 100.0), 70.0),
        difference_max_pct: number(diagnostics, "difference_max_pct", &raw.difference_max_pct, (1.0, 100.0), 50.0),
        slew_pct_s: number(diagnostics, "slew_pct_s", &raw.slew_pct_s, (1.0, 10_000.0), 100.0),
    }
}

fn nav(diagnostics: &mut Diagnostics, raw: &RawNavWatch) -> NavWatch {
    NavWatch {
        age_max_s: number(diagnostics, "age_max_s", &raw.age_max_s, (0.1, 10.0), 1.5),
        quality_min: diagnostics.whole("quality_min", raw.quality_min.as_ref(), 1..=8, 1) as u8,
        hdop_max: number(diagnostics, "hdop_max", &raw.hdop_max, (0.5, 50.0), 5.0),
        jump_m: number(diagnostics, "jump_m", &raw.jump_m, (0.5, 100.0), 5.0),
        frozen_s: number(diagnostics, "frozen_s", &raw.frozen_s, (0.5, 60.0), 3.0),
    }
}

fn fence(diagnostics: &mut Diagnostics, raw: &RawGeofence) -> Geofence {
    Geofence {
        margin_m: number(diagnostics, "margin_m", &raw.margin_m, (0.0, 10_000.0), 30.0),
        deceleration_m_s2: number(diagnostics, "deceleration_m_s2", &raw.deceleration_m_s2, (0.01, 10.0), 0.25),
        reaction_s: number(diagnostics, "reaction_s", &raw.reaction_s, (0.0, 10.0), 1.0),
        debounce_s: number(diagnostics, "debounce_s", &raw.debounce_s, (0.0, 10.0), 0.5),
    }
}

fn halt(diagnostics: &mut Diagnostics, raw: &RawHalt) -> Halt {
    Halt {
        ahead_m: number(diagnostics, "ahead_m", &raw.ahead_m, (0.0, 100.0), 7.0),
        width_m: number(diagnostics, "width_m", &raw.width_m, (0.5, 100.0), 3.0),
        clear_s: number(diagnostics, "clear_s", &raw.clear_s, (0.0, 60.0), 1.0),
    }
}

fn battery(diagnostics: &mut Diagnostics, raw: &RawBatteryWatch) -> BatteryWatch {
    BatteryWatch {
        volts_min: number(diagnostics, "volts_min", &raw.volts_min, (0.0, 1000.0), 22.0),
        debounce_s: number(diagnostics, "debounce_s", &raw.debounce_s, (0.0, 600.0), 5.0),
        action: raw.action.map_or(LowBattery::Standby, LowBattery::from),
    }
}

fn control(diagnostics: &mut Diagnostics, raw: &RawControlWatch) -> ControlWatch {
    ControlWatch {
        assumed: raw.assumed.is_some_and(|given| given.value),
        age_max_s: number(diagnostics, "age_max_s", &raw.age_max_s, (0.1, 30.0), 2.0),
        echo_s: number(diagnostics, "echo_s", &raw.echo_s, (0.2, 30.0), 1.5),
    }
}

fn loops(diagnostics: &mut Diagnostics, raw: &RawLoops) -> Loops {
    let heading = number(diagnostics, "heading_pct_per_deg", &raw.heading_pct_per_deg, (0.0, 100.0), 0.9);
    let turn = number(diagnostics, "turn_pct_per_deg_s", &raw.turn_pct_per_deg_s, (0.0, 100.0), 1.4);
    Loops {
        thrust_map: match &raw.thrust_map {
            Some(given) => thrust_map(diagnostics, given),
            None => SURVEYOR_THRUST_MAP.to_vec(),
        },
        speed_pct_per_m_s: number(diagnostics, "speed_pct_per_m_s", &raw.speed_pct_per_m_s, (0.0, 1000.0), 15.0),
        speed_integral_s: number(diagnostics, "speed_integral_s", &raw.speed_integral_s, (0.1, 1000.0), 5.0),
        heading_pct_per_rad: heading.to_degrees(),
        turn_pct_per_rad_s: turn.to_degrees(),
    }
}
