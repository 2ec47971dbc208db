//! Tests the reading of sondes, by lines and by HTTP, in any split.

use super::*;

/// A conversation: `>` to the sonde, `<` from it, and `.` where the sonde closes the connection.
type Talk<'a> = &'a [(char, &'a str)];

/// The resulting values, each measurement as codes and values; every piece is split into parts of
/// this many bytes.
fn measured(sonde: &mut Sonde, talk: Talk<'_>, part: usize) -> Vec<Vec<(u16, f64)>> {
    let mut conversation = Conversation::default();
    let mut all = vec![];
    for (way, text) in talk {
        for bytes in text.as_bytes().chunks(part) {
            all.extend(conversation.read_bytes(*way == '>', bytes, sonde));
        }
        if *way == '.' {
            all.extend(conversation.end(false, sonde));
        }
    }
    let pairs = |m: Measurement| {
        m.values
            .into_iter()
            .map(|value| (value.code, value.value))
            .collect()
    };
    all.into_iter().map(pairs).collect()
}

/// The same, for a new sonde and any split.
fn values(talk: Talk<'_>) -> Vec<Vec<(u16, f64)>> {
    let all = |part| measured(&mut Sonde::default(), talk, part);
    let whole = all(usize::MAX);
    for part in [1, 2, 3, 5, 7, 11] {
        assert_eq!(all(part), whole, "in parts of {part} bytes: {talk:?}");
    }
    whole
}

const PARA: [(char, &str); 2] = [('>', "para\r"), ('<', "para\r\n1 18 212\r\n# ")];

#[test]
fn a_sonde_that_echoes_and_prompts_is_read_whatever_ends_its_lines() {
    let want = vec![vec![(1, 20.125), (18, -0.5), (212, 8e0)]];
    for end in ["\r", "\n", "\r\n"] {
        let [ask, tell] = ["data", "data|20.125 -0.5 8|# "].map(|text| text.replace('|', end));
        let ask = if ask == "data" {
            format!("{ask}{end}")
        } else {
            ask
        };
        assert_eq!(
            values(&[&PARA[..], &[('>', &ask), ('<', &tell)]].concat()),
            want,
            "{end:?}"
        );
    }
    let more = [
        [('>', "data\r"), ('<', "20.125 -0.5 8\r\n")],
        [('>', "DATA\r\n"), ('<', "#\t20.125   -0.5 8 \r\n")],
        [('>', "data\r"), ('<', "# data 20.125 -0.5 8\r\n")],
        [
            ('>', "\r\rdata\r"),
            ('<', "\r\n#\r\n# data\r\n\r\n+20.125 -5e-1 8.0\r"),
        ],
    ];
    for talk in more {
        assert_eq!(values(&[&PARA[..], &talk].concat()), want, "{talk:?}");
    }
}

#[test]
fn numbers_are_named_and_unknown_codes_keep_theirs() {
    let mut sonde = Sonde::default();
    let mut conversation = Conversation::default();
    let mut say =
        |outward, text: &str| conversation.read_bytes(outward, text.as_bytes(), &mut sonde);
    say(true, "para\r");
    say(false, "1 999\r\n");
    say(true, "data\r");
    let all = say(false, "20.5 -99999\r\n");
    let text = serde_json::to_string(&all).expect("JSON");
    let want = r#"[{"values":[{"code":1,"name":"temperature","unit":"C","value":20.5},{"code":999,"name":"unknown","unit":"","value":-99999.0}]}]"#;
    assert_eq!(text, want);
    assert_eq!((sonde.told, sonde.measured), (1, 1));
}

#[test]
fn a_server_of_http_is_read_with_and_without_lengths() {
    let head =
        "HTTP/1.0 200 OK\r\nServer: BaseHTTP/0.6\r\nDate: 1\r\nContent-type: text/plain\r\n\r\n";
    let post = "POST /data HTTP/1.1\r\nHost: sonde\r\nContent-Length: 4\r\n\r\npara";
    let codes = format!("{head}1 12");
    let data = format!("{head}20.5 35.25");
    let get = "GET /data HTTP/1.1\r\nHost: sonde\r\nAccept: */*\r\n\r\n";
    // Each answer ends with its connection.
    let mut sonde = Sonde::default();
    assert_eq!(
        measured(&mut sonde, &[('>', post), ('<', &codes), ('.', "")], 3),
        Vec::<Vec<_>>::new()
    );
    assert_eq!(sonde.told, 1);
    let want = vec![vec![(1, 20.5), (12, 35.25)]];
    assert_eq!(
        measured(&mut sonde, &[('>', get), ('<', &data), ('.', "")], 3),
        want
    );
    let posted = post.replace("para", "data");
    assert_eq!(
        measured(&mut sonde, &[('>', &posted), ('<', &data), ('.', "")], 1),
        want
    );
    assert_eq!(
        measured(&mut sonde, &[('>', get), ('<', &data)], 1),
        Vec::<Vec<_>>::new(),
        "it may go on"
    );
    // One connection for all, by lengths.
    let answer = |text: &str| format!("HTTP/1.1 200 OK\nContent-Length:{}\n\n{text}", text.len());
    let codes = answer("1 12");
    let data = answer("20.5 35.25");
    assert_eq!(
        values(&[
            ('>', post),
            ('<', &codes),
            ('>', get),
            ('<', &data),
            ('>', get),
            ('<', &data)
        ]),
        [want.clone(), want.clone()].concat()
    );
    let other = "GET /video_feed HTTP/1.1\r\n\r\n";
    assert_eq!(
        measured(&mut sonde, &[('>', other), ('<', &data)], 9),
        Vec::<Vec<_>>::new()
    );
    let chunked = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n7 8\r\n0\r\n\r\n";
    assert_eq!(
        measured(&mut sonde, &[('>', get), ('<', chunked)], 9),
        Vec::<Vec<_>>::new()
    );
}

#[test]
fn nothing_is_guessed_of_what_is_no_answer() {
    let long = format!("{}\r\n", "1 ".repeat(100_000));
    for answer in [
        "1 2\r\n",
        "1 2 3 4\r\n",
        "1 2 x\r\n",
        "nan 2 3\r\n",
        "inf 2 3\r\n",
        "1e999 2 3\r\n",
        "\u{e9} 2 3\r\n",
        &long,
    ] {
        let talk = [&PARA[..], &[('>', "data\r"), ('<', answer)]].concat();
        assert_eq!(values(&talk), Vec::<Vec<_>>::new(), "{answer:.20}");
        // The data after it is still read.
        let talk = [&talk[..], &[('<', "1 2 3\r\n")]].concat();
        assert_eq!(
            values(&talk),
            [[(1, 1.0), (18, 2.0), (212, 3.0)]],
            "{answer:.20}"
        );
    }
    for talk in [
        &[('>', "data\r"), ('<', "1 2 3\r\n")][..],
        &[
            ('>', "para\r"),
            ('<', "1 0 3\r\n"),
            ('>', "data\r"),
            ('<', "1 2 3\r\n"),
        ],
        &[
            ('>', "para\r"),
            ('<', "1 70000 3\r\n"),
            ('>', "data\r"),
            ('<', "1 2 3\r\n"),
        ],
        &[PARA[0], PARA[1], ('<', "1 2 3\r\n")],
        &[PARA[0], PARA[1], ('>', "sample\r"), ('<', "1 2 3\r\n")],
        &[PARA[0], PARA[1], ('>', "data now\r"), ('<', "1 2 3\r\n")],
    ] {
        assert_eq!(values(talk), Vec::<Vec<_>>::new(), "{talk:?}");
    }
}

#[test]
fn a_line_without_end_takes_no_memory() {
    let mut sonde = Sonde::default();
    let mut conversation = Conversation::default();
    for outward in [false, true] {
        for _ in 0..100 {
            conversation.read_bytes(outward, &[b'1'; 10_000], &mut sonde);
        }
    }
    let held =
        [&conversation.from_sonde, &conversation.to_sonde].map(|lines| format!("{lines:?}").len());
    assert!(held.iter().all(|length| *length < 200), "{held:?}");
}
