//! The lines in one direction between a sonde and a client, as plain lines or over HTTP.

/// Maximum bytes of a line: about ten characters for each of the maximum number of parameters.
const LINE_MAX: usize = 2048;

/// Assembles lines from bytes in any split. A line ends with CR, LF or both, or after the length
/// stated in the head of an HTTP message. Only the first line of such a head is returned.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    line: Vec<u8>,
    is_overlong: bool,
    /// Whether the previous byte was a CR, to which a LF belongs.
    after_cr: bool,
    part: Part,
}

/// The part to which the next byte belongs.
#[derive(Clone, Copy, Debug, Default)]
enum Part {
    #[default]
    Line,
    /// The head of an HTTP message, whose body has this length, bytes.
    Head { body: usize },
    /// The body, with this many bytes left.
    Body { left: usize },
    /// Unreadable data: the chunked body of an HTTP message, and possibly further messages.
    Chunks,
}

impl Lines {
    /// Adds a byte. Returns the line that it ends, unless that is empty, too long or not text.
    pub(super) fn push_byte(&mut self, byte: u8) -> Option<String> {
        if std::mem::take(&mut self.after_cr) && byte == b'\n' {
            return None;
        }
        let is_end = matches!(byte, b'\r' | b'\n');
        if !is_end {
            self.add(byte);
        }
        match self.part {
            // Chunked bodies are not read: a server at a sonde speaks HTTP/1.0, which has none.
            Part::Chunks => {
                self.line.clear();
                None
            }
            Part::Body { left } => {
                self.part = if left > 1 {
                    Part::Body { left: left - 1 }
                } else {
                    Part::Line
                };
                if is_end || left <= 1 {
                    self.end()
                } else {
                    None
                }
            }
            Part::Line if is_end => {
                self.after_cr = byte == b'\r';
                let line = self.end();
                if line.as_deref().is_some_and(begins_http) {
                    self.part = Part::Head { body: 0 };
                }
                line
            }
            Part::Head { body } if is_end => {
                self.after_cr = byte == b'\r';
                let is_empty = self.line.is_empty() && !self.is_overlong;
                let line = self.end().unwrap_or_default().to_ascii_lowercase();
                self.part = match line
                    .split_once(':')
                    .map(|(name, value)| (name.trim(), value.trim()))
                {
                    _ if is_empty && body > 0 => Part::Body { left: body },
                    _ if is_empty => Part::Line,
                    Some(("content-length", length)) => Part::Head {
                        body: length.parse().unwrap_or(0),
                    },
                    Some(("transfer-encoding", coding)) if coding != "identity" => Part::Chunks,
                    _ => self.part,
                };
                None
            }
            Part::Line | Part::Head { .. } => None,
        }
    }

    /// Ends the input; returns the unfinished line.
    pub(super) fn end(&mut self) -> Option<String> {
        let line = std::mem::take(&mut self.line);
        if std::mem::take(&mut self.is_overlong) || line.is_empty() {
            return None;
        }
        // Noise on a serial line is neither text nor an answer.
        String::from_utf8(line).ok()
    }

    fn add(&mut self, byte: u8) {
        // Dropped completely: a truncated line would be read as one with fewer values.
        self.is_overlong |= self.line.len() >= LINE_MAX;
        if self.is_overlong {
            self.line.clear();
        } else {
            self.line.push(byte);
        }
    }
}

/// Whether a line is the first of an HTTP request or response.
fn begins_http(line: &str) -> bool {
    line.starts_with("HTTP/1.") || line.ends_with(" HTTP/1.0") || line.ends_with(" HTTP/1.1")
}
