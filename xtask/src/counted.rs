//! Counted instructions and measured sections, as the tools write them.

use anyhow::{Context, Result, bail, ensure};

/// Instructions per call: least, mean, most.
pub type Counted = (u64, f64, u64);

/// Minimum, mean and maximum of each item, from the plugin's log.
pub fn parse_counts(log: &str) -> Result<Vec<(String, Counted)>> {
    log.lines()
        .filter_map(|line| line.strip_prefix("count "))
        .map(|line| {
            let words: Vec<_> = line.split(' ').collect();
            let [name, figures @ ..] = &words[..] else { bail!("cannot read `{line}`") };
            let figures: Vec<u64> =
                figures.iter().map(|word| word.parse()).collect::<Result<_, _>>()?;
            let [calls, sum, min, max, _at] = figures[..] else { bail!("cannot read `{line}`") };
            ensure!(calls > 0, "`{name}` was never called, or is one function with another item");
            #[expect(clippy::cast_precision_loss, reason = "sums stay below 2^53")]
            let mean = sum as f64 / calls as f64;
            // As many places as the table shows, so that baseline and table agree.
            Ok((String::from(*name), (min, (mean * 10.0).round() / 10.0, max)))
        })
        .collect()
}

/// The sum of some sections in the output of `size -A`.
pub fn section_bytes(sizes: &str, sections: &[&str]) -> Result<u64> {
    let mut sum = 0;
    for line in sizes.lines() {
        let mut words = line.split_whitespace();
        if let (Some(section), Some(bytes)) = (words.next(), words.next())
            && sections.contains(&section)
        {
            sum += bytes.parse::<u64>().with_context(|| format!("cannot read `{line}`"))?;
        }
    }
    ensure!(sum > 0, "the image is empty");
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_are_read() {
        let counts = parse_counts("count battery 4 402 100 101 2\nrun 40 7\n").unwrap();
        assert_eq!(counts, [(String::from("battery"), (100, 100.5, 101))]);
        assert!(parse_counts("count battery 0 0 0 0 0").is_err(), "never called");
        assert!(parse_counts("count battery 4").is_err());
    }

    #[test]
    fn sections_are_summed() {
        let sizes = ".text   100  1024\n.rodata 20 0\n.debug 9999 0\n.data 4 0\nTotal 1\n";
        assert_eq!(section_bytes(sizes, &[".text", ".rodata", ".data"]).unwrap(), 124);
        assert!(section_bytes("", &[".text"]).is_err());
    }
}
