//! The colours of teams: those of the page, read from its style sheet, so that both have one table.

use plotters::style::RGBColor;

/// Declares them as custom properties; of two of a name the first, which is for light ground, counts.
const STYLE_SHEET: &str = include_str!("../../crates/shore/web/style.css");
/// How many colours the page has for teams.
const TEAMS: usize = 4;

/// The colour of a team, the custom property `--team-N: #rrggbb;`.
pub(crate) fn of_team(team: usize) -> RGBColor {
    let name = format!("--team-{}: #", team % TEAMS);
    let (_, rest) = STYLE_SHEET.split_once(&name).expect("the style sheet has this colour");
    let channel = |i: usize| u8::from_str_radix(&rest[2 * i..2 * i + 2], 16).expect("a colour has six hex digits");
    RGBColor(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_colours_of_teams_are_found_in_the_style_sheet() {
        assert_eq!(of_team(0), RGBColor(0, 114, 178), "the first, for light ground");
        assert_eq!((0..=TEAMS).map(of_team).collect::<Vec<_>>()[TEAMS], of_team(0), "then they begin anew");
    }
}
