//! The colours of teams, read from the page's style sheet so that both share one table.

use plotters::style::RGBColor;

/// Declares the colours as custom properties. The first declaration of a name, for light
/// backgrounds, counts.
const STYLE_SHEET: &str = include_str!("../../crates/shore/web/style.css");
/// Number of team colours of the page.
const TEAMS: usize = 4;

/// The colour of a team: the custom property `--team-N: #rrggbb;`.
pub(crate) fn of_team(team: usize) -> RGBColor {
    let name = format!("--team-{}: #", team % TEAMS);
    let (_, rest) = STYLE_SHEET
        .split_once(&name)
        .expect("the style sheet has this colour");
    let channel = |i: usize| {
        u8::from_str_radix(&rest[2 * i..2 * i + 2], 16).expect("a colour has six hex digits")
    };
    RGBColor(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_colours_of_teams_are_found_in_the_style_sheet() {
        assert_eq!(
            of_team(0),
            RGBColor(0, 114, 178),
            "the first, for light ground"
        );
        assert_eq!(
            (0..=TEAMS).map(of_team).collect::<Vec<_>>()[TEAMS],
            of_team(0),
            "then they repeat"
        );
    }
}
