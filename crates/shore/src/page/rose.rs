//! The rose: a helm's evaluation as drawn on the page, with utilities as whole percentages.

use super::message::PageMessage;
use messages::helm::{BehaviourReport, HelmReport, PolicyReport, VariableReport};
use primitives::VehicleId;
use scenario::Scenario;
use serde::Serialize;

/// A helm's report, as defined in `PROTOCOL.md`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Helm {
    pub(super) at_s: f64,
    pub(super) program: String,
    pub(super) mode: String,
    pub(super) course_deg: Option<f64>,
    pub(super) speed_m_s: Option<f64>,
    pub(super) hold: Option<String>,
    pub(super) behaviours: Vec<BehaviourReport>,
    pub(super) policies: Vec<Policy>,
    pub(super) variables: Vec<VariableReport>,
    pub(super) courses: usize,
    pub(super) speeds: usize,
    pub(super) speed_max_m_s: f64,
    pub(super) functions: Vec<Function>,
    pub(super) collective: Option<Vec<u8>>,
}

/// A trained policy at its last decision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Policy {
    pub(super) behaviour: String,
    pub(super) model: String,
    pub(super) course_deg: Option<f64>,
    pub(super) speed_m_s: Option<f64>,
    pub(super) option: Option<String>,
    pub(super) fault: Option<String>,
    pub(super) actions: Vec<(String, f32)>,
    pub(super) observed: Vec<(String, f32)>,
}

/// Number of actions listed per policy, most likely first.
const ACTIONS: usize = 4;

/// An objective function.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Function {
    pub(super) behaviour: String,
    pub(super) contact: Option<String>,
    pub(super) weight: f64,
    pub(super) utility: Option<f32>,
    pub(super) utilities: Vec<u8>,
}

impl Helm {
    /// Converts a valid report: names replace indices, and utilities are included if requested.
    pub(super) fn new(scenario: &Scenario, report: &HelmReport, has_utilities: bool) -> Helm {
        let percents = |utilities: &[f32]| {
            utilities
                .iter()
                .map(|utility| whole(f64::from(*utility)))
                .collect()
        };
        let function = |function: &messages::helm::FunctionReport| Function {
            behaviour: function.behaviour.clone(),
            contact: function
                .contact
                .and_then(|v| Some(scenario.vehicles.get(v.index())?.name.clone())),
            weight: function.weight,
            utility: function.utility,
            utilities: if has_utilities {
                percents(&function.utilities)
            } else {
                vec![]
            },
        };
        let policy = |policy: &PolicyReport| {
            let mut words = policy.words(scenario, report.vehicle);
            words.actions.truncate(ACTIONS);
            Policy {
                behaviour: policy.behaviour.clone(),
                model: policy.model.clone(),
                course_deg: policy.course_deg,
                speed_m_s: policy.speed_m_s,
                option: policy.option.clone(),
                fault: policy.fault.clone(),
                actions: words.actions,
                observed: if has_utilities {
                    words.observed
                } else {
                    vec![]
                },
            }
        };
        Helm {
            at_s: report.at.as_s(),
            program: report.program.clone(),
            mode: report.mode.clone(),
            course_deg: report.course_deg,
            speed_m_s: report.speed_m_s,
            hold: report.hold.clone(),
            behaviours: report.behaviours.clone(),
            policies: report.policies.iter().map(policy).collect(),
            variables: report.variables.clone(),
            courses: report.courses,
            speeds: report.speeds,
            speed_max_m_s: report.speed_max_m_s,
            functions: report.functions.iter().map(function).collect(),
            collective: if has_utilities {
                collective(report)
            } else {
                None
            },
        }
    }
}

/// The state of a helm at a decision.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HelmAnswer {
    /// The report, if any.
    pub report: Option<HelmReport>,
    /// Why there is no report.
    pub reason: Option<String>,
    /// Whether the report was recomputed rather than received from the helm.
    pub computed: bool,
    /// Whether the recomputed order equals the recorded one.
    pub agrees: Option<bool>,
}

/// The message to a page about a helm.
pub(super) fn helm_text(
    scenario: &Scenario,
    vehicle: VehicleId,
    functions: bool,
    answer: HelmAnswer,
) -> String {
    let HelmAnswer {
        report,
        mut reason,
        computed,
        agrees,
    } = answer;
    let sound = report
        .as_ref()
        .filter(|report| is_sound(report, vehicle, scenario.vehicles.len()));
    if report.is_some() && sound.is_none() {
        reason = Some("the reply is invalid".to_owned());
    }
    let helm = sound.map(|report| Helm::new(scenario, report, functions));
    let reason = if helm.is_some() {
        None
    } else {
        reason.or_else(|| Some("no reason given".to_owned()))
    };
    let name = scenario
        .vehicles
        .get(vehicle.index())
        .map_or("", |vehicle| &vehicle.name);
    PageMessage::Helm {
        vehicle: name,
        report: helm.as_ref(),
        reason: reason.as_deref(),
        computed,
        agrees,
    }
    .json()
}

/// Whether a report is consistent and refers to this vehicle. Replies from agents are not trusted.
pub fn is_sound(report: &HelmReport, vehicle: VehicleId, vehicles: usize) -> bool {
    let is_grid = (1..=3600).contains(&report.courses)
        && (2..=1000).contains(&report.speeds)
        && report.speed_max_m_s.is_finite()
        && report.speed_max_m_s > 0.0;
    let is_whole = |count: usize| count == 0 || count == report.courses * report.speeds;
    report.vehicle == vehicle
        && is_grid
        && report.functions.iter().all(|function| {
            is_whole(function.utilities.len())
                && function
                    .contact
                    .is_none_or(|contact| contact.index() < vehicles)
        })
}

/// The weighted sum of all functions, scaled so that its minimum is 0 and its maximum 100. `None`
/// without functions.
fn collective(report: &HelmReport) -> Option<Vec<u8>> {
    report
        .functions
        .iter()
        .find(|function| !function.utilities.is_empty())?;
    let sums = report.sum(report.functions.iter());
    let (least, greatest) = sums
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), sum| {
            (least.min(*sum), most.max(*sum))
        });
    let range = greatest - least;
    // If all courses have the same value, none is worse than the others.
    let share = |sum: &f64| {
        if range > 0.0 {
            whole((sum - least) / range * 100.0)
        } else {
            100
        }
    };
    Some(sums.iter().map(share).collect())
}

/// The nearest whole number from 0 to 100; 0 for NaN.
fn whole(per_cent: f64) -> u8 {
    per_cent.round().clamp(0.0, 100.0) as u8
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use messages::helm::FunctionReport;
    use primitives::SimTime;
    use proptest::prelude::*;
    use serde_json::json;

    pub(in super::super) fn scenario() -> Scenario {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/games/pav01_vs_pav01.toml");
        scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
    }

    fn function(weight: f64, utilities: &[f32]) -> FunctionReport {
        let contact = Some(VehicleId(1));
        FunctionReport {
            behaviour: "go".into(),
            contact,
            weight,
            utility: Some(50.0),
            utilities: utilities.to_vec(),
        }
    }

    fn report(functions: Vec<FunctionReport>) -> HelmReport {
        let report = json!({"vehicle": 0, "at": SimTime::from_s(1.5), "program": "pav01", "mode": "attacking",
            "courses": 2, "speeds": 2, "speed_max_m_s": 2.0, "behaviours": [], "variables": [], "functions": []});
        HelmReport {
            functions,
            ..serde_json::from_value(report).expect("a report")
        }
    }

    #[test]
    fn utilities_are_whole_and_their_sum_goes_from_its_least_to_its_greatest() {
        let all = report(vec![
            function(100.0, &[0.0, 49.6, 100.0, 20.0]),
            function(300.0, &[0.0, 0.0, 100.0, 80.0]),
        ]);
        let helm = Helm::new(&scenario(), &all, true);
        assert_eq!(helm.functions[0].utilities, [0, 50, 100, 20]);
        assert_eq!(helm.functions[0].contact.as_deref(), Some("blue_two"));
        assert_eq!(helm.collective, Some(vec![0, 12, 100, 65]));
        assert_eq!(helm.at_s, 1.5);
        let light = Helm::new(&scenario(), &all, false);
        assert_eq!(
            (
                light.collective,
                light.functions[1].utilities.len(),
                light.functions[1].weight
            ),
            (None, 0, 300.0)
        );
    }

    #[test]
    fn a_flat_sum_and_no_sum_are_told_apart() {
        let scenario = scenario();
        assert_eq!(Helm::new(&scenario, &report(vec![]), true).collective, None);
        assert_eq!(
            Helm::new(&scenario, &report(vec![function(1.0, &[])]), true).collective,
            None
        );
        let flat = Helm::new(
            &scenario,
            &report(vec![function(1.0, &[7.0, 7.0, 7.0, 7.0])]),
            true,
        );
        assert_eq!(flat.collective, Some(vec![100; 4]));
    }

    #[test]
    fn reports_that_make_no_sense_are_told_from_those_that_do() {
        let good = report(vec![function(1.0, &[0.0; 4])]);
        assert!(is_sound(&good, VehicleId(0), 2) && is_sound(&report(vec![]), VehicleId(0), 2));
        assert!(
            !is_sound(&good, VehicleId(1), 2),
            "a report on another boat"
        );
        assert!(
            !is_sound(&good, VehicleId(0), 1),
            "a contact that does not exist"
        );
        for bad in [
            report(vec![function(1.0, &[0.0; 3])]),
            HelmReport {
                courses: usize::MAX,
                ..report(vec![])
            },
            HelmReport {
                speed_max_m_s: f64::NAN,
                ..good.clone()
            },
        ] {
            assert!(!is_sound(&bad, VehicleId(0), 2), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn any_numbers_make_whole_ones(weights in prop::array::uniform2(any::<f64>()), values in prop::array::uniform8(any::<f32>())) {
            let all = report(vec![function(weights[0], &values[..4]), function(weights[1], &values[4..])]);
            let helm = Helm::new(&scenario(), &all, true);
            prop_assert!(helm.collective.is_some_and(|sums| sums.iter().all(|sum| *sum <= 100)));
            prop_assert!(helm.functions.iter().all(|f| f.utilities.iter().all(|utility| *utility <= 100)));
        }
    }
}
