//! The colours of heat maps, as on the page.

use crate::plot::colour::property;
use plotters::style::RGBColor;

/// Number of colour stops of the page's heat map.
const HEAT_STOPS: usize = 9;

/// The heat map colour of a share (0 to 1).
pub(super) fn of_share(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * (HEAT_STOPS - 1) as f64;
    let below = (place as usize).min(HEAT_STOPS - 2);
    let [RGBColor(r, g, b), RGBColor(r2, g2, b2)] = [below, below + 1].map(|stop| property(&format!("heat-{stop}")));
    let mix = |a: u8, b: u8| (f64::from(a) + (place - below as f64) * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mix(r, r2), mix(g, g2), mix(b, b2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_stops_of_the_heat_map_are_found_in_the_style_sheet() {
        for (share, want) in [(0.0, (68, 1, 84)), (0.5, (33, 144, 141)), (1.0, (253, 231, 37)), (0.0625, (70, 23, 103))]
        {
            let RGBColor(r, g, b) = of_share(share);
            assert_eq!((r, g, b), want, "{share}");
        }
    }
}
