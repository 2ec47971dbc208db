//! The background of the chart beneath the field: an image of the site, or its shoreline as
//! GeoJSON.
//!
//! Both use WGS 84: GeoJSON by RFC 7946, and an image through its world file. The page places them
//! relative to the field's datum.

use primitives::input_file;
use serde_json::{Value, json};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Maximum size of a file, bytes.
const BYTES_MAX: u64 = 16 << 20;
/// Maximum size of a world file, bytes; it contains six numbers.
const WORLD_BYTES_MAX: u64 = 4096;
/// Maximum length of an image's sides, pixels; browsers do not draw larger images.
const SIDE_MAX: usize = 8192;
/// Maximum number of positions in a shoreline.
const POSITIONS_MAX: usize = 200_000;
/// Maximum extent of a background, degrees.
const EXTENT_MAX_DEG: f64 = 5.0;
/// Maximum length of a place name, characters.
const NAME_MAX: usize = 60;
/// Extensions of world files, which replace the image's own.
const WORLD_FILES: [&str; 6] = ["pgw", "pngw", "jgw", "jpgw", "jpegw", "wld"];

/// The background of the field.
#[derive(Debug)]
pub struct Background {
    /// The message to pages; see `PROTOCOL.md`.
    pub(super) json: String,
    /// An image's media type and bytes.
    pub(super) image: Option<(&'static str, Vec<u8>)>,
}

/// Why a background is rejected: the file and its problem, with the allowed values.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct BackgroundError(String);

impl BackgroundError {
    fn of(path: &Path, problem: impl Display) -> BackgroundError {
        BackgroundError(format!("{}: {problem}", path.display()))
    }
}

impl Background {
    /// Reads an image (PNG or JPEG) with its world file, or GeoJSON.
    ///
    /// # Errors
    /// [`BackgroundError`] if the file cannot be read, is too large, or has an unknown format or
    /// invalid coordinates.
    pub fn read(path: &Path) -> Result<Background, BackgroundError> {
        let bytes = read(path, BYTES_MAX)?;
        let bad = |problem| BackgroundError::of(path, problem);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let kind = match imagesize::image_type(&bytes) {
            Ok(imagesize::ImageType::Png) => "image/png",
            Ok(imagesize::ImageType::Jpeg) => "image/jpeg",
            _ if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{') => {
                let shoreline = Shoreline::parse(&bytes).map_err(bad)?;
                let areas = shoreline.areas;
                let lines = shoreline.lines;
                let points = shoreline.points;
                let json = json!({"name": name, "areas": areas, "lines": lines, "points": points})
                    .to_string();
                return Ok(Background { json, image: None });
            }
            _ => {
                return Err(bad(
                    "unknown format, expected PNG or JPEG with a world file, or GeoJSON".to_owned(),
                ));
            }
        };
        let size = imagesize::blob_size(&bytes).map_err(|e| bad(format!("is damaged: {e}")))?;
        let width = size.width;
        let height = size.height;
        if !(1..=SIDE_MAX).contains(&width) || !(1..=SIDE_MAX).contains(&height) {
            return Err(bad(format!(
                "has {width} x {height} pixels, expected 1 to {SIDE_MAX} on each side"
            )));
        }
        let (world_path, world) = world_file(path)?;
        let world = world_matrix(&world, [width as f64, height as f64])
            .map_err(|problem| BackgroundError::of(&world_path, problem))?;
        let json =
            json!({"name": name, "image": {"width": width, "height": height, "world": world}})
                .to_string();
        Ok(Background {
            json,
            image: Some((kind, bytes)),
        })
    }
}

fn read(path: &Path, bytes_max: u64) -> Result<Vec<u8>, BackgroundError> {
    input_file::read(path, bytes_max)
        .map_err(|e| BackgroundError(format!("cannot read {}: {e}", path.display())))
}

fn world_file(image: &Path) -> Result<(PathBuf, String), BackgroundError> {
    let found = WORLD_FILES
        .iter()
        .map(|end| image.with_extension(end))
        .find(|path| path.exists());
    let Some(path) = found else {
        let names: Vec<String> = WORLD_FILES
            .iter()
            .map(|end| image.with_extension(end).display().to_string())
            .collect();
        let problem = format!(
            "has no world file beside it, expected one of {} (GIS programs write it \
             when they export an image in WGS 84)",
            names.join(", ")
        );
        return Err(BackgroundError::of(image, problem));
    };
    let text = String::from_utf8_lossy(&read(&path, WORLD_BYTES_MAX)?).into_owned();
    Ok((path, text))
}

/// The six numbers of a world file in the order a, d, b, e, c, f: longitude = a column + b row + c,
/// latitude = d column + e row + f. c and f refer to the centre of the first pixel.
fn world_matrix(text: &str, [width, height]: [f64; 2]) -> Result<[f64; 6], String> {
    let mut numbers = [0.0; 6];
    let mut words = text.split_ascii_whitespace();
    for (at, number) in numbers.iter_mut().enumerate() {
        let word = words
            .next()
            .ok_or_else(|| format!("has {at} numbers, expected 6, one per line"))?;
        // Some programs write decimal commas.
        let parsed = word
            .replace(',', ".")
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite());
        *number = parsed.ok_or_else(|| format!("line {}: {word:?} is not a number", at + 1))?;
    }
    if words.next().is_some() {
        return Err("has more than 6 numbers, expected 6, one per line".to_owned());
    }
    let [a, d, b, e, c, f] = numbers;
    if a * e - b * d == 0.0 {
        return Err("lines 1 to 4 describe pixels of zero size".to_owned());
    }
    let mut extent = Extent::default();
    for [column, row] in [
        [-0.5, -0.5],
        [width - 0.5, -0.5],
        [width - 0.5, height - 0.5],
        [-0.5, height - 0.5],
    ] {
        let corner = [a * column + b * row + c, d * column + e * row + f];
        extent
            .add(corner)
            .map_err(|problem| format!("a corner of the image {problem}"))?;
    }
    extent.check()?;
    Ok(numbers)
}

/// The extent of positions: minimum and maximum longitude and latitude.
#[derive(Default)]
struct Extent(Option<[[f64; 2]; 2]>);

impl Extent {
    fn add(&mut self, [lon, lat]: [f64; 2]) -> Result<(), String> {
        if !(-180.0..=180.0).contains(&lon) || !(-90.0..=90.0).contains(&lat) {
            return Err(format!(
                "is at [{lon}, {lat}], expected [longitude -180 to 180, latitude -90 to 90] in degrees of WGS 84 (EPSG:4326)"
            ));
        }
        let [low, high] = self.0.get_or_insert([[lon, lat]; 2]);
        (*low, *high) = (
            [low[0].min(lon), low[1].min(lat)],
            [high[0].max(lon), high[1].max(lat)],
        );
        Ok(())
    }

    fn check(&self) -> Result<(), String> {
        let Some([low, high]) = self.0 else {
            return Ok(());
        };
        let wide = high[0] - low[0];
        let tall = high[1] - low[1];
        if wide.max(tall) <= EXTENT_MAX_DEG {
            return Ok(());
        }
        Err(format!(
            "extends from [{}, {}] to [{}, {}], expected at most {EXTENT_MAX_DEG} degrees each way: crop it to the site",
            low[0], low[1], high[0], high[1]
        ))
    }
}

/// The shapes in a GeoJSON file. Positions are longitude and latitude, degrees.
#[derive(Default)]
struct Shoreline {
    /// Polygons as rings; all but the first ring are holes.
    areas: Vec<Vec<Vec<[f64; 2]>>>,
    lines: Vec<Vec<[f64; 2]>>,
    points: Vec<(f64, f64, String)>,
    extent: Extent,
    positions: usize,
}

impl Shoreline {
    fn parse(bytes: &[u8]) -> Result<Shoreline, String> {
        let value: Value =
            serde_json::from_slice(bytes).map_err(|e| format!("is not JSON: {e}"))?;
        let mut shoreline = Shoreline::default();
        shoreline.check_reference_system(&value)?;
        shoreline.object(&value, "")?;
        if shoreline.positions == 0 {
            return Err("has no positions, expected at least one".to_owned());
        }
        shoreline.extent.check()?;
        Ok(shoreline)
    }

    /// Files from before RFC 7946 may use a different reference system.
    fn check_reference_system(&self, value: &Value) -> Result<(), String> {
        let Some(name) = value["crs"]["properties"]["name"].as_str() else {
            return Ok(());
        };
        if name.ends_with("CRS84") || name.ends_with(":4326") {
            return Ok(());
        }
        Err(format!(
            "crs is {name:?}, expected WGS 84 (EPSG:4326): export it in WGS 84"
        ))
    }

    fn object(&mut self, value: &Value, at: &str) -> Result<(), String> {
        check_object(value, at)?;
        match value["type"].as_str() {
            Some("FeatureCollection") => {
                each(&value["features"], &within(at, "features"), |it, at| {
                    self.object(it, at)
                })
            }
            Some("Feature") if value["geometry"].is_null() => Ok(()),
            Some("Feature") => {
                let name = value["properties"]["name"].as_str().unwrap_or_default();
                self.geometry(&value["geometry"], &within(at, "geometry"), name)
            }
            _ => self.geometry(value, at, ""),
        }
    }

    fn geometry(&mut self, value: &Value, at: &str, name: &str) -> Result<(), String> {
        check_object(value, at)?;
        let kind = &value["type"];
        let coordinates = &value["coordinates"];
        let place = within(at, "coordinates");
        match kind.as_str().unwrap_or_default() {
            "Point" => self.point(coordinates, &place, name),
            "MultiPoint" => each(coordinates, &place, |it, at| self.point(it, at, name)),
            "LineString" => self.line(coordinates, &place),
            "MultiLineString" => each(coordinates, &place, |it, at| self.line(it, at)),
            "Polygon" => self.area(coordinates, &place),
            "MultiPolygon" => each(coordinates, &place, |it, at| self.area(it, at)),
            "GeometryCollection" => {
                each(&value["geometries"], &within(at, "geometries"), |it, at| {
                    self.geometry(it, at, "")
                })
            }
            _ => Err(format!(
                "{} is {kind}, expected a GeoJSON type such as \"FeatureCollection\" or \"Polygon\"",
                within(at, "type")
            )),
        }
    }

    fn point(&mut self, value: &Value, at: &str, name: &str) -> Result<(), String> {
        let [lon, lat] = self.position(value, at)?;
        self.points
            .push((lon, lat, name.chars().take(NAME_MAX).collect()));
        Ok(())
    }

    fn line(&mut self, value: &Value, at: &str) -> Result<(), String> {
        let line = self.positions(value, at)?;
        self.lines.push(line);
        Ok(())
    }

    fn area(&mut self, value: &Value, at: &str) -> Result<(), String> {
        let rings = each(value, at, |ring, at| self.positions(ring, at))?;
        self.areas.push(rings);
        Ok(())
    }

    fn positions(&mut self, value: &Value, at: &str) -> Result<Vec<[f64; 2]>, String> {
        each(value, at, |it, at| self.position(it, at))
    }

    fn position(&mut self, value: &Value, at: &str) -> Result<[f64; 2], String> {
        self.positions += 1;
        if self.positions > POSITIONS_MAX {
            return Err(format!(
                "has more than {POSITIONS_MAX} positions: simplify it, or crop it to the site"
            ));
        }
        let numbers = list(value, at)?
            .iter()
            .map(Value::as_f64)
            .collect::<Option<Vec<f64>>>();
        // A third number is the height.
        let [lon, lat, ..] = numbers.unwrap_or_default()[..] else {
            return Err(format!(
                "{at} is not a position, expected [longitude, latitude]"
            ));
        };
        self.extent
            .add([lon, lat])
            .map_err(|problem| format!("{at} {problem}"))?;
        Ok([lon, lat])
    }
}

fn list<'a>(value: &'a Value, at: &str) -> Result<&'a Vec<Value>, String> {
    value
        .as_array()
        .ok_or_else(|| format!("{at} is not a list"))
}

/// Calls `take` with every item of a list, and its place.
fn each<C: FromIterator<T>, T>(
    value: &Value,
    at: &str,
    mut take: impl FnMut(&Value, &str) -> Result<T, String>,
) -> Result<C, String> {
    list(value, at)?
        .iter()
        .enumerate()
        .map(|(i, item)| take(item, &format!("{at}[{i}]")))
        .collect()
}

fn check_object(value: &Value, at: &str) -> Result<(), String> {
    let named = if at.is_empty() { "the file" } else { at };
    if value.is_object() {
        Ok(())
    } else {
        Err(format!("{named} is not an object"))
    }
}

fn within(at: &str, key: &str) -> String {
    if at.is_empty() {
        key.to_owned()
    } else {
        format!("{at}.{key}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fs;

    /// An image of one pixel.
    const PNG: &[u8] = include_bytes!("background_pixel.png");

    fn read_in(files: &[(&str, &[u8])]) -> Result<Background, String> {
        let dir = tempfile::tempdir().expect("a directory");
        for (name, bytes) in files {
            fs::write(dir.path().join(name), bytes).expect("the file can be written");
        }
        let read = Background::read(&dir.path().join(files[0].0));
        read.map_err(|e| e.to_string().replace(&dir.path().display().to_string(), ""))
    }

    #[test]
    fn an_image_is_placed_by_its_world_file() {
        let world = b"0.001\n0\n0\n-0.001\n-73.9\n41.3\n";
        let background =
            read_in(&[("site.png", PNG), ("site.pgw", world)]).expect("the background is valid");
        let json: Value = serde_json::from_str(&background.json).expect("the message is JSON");
        let image =
            json!({"width": 1, "height": 1, "world": [0.001, 0.0, 0.0, -0.001, -73.9, 41.3]});
        assert_eq!(json, json!({"name": "site.png", "image": image}));
        assert_eq!(background.image, Some(("image/png", PNG.to_vec())));
        for (files, want) in [
            (vec![("site.png", PNG)], "has no world file beside it"),
            (
                vec![("site.png", PNG), ("site.wld", b"1 2 3".as_slice())],
                "/site.wld: has 3 numbers, expected 6",
            ),
            (
                vec![("site.png", PNG), ("site.wld", b"1 0 0 x 5 6")],
                "line 4: \"x\" is not a number",
            ),
            (
                vec![("site.png", PNG), ("site.wld", b"0 0 0 0 5 6")],
                "describe pixels of zero size",
            ),
            (
                vec![("site.png", PNG), ("site.wld", b"1 0 0 -1 712345 4512345")],
                "a corner of the image is at [712344.5, ",
            ),
            (
                vec![("site.png", PNG), ("site.wld", b"9 0 0 -1 5 6")],
                "expected at most 5 degrees each way",
            ),
            (
                vec![("site.png", PNG), ("site.wld", b"1 0 0 -1 5 6 7")],
                "more than 6 numbers",
            ),
            (vec![("site.png", &PNG[..20])], "is damaged"),
        ] {
            let error = read_in(&files).expect_err(want);
            assert!(error.contains(want), "{error}");
        }
        let mut huge = PNG.to_vec();
        huge[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
        assert!(
            read_in(&[("site.png", &huge)])
                .expect_err("huge")
                .contains("100000 x 1 pixels, expected 1 to 8192")
        );
        let svg = read_in(&[("site.svg", b"<svg onload='alert(1)'/>")]).expect_err("no SVG");
        assert!(
            svg.contains("unknown format, expected PNG or JPEG with a world file, or GeoJSON"),
            "{svg}"
        );
    }

    fn geojson(value: &Value) -> Result<Value, String> {
        let read = read_in(&[("site.geojson", value.to_string().as_bytes())]);
        read.map(|background| serde_json::from_str(&background.json).expect("the message is JSON"))
    }

    #[test]
    fn a_shoreline_has_areas_lines_and_points() {
        let ring = json!([[-73.9, 41.3], [-73.8, 41.3], [-73.8, 41.4], [-73.9, 41.3]]);
        let features = json!([
            {"type": "Feature", "properties": null, "geometry": {"type": "Polygon", "coordinates": [ring, ring]}},
            {"type": "Feature", "geometry": null},
            {"type": "Feature", "properties": {"name": "Dock"}, "geometry": {"type": "Point", "coordinates": [-73.9, 41.3, 2]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection", "geometries": [
                {"type": "MultiLineString", "coordinates": [[[-73.9, 41.3], [-73.8, 41.3]]]},
            ]}},
        ]);
        let shown = geojson(&json!({"type": "FeatureCollection", "features": features}))
            .expect("the shoreline is valid");
        let want = json!({"name": "site.geojson", "areas": [[ring, ring]], "points": [[-73.9, 41.3, "Dock"]],
            "lines": [[[-73.9, 41.3], [-73.8, 41.3]]]});
        assert_eq!(shown, want);
    }

    #[test]
    fn what_is_badly_placed_is_refused_with_the_place() {
        let line = |places: Value| {
            let geometry = json!({"type": "LineString", "coordinates": places});
            json!({"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": geometry}]})
        };
        let place = "features[0].geometry.coordinates[1]";
        for (file, want) in [
            (
                line(json!([[0, 1], [712_345.5, 4_512_345]])),
                format!("{place} is at [712345.5, 4512345], expected [longitude"),
            ),
            (
                line(json!([[0, 1], ["0", 1]])),
                format!("{place} is not a position, expected [longitude, latitude]"),
            ),
            (line(json!([[0, 1], 3])), format!("{place} is not a list")),
            (
                line(json!([[0, 1], [10, 1]])),
                "extends from [0, 1] to [10, 1], expected at most 5 degrees".to_owned(),
            ),
            (line(json!([])), "has no positions".to_owned()),
            (
                json!({"type": "Topology"}),
                "type is \"Topology\", expected a GeoJSON type".to_owned(),
            ),
            (
                json!({"type": "FeatureCollection"}),
                "features is not a list".to_owned(),
            ),
            (
                json!({"type": "Point", "coordinates": [1, 2], "crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}}),
                "crs is \"urn:ogc:def:crs:EPSG::3857\", expected WGS 84".to_owned(),
            ),
            (
                line(json!(vec![[1.0, 2.0]; POSITIONS_MAX + 1])),
                "more than 200000 positions".to_owned(),
            ),
        ] {
            let error = geojson(&file).expect_err(&want);
            assert!(error.contains(&want), "{error}");
        }
        let deep = format!(
            "{{\"type\":\"Polygon\",\"coordinates\":{}",
            "[".repeat(100_000)
        );
        assert!(
            read_in(&[("site.geojson", deep.as_bytes())])
                .expect_err("deep")
                .contains("is not JSON")
        );
    }

    proptest! {
        #[test]
        fn no_file_makes_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), text in "[0-9. eE\n-]{0,60}") {
            drop(Shoreline::parse(&bytes));
            drop(world_matrix(&text, [10.0, 10.0]));
        }
    }
}
