//! Training learns within seconds and is reproducible on any machine.

use super::fixture::{self, file, stage, trained, trainer, training, updated};
use super::off_policy_training;
use learn::environment::{Moment, Watch};
use learn::train::{StateError, Trainer};
use learn::training::{CriticInput, Evaluation, Ppo, Stage, Teacher, Training};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex};

#[test]
fn a_policy_learns_to_beat_an_idle_team_and_to_score_against_pav01() {
    let opponents = ["strategies/pav01.toml", "strategies/idle.toml"]
        .map(file)
        .into();
    let training = Training {
        evaluation: Evaluation {
            every_samples: 100_000,
            games: 20,
            opponents,
        },
        ..training("first")
    };
    let mut trainer = trainer(training, 2);
    let mut seen = vec![];
    while trainer.samples().0 < 310_000 {
        seen.extend(updated(&mut trainer).evaluated);
    }
    let points: Vec<f64> = seen
        .iter()
        .map(|evaluated| evaluated.played[0].1.points[0])
        .collect();
    assert!(
        points.len() == 3 && points.iter().all(|points| *points > 3.0),
        "points per game against pav01: {points:?}"
    );
    let idle = seen
        .last()
        .map_or(0.0, |evaluated| evaluated.played[1].1.won());
    assert!(
        idle >= 0.9,
        "won a fraction of {idle} of the games against an idle team"
    );
}

/// Short stages that use a helm, a teacher, a strategy and past policies.
fn short() -> Training {
    let direct = stage("direct", "games/pav01_afloat.toml", None);
    let teacher = Some(Teacher {
        strategy: file("strategies/strategy_2.toml"),
        drives: true,
        options: BTreeMap::new(),
    });
    let taught = Stage {
        name: "taught".to_owned(),
        teacher,
        ..direct.clone()
    };
    let advised = Stage {
        name: "advised".to_owned(),
        teacher: taught.teacher.clone().map(|teacher| Teacher {
            drives: false,
            ..teacher
        }),
        ..direct.clone()
    };
    let helm = stage(
        "helm",
        "games/surveyor_2v2.toml",
        Some("strategies/policy.toml"),
    );
    let mut training = fixture::short(training("first"), vec![direct, taught, advised, helm]);
    training.network.critic = CriticInput::Truth;
    training.ppo = Ppo {
        steps: 32,
        minibatch: 256,
        ..fixture::ppo()
    };
    training
}

#[test]
fn the_same_file_trains_the_same_weights_on_any_number_of_threads_and_resumed() {
    let [td3, dqn] = off_policy_training::algorithms().map(off_policy_training::short);
    for (name, training) in [("ppo", short()), ("td3", td3), ("dqn", dqn)] {
        let run = |threads| trained(trainer(training.clone(), threads));
        let (state, progress) = run(1);
        let opponents: BTreeSet<&str> = progress
            .iter()
            .flat_map(|one| &one.finished)
            .map(|(_, name)| name.as_str())
            .collect();
        assert!(
            opponents.contains("itself") && opponents.contains("pav01"),
            "{name}: {opponents:?}"
        );
        assert!(
            opponents.iter().any(|name| name.starts_with("after ")),
            "{name}: {opponents:?}"
        );
        let learnt = progress
            .iter()
            .filter(|one| one.learnt.epochs.is_some())
            .count();
        let is_off_policy = name != "ppo";
        assert!(
            !is_off_policy || learnt > 20,
            "{name}: {learnt} of {} updates learned",
            progress.len()
        );
        assert_eq!(
            learnt < progress.len(),
            is_off_policy,
            "{name}: only a buffer has to fill first"
        );
        assert!(
            run(3) == (state.clone(), progress),
            "{name}: 3 threads gave different results"
        );

        // Resumed whenever games restart, and at every fifth update, where games and past policies
        // continue.
        let mut trainer = trainer(training.clone(), 2);
        let mut taken_up = [0; 2];
        for update in 0.. {
            if trainer.is_over() {
                break;
            }
            let restart = updated(&mut trainer).games_restart;
            if restart || update % 5 == 0 {
                let resumed = Trainer::resume(training.clone(), 2, &trainer.state());
                trainer = resumed.unwrap_or_else(|error| panic!("{name}: {error}"));
                taken_up[usize::from(restart)] += 1;
            }
        }
        assert!(
            taken_up.iter().all(|times| *times > 1),
            "{name}: {taken_up:?}"
        );
        assert!(
            trainer.state() == state,
            "{name}: different results after resuming {taken_up:?} times"
        );
    }
}

#[test]
fn episodes_that_are_seen_have_the_numbers_that_are_told_and_change_nothing() {
    let (plain, _) = trained(trainer(short(), 2));
    let ended: Arc<Mutex<BTreeSet<(u64, u64)>>> = Arc::default();
    let kept = Arc::clone(&ended);
    let watches = move |number: u64| {
        number.is_multiple_of(3).then(|| -> Watch {
            let kept = Arc::clone(&kept);
            Box::new(move |contest, moment| {
                if moment == Moment::End {
                    kept.lock()
                        .expect("no thread has panicked")
                        .insert((contest.scenario().seed, number));
                }
            })
        })
    };
    let mut trainer = trainer(short(), 2);
    trainer.watch(Arc::new(watches)).unwrap();
    let (state, progress) = trained(trainer);
    assert!(state == plain, "watching changed the training");
    let told = progress
        .iter()
        .flat_map(|one| &one.finished)
        .map(|(one, _)| (one.standing.seed, one.number));
    let told: BTreeSet<(u64, u64)> = told
        .filter(|(_, number)| number.is_multiple_of(3))
        .collect();
    assert!(told.len() > 10, "{told:?}");
    assert_eq!(told, *ended.lock().expect("no thread has panicked"));
}

/// Imitates strategy 2 with the options of a different strategy.
fn imitation(options: &[(&str, &str)]) -> Training {
    let options = options
        .iter()
        .map(|(mode, option)| ((*mode).to_owned(), (*option).to_owned()))
        .collect();
    let teacher = Some(Teacher {
        strategy: file("strategies/strategy_5.toml"),
        drives: true,
        options,
    });
    let helm = Some(file("strategies/options.toml"));
    let stage = Stage {
        teacher,
        helm,
        samples: 40_000,
        ..short().stage.remove(0)
    };
    Training {
        stage: vec![stage],
        action: training("options").action,
        period_s: 1.0,
        ppo: Ppo {
            learning_rate: 3e-3,
            ..short().ppo
        },
        ..short()
    }
}

const OPTIONS: [(&str, &str); 5] = [
    ("raiding", "attack"),
    ("intercepting", "pursue"),
    ("keeping", "hold"),
    ("waiting", "wait"),
    ("chasing", "chase"),
];

#[test]
fn a_policy_learns_to_choose_what_its_teacher_is_at() {
    let (_, progress) = trained(trainer(imitation(&OPTIONS), 2));
    assert!(progress.iter().all(|one| one.learnt.clipped == Some(0.0)));
    let losses: Vec<f32> = progress
        .iter()
        .filter_map(|one| one.learnt.policy_loss)
        .collect();
    // At first, the policy chooses among ten options at random.
    let first = losses[0];
    let last = losses[losses.len() - 1];
    assert!(first > 1.5 && last < 0.7, "cross-entropy, nats: {losses:?}");
}

#[test]
fn a_teacher_whose_modes_are_no_options_is_refused() {
    let refused = |options: &[(&str, &str)]| match Trainer::new(imitation(options), 1) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{options:?}"),
    };
    for (options, want) in [
        (&[("raiding", "fly")][..], "\"fly\", expected attack, rush"),
        (
            &[("flying", "attack")],
            "flying, expected a mode of strategy_5: ",
        ),
        (&[("flying", "attack")], "raiding"),
        (&[], "strategy_5, whose modes match no option"),
    ] {
        let message = refused(options);
        assert!(message.contains(want), "{message}");
    }
}

#[test]
fn a_state_of_another_training_is_refused() {
    let state = trainer(short(), 1).state();
    let other = Training { seed: 2, ..short() };
    assert!(matches!(
        Trainer::resume(other, 1, &state),
        Err(StateError::Other)
    ));
    assert!(matches!(
        Trainer::resume(short(), 1, &state[..100]),
        Err(StateError::Damaged)
    ));
    let mut newer = state.clone();
    newer[1] = b'9';
    assert!(matches!(
        Trainer::resume(short(), 1, &newer),
        Err(StateError::Version { .. })
    ));
}
