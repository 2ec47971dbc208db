//! Training learns within seconds and is reproducible on any machine.

use learn::environment::{Moment, Watch};
use learn::train::{Progress, StateError, Trainer};
use learn::training::{CriticInput, Evaluation, Layers, League, Ppo, Stage, Teacher, Training};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(path)
}

fn first() -> Training {
    scenario::load_file::<learn::training::Training>(&file("training/first.toml"))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn a_policy_learns_to_beat_an_idle_team_and_to_score_against_pav01() {
    let opponents = ["strategies/pav01.toml", "strategies/idle.toml"].map(file).into();
    let training = Training { evaluation: Evaluation { every_samples: 100_000, games: 20, opponents }, ..first() };
    let mut trainer = Trainer::new(training, 2).unwrap_or_else(|error| panic!("{error}"));
    let mut seen = vec![];
    while trainer.samples().0 < 310_000 {
        let progress = trainer.update().unwrap_or_else(|error| panic!("{error}"));
        seen.extend(progress.evaluated);
    }
    let points: Vec<f64> = seen.iter().map(|evaluated| evaluated.played[0].1.points[0]).collect();
    let [first, .., last] = points[..] else { panic!("{points:?}") };
    assert!(last > 3.0 && last > first, "points per game against pav01: {points:?}");
    let idle = seen.last().map_or(0.0, |evaluated| evaluated.played[1].1.won());
    assert!(idle >= 0.9, "won a share of {idle} of the games against an idle team");
}

/// Two short stages that use a helm, a strategy and past policies.
fn short() -> Training {
    let stage = |name: &str, game: &str, helm: Option<&str>| Stage {
        name: name.to_owned(),
        game: file(game),
        sea: None,
        rewards: file("rewards/bold.toml"),
        helm: helm.map(file),
        teacher: None,
        mates: None,
        self_play: 1.0,
        past_selves: 1.0,
        strategies: 1.0,
        opponent: vec![learn::training::Opponent { strategy: file("strategies/pav01.toml") }],
        starts: Some(8),
        episode_max_s: Some(20.0),
        samples: 4_000,
        until_won: None,
    };
    let network = Layers { hidden: vec![16], critic: CriticInput::Truth };
    let ppo = Ppo { steps: 32, minibatch: 256, ..Ppo::default() };
    let league = League { every_samples: 1_000, most: 2, priority: 1.0 };
    let opponents = vec![file("strategies/pav01.toml")];
    let evaluation = Evaluation { every_samples: 3_000, games: 2, opponents };
    let stage = vec![
        stage("direct", "games/pav01_afloat.toml", None),
        Stage {
            teacher: Some(Teacher { strategy: file("strategies/strategy_2.toml"), options: BTreeMap::new() }),
            ..stage("taught", "games/pav01_afloat.toml", None)
        },
        stage("helm", "games/surveyor_2v2.toml", Some("strategies/policy.toml")),
    ];
    Training { games: 8, network, ppo, league, evaluation, stage, ..first() }
}

fn trained(mut trainer: Trainer, progress: &mut Vec<Progress>) -> Trainer {
    while !trainer.is_over() {
        progress.push(trainer.update().unwrap_or_else(|error| panic!("{error}")));
    }
    trainer
}

#[test]
fn the_same_file_trains_the_same_weights_on_any_number_of_threads_and_resumed() {
    let run = |threads| {
        let mut progress = vec![];
        let trainer = Trainer::new(short(), threads).unwrap_or_else(|error| panic!("{error}"));
        let trainer = trained(trainer, &mut progress);
        (trainer.state(), progress)
    };
    let (state, progress) = run(1);
    let opponents: Vec<&str> = progress.iter().flat_map(|one| &one.finished).map(|(_, name)| name.as_str()).collect();
    assert!(opponents.contains(&"itself") && opponents.contains(&"pav01"), "{opponents:?}");
    assert!(opponents.iter().any(|name| name.starts_with("after ")), "{opponents:?}");
    assert!(run(3) == (state.clone(), progress.clone()));

    // Resumed wherever possible.
    let mut trainer = Trainer::new(short(), 2).unwrap_or_else(|error| panic!("{error}"));
    let mut taken_up = 0;
    while !trainer.is_over() {
        let done = trainer.update().unwrap_or_else(|error| panic!("{error}"));
        if done.can_be_resumed {
            trainer = Trainer::resume(short(), 2, &trainer.state()).unwrap_or_else(|error| panic!("{error}"));
            taken_up += 1;
        }
    }
    assert!(taken_up > 2, "{taken_up}");
    assert!(trainer.state() == state);
}

#[test]
fn episodes_that_are_seen_have_the_numbers_that_are_told_and_change_nothing() {
    let plain = trained(Trainer::new(short(), 2).unwrap_or_else(|error| panic!("{error}")), &mut vec![]);
    let ended: Arc<Mutex<BTreeSet<(u64, u64)>>> = Arc::default();
    let kept = Arc::clone(&ended);
    let watches = move |number: u64| {
        number.is_multiple_of(3).then(|| -> Watch {
            let kept = Arc::clone(&kept);
            Box::new(move |contest, moment| {
                if moment == Moment::End {
                    kept.lock().expect("no thread has panicked").insert((contest.scenario().seed, number));
                }
            })
        })
    };
    let mut trainer = Trainer::new(short(), 2).unwrap_or_else(|error| panic!("{error}"));
    trainer.watch(Arc::new(watches)).unwrap_or_else(|error| panic!("{error}"));
    let mut progress = vec![];
    let trainer = trained(trainer, &mut progress);
    assert!(trainer.state() == plain.state(), "watching changed the training");
    let told = progress.iter().flat_map(|one| &one.finished).map(|(one, _)| (one.standing.seed, one.number));
    let told: BTreeSet<(u64, u64)> = told.filter(|(_, number)| number.is_multiple_of(3)).collect();
    assert!(told.len() > 10, "{told:?}");
    assert_eq!(told, *ended.lock().expect("no thread has panicked"));
}

/// Imitates strategy 2 with the options of another strategy.
fn imitation(options: &[(&str, &str)]) -> Training {
    let options = options.iter().map(|(mode, option)| ((*mode).to_owned(), (*option).to_owned())).collect();
    let teacher = Some(Teacher { strategy: file("strategies/strategy_5.toml"), options });
    let options = scenario::load_file::<learn::training::Training>(&file("training/options.toml"))
        .unwrap_or_else(|problems| panic!("{problems}"));
    let helm = Some(file("strategies/options.toml"));
    let stage = Stage { teacher, helm, samples: 40_000, ..short().stage.remove(0) };
    Training {
        stage: vec![stage],
        action: options.action,
        period_s: 1.0,
        ppo: Ppo { learning_rate: 3e-3, ..short().ppo },
        ..short()
    }
}

const OPTIONS: [(&str, &str); 5] =
    [("raiding", "attack"), ("intercepting", "pursue"), ("keeping", "hold"), ("waiting", "wait"), ("chasing", "chase")];

#[test]
fn a_policy_learns_to_choose_what_its_teacher_is_at() {
    let mut trainer = Trainer::new(imitation(&OPTIONS), 2).unwrap_or_else(|error| panic!("{error}"));
    let mut losses = vec![];
    while !trainer.is_over() {
        let progress = trainer.update().unwrap_or_else(|error| panic!("{error}"));
        losses.extend(progress.learnt.policy_loss);
        assert_eq!(progress.learnt.clipped, Some(0.0));
    }
    // Ten options, initially.
    let (first, last) = (losses[0], losses[losses.len() - 1]);
    assert!(first > 1.5 && last < 0.7, "cross-entropy, nats: {losses:?}");
}

#[test]
fn a_teacher_whose_modes_are_no_options_is_refused() {
    let refused = |options: &[(&str, &str)]| match Trainer::new(imitation(options), 1) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{options:?}"),
    };
    let message = refused(&[("raiding", "fly")]);
    assert!(message.contains("\"fly\", expected attack, rush"), "{message}");
    let message = refused(&[("flying", "attack")]);
    assert!(message.contains("flying, expected a mode of strategy_5: ") && message.contains("raiding"), "{message}");
    let message = refused(&[]);
    assert!(message.contains("strategy_5, whose modes match no option"), "{message}");
}

#[test]
fn a_state_of_another_training_is_refused() {
    let state = Trainer::new(short(), 1).unwrap_or_else(|error| panic!("{error}")).state();
    let other = Training { seed: 2, ..short() };
    assert!(matches!(Trainer::resume(other, 1, &state), Err(StateError::Other)));
    assert!(matches!(Trainer::resume(short(), 1, &state[..100]), Err(StateError::Damaged)));
    let mut newer = state.clone();
    newer[1] = b'9';
    assert!(matches!(Trainer::resume(short(), 1, &newer), Err(StateError::Version { .. })));
}
