//! The quality of play as text tables, 80 columns wide.

use super::encounter::{Encounters, Nearness};
use super::{ModeQuality, Quality, StrategyQuality};
use std::fmt::{self, Display, Formatter};

/// Columns for the names of strategies, roles and modes.
const NAME: usize = 24;

impl Display for Quality {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let s = if self.games == 1 { "" } else { "s" };
        writeln!(
            f,
            "quality of play in {} game{s}, {:.1} h",
            self.games,
            self.time_s / 3600.0
        )?;
        self.write_modes(f)?;
        self.write_encounters(f)?;
        self.write_strategies(f)
    }
}

impl Quality {
    fn write_modes(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\n{:NAME$}    time   course    speed  entered    stands  at the",
            ""
        )?;
        writeln!(
            f,
            "{:NAME$}            jumps    jumps              still    edge",
            ""
        )?;
        writeln!(
            f,
            "{:NAME$}       h  per min  per min  per min         %       %",
            ""
        )?;
        for (strategy, quality) in &self.strategies {
            writeln!(f, "{strategy}")?;
            for (role, of_role) in &quality.roles {
                if *role != *strategy {
                    writeln!(f, "  {role}")?;
                }
                for (mode, quality) in &of_role.modes {
                    writeln!(f, "{}{}", name(&format!("    {mode}")), row(quality))?;
                }
            }
        }
        Ok(())
    }

    fn write_encounters(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\nper game: hull contacts / near misses (within the rules' collision distance)"
        )?;
        writeln!(
            f,
            "{:NAME$}     teammate        enemy   tagger, tagged          all",
            ""
        )?;
        for (strategy, quality) in &self.strategies {
            writeln!(
                f,
                "{}{}",
                name(strategy),
                encounters(&quality.encounters, quality.teams)
            )?;
        }
        writeln!(
            f,
            "{}{}",
            name("all, each once"),
            encounters(&self.encounters, self.games)
        )
    }

    fn write_strategies(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\n{:NAME$}         orbits    in an orbit           no attack",
            ""
        )?;
        writeln!(
            f,
            "{:NAME$}       per game     s per game       % of the game",
            ""
        )?;
        for (strategy, quality) in &self.strategies {
            writeln!(f, "{}{}", name(strategy), team_row(quality))?;
        }
        Ok(())
    }
}

/// A name padded to the column width; a longer name shifts the other columns.
fn name(name: &str) -> String {
    format!("{name:<width$} ", width = NAME - 1)
}

fn row(quality: &ModeQuality) -> String {
    let ModeQuality {
        time_s,
        begun,
        course_jumps,
        speed_jumps,
        standing_s,
        edge_s,
    } = *quality;
    let a_minute = |count: u64| rate(count as f64 * 60.0, time_s);
    let share = |part_s: f64| rate(100.0 * part_s, time_s);
    format!(
        "{:>8.2}{:>9.1}{:>9.1}{:>9.1}{:>10.1}{:>8.1}",
        time_s / 3600.0,
        a_minute(course_jumps),
        a_minute(speed_jumps),
        a_minute(begun),
        share(standing_s),
        share(edge_s)
    )
}

fn encounters(encounters: &Encounters, games: u64) -> String {
    let cell = |Nearness {
                    contacts,
                    near_misses,
                }: Nearness| {
        let a_game = |count: u64| rate(count as f64, games as f64);
        format!("{:.2} / {:.2}", a_game(contacts), a_game(near_misses))
    };
    let Encounters {
        mate,
        enemy,
        tagger_and_tagged,
    } = *encounters;
    let [mate, enemy, tag, all] = [mate, enemy, tagger_and_tagged, encounters.all()].map(cell);
    format!("{mate:>13}{enemy:>13}{tag:>17}{all:>13}")
}

fn team_row(quality: &StrategyQuality) -> String {
    let games = quality.teams as f64;
    let orbits: u64 = quality.roles.values().map(|role| role.orbits).sum();
    let orbit_s: f64 = quality.roles.values().map(|role| role.orbit_s).sum();
    format!(
        "{:>15.2}{:>15.1}{:>20.1}",
        rate(orbits as f64, games),
        rate(orbit_s, games),
        rate(100.0 * quality.nobody_attacks_s, quality.time_s)
    )
}

/// `number` per unit of `of`; 0 if `of` is 0.
fn rate(number: f64, of: f64) -> f64 {
    if of > 0.0 { number / of } else { 0.0 }
}
