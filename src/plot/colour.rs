//! The colours of teams and of heat maps: those of the page, read from its style sheet, so that both have one table.

use plotters::style::RGBColor;

/// Declares them as custom properties; of two of a name the first, which is for light ground, counts.
const STYLE_SHEET: &str = include_str!("../../crates/shore/web/style.css");
/// How many colours the page has for teams, and how many stops its heat map has.
const TEAMS: usize = 4;
const HEAT_STOPS: usize = 9;

/// The colour of a team.
pub(crate) fn of_team(team: usize) -> RGBColor {
    property(&format!("team-{}", team % TEAMS))
}

/// The colour of a share (0 to 1) on the heat map.
pub(crate) fn of_share(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * (HEAT_STOPS - 1) as f64;
    let below = (place as usize).min(HEAT_STOPS - 2);
    let [RGBColor(r, g, b), RGBColor(r2, g2, b2)] = [below, below + 1].map(|stop| property(&format!("heat-{stop}")));
    let mix = |a: u8, b: u8| (f64::from(a) + (place - below as f64) * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mix(r, r2), mix(g, g2), mix(b, b2))
}

/// A custom property `--name: #rrggbb;`.
fn property(name: &str) -> RGBColor {
    let (_, rest) = STYLE_SHEET.split_once(&format!("--{name}: #")).expect("the style sheet has this colour");
    let channel = |i: usize| u8::from_str_radix(&rest[2 * i..2 * i + 2], 16).expect("a colour has six hex digits");
    RGBColor(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_colours_of_the_style_sheet_are_found() {
        assert_eq!(of_team(0), RGBColor(0, 114, 178), "the first, for light ground");
        assert_eq!((0..=TEAMS).map(of_team).collect::<Vec<_>>()[TEAMS], of_team(0), "then they begin anew");
        for (share, want) in [(0.0, (68, 1, 84)), (0.5, (33, 144, 141)), (1.0, (253, 231, 37)), (0.0625, (70, 23, 103))]
        {
            let RGBColor(r, g, b) = of_share(share);
            assert_eq!((r, g, b), want, "{share}");
        }
    }
}
