//! Steps of a run: one after the other or side by side, each with a time limit, and one honest sum at the end.

use crate::process::{self, Output, Watched};
use crate::test_run::tally::{self, Tally};
use std::process::{Command, ExitCode};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest time for one step; the longest takes a few minutes on two cores.
const LIMIT: Duration = Duration::from_secs(30 * 60);

/// How many steps of Python tests run at a time; most of them keep one core busy.
const LANES: usize = 2;

/// How the tests of a step are counted.
#[derive(Clone, Copy)]
pub enum Counted {
    AsOne,
    ByCargo,
    ByNextest,
    ByPytest,
}

pub struct Step {
    pub name: String,
    pub command: Command,
    counted: Counted,
}

pub struct Done {
    pub name: String,
    pub tally: Tally,
    pub seconds: f64,
    pub note: &'static str,
}

pub fn step(name: &str, command: Command, counted: Counted) -> Step {
    Step {
        name: name.to_string(),
        command,
        counted,
    }
}

/// Runs steps side by side in the order given, each one's output printed whole at its end; done in that order too.
pub fn run_in_lanes(steps: Vec<Step>) -> Vec<Done> {
    let count = steps.len();
    let waiting = Mutex::new(steps.into_iter().enumerate());
    let done = Mutex::new(Vec::with_capacity(count));
    std::thread::scope(|scope| {
        for _ in 0..LANES {
            scope.spawn(|| {
                loop {
                    let next = locked(&waiting).next();
                    let Some((place, step)) = next else { break };
                    println!("\n== {} begins", step.name);
                    // Not while the list is locked, or no two steps would run at a time.
                    let ended = run_step(step, Output::AtTheEnd);
                    locked(&done).push((place, ended));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, done)| done).collect()
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs steps one after another, their output as it comes, and prints the sum.
pub fn run_in_view(steps: Vec<Step>) -> ExitCode {
    let mut done = Vec::new();
    for step in steps {
        println!("\n== {}", step.name);
        done.push(run_step(step, Output::AsItComes));
    }
    report(&done)
}

pub fn run_step(mut step: Step, output: Output) -> Done {
    let start = Instant::now();
    let ended = process::watched(&mut step.command, LIMIT, output);
    if let (Output::AtTheEnd, Ok(end)) = (output, &ended) {
        println!("\n== {}\n{}", step.name, end.text.trim_end());
    }
    let (tally, note) = match ended {
        Ok(end) if end.timed_out => (count(step.counted, &end), "ran past its time limit"),
        Ok(end) => (count(step.counted, &end), ""),
        Err(error) => {
            println!("{error:#}");
            (
                Tally {
                    failed: 1,
                    ..Tally::default()
                },
                "could not be run",
            )
        }
    };
    Done {
        name: step.name,
        tally,
        seconds: start.elapsed().as_secs_f64(),
        note,
    }
}

fn count(counted: Counted, end: &Watched) -> Tally {
    let mut tally = match counted {
        Counted::AsOne => Tally {
            passed: usize::from(end.succeeded),
            ..Tally::default()
        },
        Counted::ByCargo => tally::of_cargo(&end.text),
        Counted::ByNextest => tally::of_nextest(&end.text),
        Counted::ByPytest => tally::of_pytest(&end.text),
    };
    // What fails without naming a test (a compiler error, a hang), and what holds no test at all, is a failure too.
    if (!end.succeeded && tally.failed == 0) || tally == Tally::default() {
        tally.failed = 1;
    }
    tally
}

pub fn report(done: &[Done]) -> ExitCode {
    let mut sum = Tally::default();
    println!(
        "\n{:<38} {:>7} {:>7} {:>7} {:>8}",
        "step", "passed", "failed", "skipped", "seconds"
    );
    for Done {
        name,
        tally,
        seconds,
        note,
    } in done
    {
        println!(
            "{name:<38} {:>7} {:>7} {:>7} {seconds:>8.1} {note}",
            tally.passed, tally.failed, tally.skipped
        );
        sum += *tally;
    }
    println!("\n{} skipped or ignored", sum.skipped);
    println!("{} passed, {} failed", sum.passed, sum.failed);
    if sum.failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two steps of which each waits for the other's file: one after the other neither would end well.
    #[test]
    fn lanes_run_two_steps_at_a_time_and_keep_their_order() {
        let folder = std::env::temp_dir().join(format!("thenar-lanes-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let meets = |own: &str, other: &str| {
            let wait = format!(
                "touch {own}; for k in $(seq 100); do [ -e {other} ] && exit 0; sleep 0.1; done; exit 1"
            );
            let mut command = Command::new("sh");
            command.current_dir(&folder).args(["-c", &wait]);
            step(own, command, Counted::AsOne)
        };
        let done = run_in_lanes(vec![meets("a", "b"), meets("b", "a"), meets("c", "a")]);
        std::fs::remove_dir_all(&folder).ok();
        let names: Vec<&str> = done.iter().map(|d| d.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "c"]);
        assert!(
            done.iter()
                .all(|d| d.tally.passed == 1 && d.tally.failed == 0)
        );
    }
}
