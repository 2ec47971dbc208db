//! Splits the bytes of a link into lines, per direction.

/// A line of this length (bytes) is returned even if it has not ended: no sentence is that long.
const LONGEST: usize = 1024;

/// A line on a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Whether it goes to the boat.
    pub outward: bool,
    /// The line without its line end; anything but printable ASCII is escaped.
    pub text: String,
}

impl Line {
    /// The kind of sentence, such as `GPRMC`; `other` if it is not a sentence.
    pub fn kind(&self) -> &str {
        let body = self.text.strip_prefix(['$', '!']).unwrap_or_default();
        let kind = body.split([',', '*']).next().unwrap_or_default();
        let is_kind = !kind.is_empty()
            && kind.len() <= 8
            && kind.bytes().all(|byte| byte.is_ascii_alphanumeric());
        if is_kind { kind } else { "other" }
    }
}

/// Assembles lines from chunks.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// Incomplete lines: inward, outward.
    begun: [Vec<u8>; 2],
}

impl Lines {
    /// Adds bytes; returns the lines that they complete.
    pub fn take(&mut self, outward: bool, bytes: &[u8]) -> Vec<Line> {
        let mut lines = vec![];
        let begun = &mut self.begun[usize::from(outward)];
        for byte in bytes {
            if *byte != b'\n' {
                begun.push(*byte);
            }
            if *byte == b'\n' || begun.len() >= LONGEST {
                lines.extend(line(std::mem::take(begun), outward));
            }
        }
        lines
    }

    /// The incomplete lines.
    pub fn rest(self) -> Vec<Line> {
        self.begun
            .into_iter()
            .zip([false, true])
            .filter_map(|(bytes, outward)| line(bytes, outward))
            .collect()
    }
}

/// A line, unless it is empty.
fn line(bytes: Vec<u8>, outward: bool) -> Option<Line> {
    let bytes = bytes.strip_suffix(b"\r").unwrap_or(&bytes);
    (!bytes.is_empty()).then(|| Line {
        outward,
        text: bytes.escape_ascii().to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_whole_whatever_the_pieces() {
        let bytes_in = b"$GPRMC,1*00\r\n\r\n$PSEAC,T,0*0D\r\nrest";
        for cut in 0..bytes_in.len() {
            let mut lines = Lines::default();
            let mut all = lines.take(false, &bytes_in[..cut]);
            // The directions do not mix.
            assert_eq!(lines.take(true, b"$PSEAC,L"), []);
            all.extend(lines.take(false, &bytes_in[cut..]));
            all.extend(lines.rest());
            let texts: Vec<(&str, bool)> = all
                .iter()
                .map(|line| (line.text.as_str(), line.outward))
                .collect();
            let want = [
                ("$GPRMC,1*00", false),
                ("$PSEAC,T,0*0D", false),
                ("rest", false),
                ("$PSEAC,L", true),
            ];
            assert_eq!(texts, want, "cut at {cut}");
        }
    }

    #[test]
    fn kinds_are_the_first_words_of_sentences() {
        for (text, want) in [
            ("$GPRMC,1*00", "GPRMC"),
            ("!AIVDM,1", "AIVDM"),
            ("$PSEAG*22", "PSEAG"),
            ("hello", "other"),
            ("$,", "other"),
            ("", "other"),
        ] {
            assert_eq!(
                Line {
                    outward: false,
                    text: text.to_owned()
                }
                .kind(),
                want,
                "{text}"
            );
        }
    }

    #[test]
    fn noise_is_cut_and_escaped() {
        let mut lines = Lines::default();
        let all = lines.take(false, &[0xff; 3000]);
        assert_eq!((all.len(), lines.begun[0].len()), (2, 3000 - 2 * LONGEST));
        assert!(all[0].text.starts_with("\\xff\\xff"));
    }
}
