//! Counting: how many tests passed, failed or were left out, read from what the test programs print.

use std::ops::AddAssign;

/// Test counts of one step or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Ran and passed.
    pub passed: usize,
    /// Ran and failed, or could not be run.
    pub failed: usize,
    /// Left out: skipped, ignored, or expected to fail.
    pub skipped: usize,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Tally) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

/// Sums the `test result:` lines of `cargo test`.
pub fn of_cargo(text: &str) -> Tally {
    let mut tally = Tally::default();
    for line in text.lines().filter(|line| line.starts_with("test result:")) {
        let counts = line.split_once(". ").map_or("", |(_, counts)| counts);
        tally += of_words(counts.split(';'));
    }
    tally
}

/// Reads the last summary line of nextest, such as `Summary [ 61.2s] 9 tests run: 7 passed (1 slow), 1 failed, 1 timed out, 2 skipped`.
pub fn of_nextest(text: &str) -> Tally {
    let summary = text.lines().rev().find_map(|line| {
        let (_, counts) = line
            .trim_start()
            .strip_prefix("Summary [")?
            .split_once("run: ")?;
        Some(counts)
    });
    of_words(summary.unwrap_or_default().split(','))
}

/// Reads the last summary line of pytest, such as `2 failed, 31 passed, 1 skipped in 4.20s`.
pub fn of_pytest(text: &str) -> Tally {
    let summary = text.lines().rev().find(|line| is_pytest_summary(line));
    let counts = summary
        .and_then(|line| line.rsplit_once(" in "))
        .map_or("", |(counts, _)| counts);
    of_words(
        counts
            .trim_matches(|c: char| c == '=' || c == ' ')
            .split(','),
    )
}

fn is_pytest_summary(line: &str) -> bool {
    line.rsplit_once(" in ").is_some_and(|(counts, time)| {
        time.starts_with(|c: char| c.is_ascii_digit())
            && counts
                .trim_matches(|c: char| c == '=' || c == ' ')
                .starts_with(|c: char| c.is_ascii_digit())
    })
}

fn of_words<'a>(parts: impl Iterator<Item = &'a str>) -> Tally {
    let mut tally = Tally::default();
    for part in parts {
        let mut words = part.split_whitespace();
        let Some(count) = words.next().and_then(|word| word.parse::<usize>().ok()) else {
            continue;
        };
        match words.next().unwrap_or_default() {
            "passed" => tally.passed += count,
            // nextest: "timed out", and "exec failed" for a program that could not be started.
            "failed" | "error" | "errors" | "xpassed" | "timed" | "exec" => tally.failed += count,
            "skipped" | "ignored" | "xfailed" => tally.skipped += count,
            _ => {}
        }
    }
    tally
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cargo_lines_are_summed() {
        let text = "running 3 tests\n\
            test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; 7 filtered out; finished in 0.1s\n\
            test result: FAILED. 4 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 2s\n";
        assert_eq!(
            of_cargo(text),
            Tally {
                passed: 7,
                failed: 2,
                skipped: 1
            }
        );
    }

    #[test]
    fn nextest_summary_is_read_with_what_never_ended() {
        let text = "     Summary [  61.201s] 9 tests run: 6 passed (1 slow), 1 failed, 1 timed out, 1 exec failed, 2 skipped\n\
            TIMEOUT [ 600.0s] thenar-contact::press hangs\n";
        assert_eq!(
            of_nextest(text),
            Tally {
                passed: 6,
                failed: 3,
                skipped: 2
            }
        );
        assert_eq!(of_nextest("error: could not compile"), Tally::default());
    }

    #[test]
    fn pytest_summary_is_read_with_and_without_frame() {
        let framed =
            "==== 2 failed, 31 passed, 1 skipped, 1 xfailed, 3 warnings, 1 error in 4.20s ====\n";
        assert_eq!(
            of_pytest(framed),
            Tally {
                passed: 31,
                failed: 3,
                skipped: 2
            }
        );
        assert_eq!(
            of_pytest("...\n5 passed in 61.00s (0:01:01)\n"),
            Tally {
                passed: 5,
                failed: 0,
                skipped: 0
            }
        );
    }

    #[test]
    fn text_without_a_summary_counts_nothing() {
        assert_eq!(of_cargo("error: could not compile"), Tally::default());
        assert_eq!(
            of_pytest("a test that failed in 3 places"),
            Tally::default()
        );
        assert_eq!(of_pytest("no tests ran in 0.01s"), Tally::default());
    }
}
