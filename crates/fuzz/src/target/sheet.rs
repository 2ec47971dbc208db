//! CSV tables from trials: commands to replay, and logs to fit.

use super::{Target, check_shown, mutations};
use crate::played::scenarios;
use primitives::SimTime;
use scenario::boat::Boat;
use std::fmt::Write;
use std::sync::LazyLock;
use trial::identify::Log;
use trial::{Engine, LONGEST_S, Mistake, Orders, Sheet};

pub(super) const TARGET: Target = Target {
    name: "sheet",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 20, 1000),
};

/// Boats with propellers, a thrust table, and a rudder.
static BOATS: LazyLock<[Boat; 3]> = LazyLock::new(|| {
    ["otter", "heron", "surveyor_kinematic"].map(|name| {
        let file = scenarios().join("boats").join(name).with_extension("toml");
        scenario::load_file(&file).unwrap_or_else(|e| panic!("{e}"))
    })
});

fn seeds() -> Vec<Vec<u8>> {
    let table = |heads: &str, row: &str| {
        let mut text = format!("t_s,{heads}\n# a remark\n");
        (0..25).for_each(|i| writeln!(text, "{}.5,{row}", i * 3).expect("a string accepts text"));
        text.into_bytes()
    };
    vec![
        table("port_pct,starboard_pct", "50,-50.0"),
        table("Port (rad/s), Starboard (rad/s)", "80,1e1"),
        table("port_newton,starboard_newton", "10,-10"),
        table("thrust_pct,rudder_pct", "100, -20"),
        table("speed_m_s,heading_deg,remark", "1.5,270,\"a, b\""),
        table(
            "port_pct,starboard_pct,x_m,y_m,heading_deg,surge_m_s,sway_m_s,yaw_rate_deg_s",
            "5,5,1,2,359,1,,nan",
        ),
    ]
}

fn check(bytes: &[u8]) {
    let lines = bytes.iter().filter(|byte| b"\r\n".contains(byte)).count() as u64 + 1;
    let sheet = match Sheet::read("in.csv", bytes) {
        Ok(sheet) => sheet,
        Err(mistake) => return check_place(&mistake, lines),
    };
    for boat in BOATS.iter() {
        match Orders::of_sheet(&sheet, &Engine::new(boat)) {
            Ok(orders) => {
                assert!(orders.end() <= SimTime::from_s(LONGEST_S));
                let _ =
                    [-1.0, 0.0, 1.0, LONGEST_S, 1e9].map(|at_s| orders.at(SimTime::from_s(at_s)));
            }
            Err(mistake) => check_place(&mistake, lines),
        }
        if let Err(mistake) = Log::of_sheet(&sheet, boat) {
            check_place(&mistake, lines);
        }
    }
}

fn check_place(mistake: &Mistake, lines: u64) {
    check_shown(mistake);
    assert!(
        mistake.file == "in.csv" && mistake.line.is_none_or(|line| (1..=lines).contains(&line)),
        "{mistake:?}"
    );
}
