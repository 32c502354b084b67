//! A CAN message as a line of `candump -L`, there and back.

use std::fmt::Write as _;

use voltstep_bms::comm::can::Message;

/// What is said of a line that is none.
pub(super) const EXPECTED: &str = "not a line of candump, `(seconds) bus id#data`";

/// `id#data`, as `candump -L` writes it.
pub(super) fn line(message: &Message) -> String {
    let mut text = format!("{:03X}#", message.id());
    for byte in message.data() {
        let _ = write!(text, "{byte:02X}");
    }
    text
}

/// The message of a line, with or without time and bus before it; without a time, 0.
pub(super) fn parse(line: &str) -> Option<(f64, Message)> {
    let (id, data) = line.split_whitespace().next_back()?.split_once('#')?;
    let bytes: Option<Vec<u8>> = (0..data.len())
        .step_by(2)
        .map(|at| u8::from_str_radix(data.get(at..at + 2)?, 16).ok())
        .collect();
    let time = line.trim_start().strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let at_s = time.map_or(Some(0.0), |(seconds, _)| seconds.parse().ok())?;
    Some((at_s, Message::new(u16::from_str_radix(id, 16).ok()?, &bytes?)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_back() {
        let message = Message::new(0x520, &[1, 0xab, 0]).unwrap();
        assert_eq!(line(&message), "520#01AB00");
        for (text, at_s) in
            [("520#01AB00", 0.0), ("(12.5) vcan0 520#01ab00", 12.5), ("(1e9) can1 520#01AB00", 1e9)]
        {
            assert_eq!(parse(text), Some((at_s, message)), "{text}");
        }
        assert_eq!(parse("0#").map(|(_, message)| message), Message::new(0, &[]));
        let long = "520#010203040506070809";
        for text in
            ["", "520", "(now) vcan0 520#01", "520#1", "520#0g", "xyz#00", "800#00", long, "1#é"]
        {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
