//! Named manipulations of the bytes from a boat.

use gateway::nmea::with_checksum;

/// Turns a burst of telemetry into packets.
pub(crate) type Tamper = Box<dyn FnMut(Vec<u8>) -> Vec<Vec<u8>>>;

/// The manipulation with this name and its parameters; `none` changes nothing.
pub(crate) fn tamper(words: &[&str]) -> Option<Tamper> {
    Some(match words {
        ["none"] => return None,
        ["all-lost"] => Box::new(|_| vec![]),
        ["second-half-lost"] => Box::new(|bytes| vec![bytes[..bytes.len() / 2].to_vec()]),
        ["single-bytes"] => Box::new(|bytes| bytes.into_iter().map(|byte| vec![byte]).collect()),
        ["xor", mask] => {
            let mask: u8 = mask.parse().expect("a byte");
            Box::new(move |bytes| vec![bytes.iter().map(|byte| byte ^ mask).collect()])
        }
        ["noise"] => noise(),
        ["first-fix-again"] => first_fix_again(),
        ["replace", pairs @ ..] => rewritten(replacing(pairs)),
        ["replace-not-checksum", pairs @ ..] => {
            let replaced = replacing(pairs);
            Box::new(move |bytes| vec![replaced(&String::from_utf8_lossy(&bytes)).into_bytes()])
        }
        ["position", lat, north, lon, east] => {
            let place = [lat, north, lon, east].map(|field| (*field).to_owned());
            changed("GPGGA", move |fields| fields[2..6].clone_from_slice(&place))
        }
        ["fields", name, pairs @ ..] => replaced_fields(name, pairs),
        ["frozen-compass"] => frozen_compass(),
        ["turned-compass", degrees] => turned_compass(degrees.parse().expect("degrees")),
        ["stuck-speed"] => {
            let stuck = ["GPVTG", "", "T", "", "M", "0.00", "N", "0.00", "K"].map(str::to_owned);
            changed("GPVTG", move |fields| *fields = stuck.to_vec())
        }
        ["whole-seconds"] => changed("GPGGA", |fields| fields[1].replace_range(6.., ".00")),
        other => panic!("no tampering is {other:?}"),
    })
}

/// Replaces the first word of each pair with the second.
fn replacing(pairs: &[&str]) -> impl Fn(&str) -> String + use<> {
    let pairs: Vec<[String; 2]> = pairs
        .chunks(2)
        .map(|two| [two[0].to_owned(), two[1].to_owned()])
        .collect();
    move |text| {
        pairs
            .iter()
            .fold(text.to_owned(), |text, [from, to]| text.replace(from, to))
    }
}

/// Changes the body of each sentence and recomputes the checksums.
fn rewritten(mut change: impl FnMut(&str) -> String + 'static) -> Tamper {
    let mut line = move |line: &str| {
        let body = line
            .trim_start_matches('$')
            .split('*')
            .next()
            .unwrap_or_default();
        with_checksum(&change(body))
    };
    Box::new(move |bytes| {
        vec![
            String::from_utf8_lossy(&bytes)
                .lines()
                .map(&mut line)
                .collect::<String>()
                .into_bytes(),
        ]
    })
}

/// Changes the fields of each sentence with this name.
fn changed(name: &str, mut change: impl FnMut(&mut Vec<String>) + 'static) -> Tamper {
    let name = name.to_owned();
    rewritten(move |body| {
        let mut fields: Vec<String> = body.split(',').map(str::to_owned).collect();
        if fields[0] == name {
            change(&mut fields);
        }
        fields.join(",")
    })
}

/// Replaces the numbered fields of each sentence with this name.
fn replaced_fields(name: &str, pairs: &[&str]) -> Tamper {
    let said = |two: &[&str]| {
        (
            two[0].parse::<usize>().expect("a field's number"),
            two[1].to_owned(),
        )
    };
    let pairs: Vec<_> = pairs.chunks(2).map(said).collect();
    changed(name, move |fields| {
        pairs
            .iter()
            .for_each(|(field, text)| fields[*field].clone_from(text))
    })
}

/// A receiver that repeats its first fix with the same time, still reported as good.
fn first_fix_again() -> Tamper {
    let mut first = None;
    Box::new(move |bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (fix, rest) = text.split_once('\n').expect("several sentences");
        let fix = first.get_or_insert_with(|| fix.to_owned());
        vec![format!("{fix}\n{rest}").into_bytes()]
    })
}

/// A compass that always shows its first reading.
fn frozen_compass() -> Tamper {
    let mut first = None;
    changed("PSEAA", move |fields| {
        let now = fields[3].clone();
        fields[3].clone_from(first.get_or_insert(now));
    })
}

/// A compass that reads too high by this much, degrees.
fn turned_compass(by_deg: f64) -> Tamper {
    changed("PSEAA", move |fields| {
        let shown_deg: f64 = fields[3].parse().expect("a heading");
        fields[3] = format!("{:.1}", (shown_deg + by_deg).rem_euclid(360.0));
    })
}

/// Adds garbage between and within sentences.
fn noise() -> Tamper {
    let mut count = 0_u8;
    Box::new(move |bytes| {
        let noise: Vec<u8> = (0..200)
            .map(|i: u8| {
                count = count.wrapping_mul(97).wrapping_add(i);
                count
            })
            .collect();
        vec![
            [
                &noise,
                &b"\r\n"[..],
                &bytes,
                b"\x00\xff$PGRMCE*0E\x8e$PSRF100,",
                b"\r\n",
            ]
            .concat(),
        ]
    })
}
