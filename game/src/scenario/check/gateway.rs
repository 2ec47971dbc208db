//! A gateway file, checked.

use super::boat::thrust_map;
use crate::gateway::{
    BatteryWatch, CompassFrame, ControlWatch, Drive, Fence, Gateway, Halt, Limits, Loops, LowBattery, NavWatch,
    SURVEYOR_THRUST_MAP,
};
use crate::scenario::ledger::Ledger;
use crate::scenario::raw::{
    At, RawBatteryWatch, RawControlWatch, RawFence, RawGateway, RawHalt, RawLimits, RawLoops, RawNavWatch,
};
use crate::scenario::read::Document;

/// Checks a gateway.
pub(in crate::scenario) fn gateway(ledger: &mut Ledger, document: &Document<RawGateway>) -> Option<Gateway> {
    let faults = ledger.faults();
    let raw = document.raw.clone();
    let declination_deg = ledger.number("declination_deg", raw.declination_deg.as_ref(), -180.0..=180.0);
    let gateway = Gateway {
        name: document.name.clone(),
        drive: raw.drive.map_or(Drive::Thrust, Drive::from),
        declination_rad: declination_deg.map(f64::to_radians),
        compass: raw.compass.map_or(CompassFrame::Magnetic, CompassFrame::from),
        rate_hz: number(ledger, "rate_hz", &raw.rate_hz, (1.0, 20.0), 10.0),
        order_ttl_s: number(ledger, "order_ttl_s", &raw.order_ttl_s, (0.1, 10.0), 1.0),
        upload_gap_s: number(ledger, "upload_gap_s", &raw.upload_gap_s, (0.005, 5.0), 0.1),
        limits: limits(ledger, &raw.limits.unwrap_or_default()),
        nav: nav(ledger, &raw.nav.unwrap_or_default()),
        fence: fence(ledger, &raw.fence.unwrap_or_default()),
        halt: halt(ledger, &raw.halt.unwrap_or_default()),
        battery: battery(ledger, &raw.battery.unwrap_or_default()),
        control: control(ledger, &raw.control.unwrap_or_default()),
        loops: loops(ledger, &raw.loops.unwrap_or_default()),
    };
    (ledger.faults() == faults).then_some(gateway)
}

fn number(ledger: &mut Ledger, key: &str, given: &Option<At<f64>>, (low, high): (f64, f64), default: f64) -> f64 {
    ledger.number(key, given.as_ref(), low..=high).unwrap_or(default)
}

fn limits(ledger: &mut Ledger, raw: &RawLimits) -> Limits {
    Limits {
        speed_max_m_s: number(ledger, "speed_max_m_s", &raw.speed_max_m_s, (0.1, 20.0), 3.0),
        thrust_max_pct: number(ledger, "thrust_max_pct", &raw.thrust_max_pct, (1.0, 100.0), 70.0),
        difference_max_pct: number(ledger, "difference_max_pct", &raw.difference_max_pct, (1.0, 100.0), 50.0),
        slew_pct_s: number(ledger, "slew_pct_s", &raw.slew_pct_s, (1.0, 10_000.0), 100.0),
    }
}

fn nav(ledger: &mut Ledger, raw: &RawNavWatch) -> NavWatch {
    NavWatch {
        age_max_s: number(ledger, "age_max_s", &raw.age_max_s, (0.1, 10.0), 1.5),
        quality_min: ledger.whole("quality_min", raw.quality_min.as_ref(), 1..=8, 1) as u8,
        hdop_max: number(ledger, "hdop_max", &raw.hdop_max, (0.5, 50.0), 5.0),
        jump_m: number(ledger, "jump_m", &raw.jump_m, (0.5, 100.0), 5.0),
        frozen_s: number(ledger, "frozen_s", &raw.frozen_s, (0.5, 60.0), 3.0),
    }
}

fn fence(ledger: &mut Ledger, raw: &RawFence) -> Fence {
    Fence {
        margin_m: number(ledger, "margin_m", &raw.margin_m, (0.0, 10_000.0), 30.0),
        deceleration_m_s2: number(ledger, "deceleration_m_s2", &raw.deceleration_m_s2, (0.01, 10.0), 0.25),
        reaction_s: number(ledger, "reaction_s", &raw.reaction_s, (0.0, 10.0), 1.0),
        debounce_s: number(ledger, "debounce_s", &raw.debounce_s, (0.0, 10.0), 0.5),
    }
}

fn halt(ledger: &mut Ledger, raw: &RawHalt) -> Halt {
    Halt {
        ahead_m: number(ledger, "ahead_m", &raw.ahead_m, (0.0, 100.0), 7.0),
        width_m: number(ledger, "width_m", &raw.width_m, (0.5, 100.0), 3.0),
        clear_s: number(ledger, "clear_s", &raw.clear_s, (0.0, 60.0), 1.0),
    }
}

fn battery(ledger: &mut Ledger, raw: &RawBatteryWatch) -> BatteryWatch {
    BatteryWatch {
        volts_min: number(ledger, "volts_min", &raw.volts_min, (0.0, 1000.0), 22.0),
        debounce_s: number(ledger, "debounce_s", &raw.debounce_s, (0.0, 600.0), 5.0),
        action: raw.action.map_or(LowBattery::Standby, LowBattery::from),
    }
}

fn control(ledger: &mut Ledger, raw: &RawControlWatch) -> ControlWatch {
    ControlWatch {
        assumed: raw.assumed.is_some_and(|given| given.value),
        age_max_s: number(ledger, "age_max_s", &raw.age_max_s, (0.1, 30.0), 2.0),
        echo_s: number(ledger, "echo_s", &raw.echo_s, (0.2, 30.0), 1.5),
    }
}

fn loops(ledger: &mut Ledger, raw: &RawLoops) -> Loops {
    let heading = number(ledger, "heading_pct_per_deg", &raw.heading_pct_per_deg, (0.0, 100.0), 0.9);
    let turn = number(ledger, "turn_pct_per_deg_s", &raw.turn_pct_per_deg_s, (0.0, 100.0), 1.4);
    Loops {
        thrust_map: match &raw.thrust_map {
            Some(given) => thrust_map(ledger, given),
            None => SURVEYOR_THRUST_MAP.to_vec(),
        },
        speed_pct_per_m_s: number(ledger, "speed_pct_per_m_s", &raw.speed_pct_per_m_s, (0.0, 1000.0), 15.0),
        speed_integral_s: number(ledger, "speed_integral_s", &raw.speed_integral_s, (0.1, 1000.0), 5.0),
        heading_pct_per_rad: heading.to_degrees(),
        turn_pct_per_rad_s: turn.to_degrees(),
    }
}
