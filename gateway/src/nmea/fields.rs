//! Checks the fields of sentences against the list in `fields.txt`.

use super::date_time::TimeOfDay;
use super::number::number;
use super::position::{LATITUDE, LONGITUDE};

#[test]
fn fields_mean_what_the_list_says() {
    let mut count = 0;
    for line in include_str!("fields.txt")
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
    {
        let cells: Vec<&str> = line.split('|').collect();
        let text = cells[1];
        let value = cells[2].trim().parse::<f64>().ok();
        let got = match cells[0].trim() {
            "time" => TimeOfDay::parse(text).map(|time| f64::from(time.0)),
            "latitude" => LATITUDE.degrees(text),
            "number" => number(text),
            coordinate => {
                let axis = if coordinate == "lat text" {
                    LATITUDE
                } else {
                    LONGITUDE
                };
                let printed = axis.printed(value.expect("an angle"), 5);
                assert_eq!(printed.unwrap_or_default(), text, "{line}");
                value
            }
        };
        let is_near =
            matches!((got, value), (Some(got), Some(value)) if (got - value).abs() < 1e-12);
        assert!(
            is_near || got.is_none() && value.is_none() || value.is_some_and(|it| !it.is_finite()),
            "{line}: {got:?}"
        );
        count += 1;
    }
    assert!(count > 60, "only {count} fields are listed");
    assert_eq!(
        LONGITUDE.printed(-80.372_288_3, 4).as_deref(),
        Some("08022.3373,W")
    );
    assert_eq!(number(&"9".repeat(400)), None, "a number too large for f64");
}
