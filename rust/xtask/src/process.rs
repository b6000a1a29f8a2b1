//! Running other programs: quietly, in view, or watched with a time limit.

use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// How many lines of a failed program's output are shown.
const TAIL_LINES: usize = 25;

/// When a watched program's output is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Line by line.
    AsItComes,
    /// Not by the watcher; whoever asked shows it.
    AtTheEnd,
}

/// What a watched program wrote and how it ended.
pub struct Watched {
    /// Standard output and error together, as they came.
    pub text: String,
    /// Ended by itself with success.
    pub succeeded: bool,
    /// Killed because it ran past its limit.
    pub timed_out: bool,
}

/// Runs without showing output; returns standard output.
///
/// # Errors
/// If the program is missing or fails: `what` it was for, and the tail of its output.
pub fn quiet(command: &mut Command, what: &str) -> Result<String> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("{what}: cannot start {}", name_of(command)))?;
    let standard = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(standard);
    }
    let both = format!("{standard}{}", String::from_utf8_lossy(&output.stderr));
    bail!(
        "{what} failed ({}):\n{}",
        ending(output.status),
        tail(&both)
    );
}

/// Runs with its output in view.
///
/// # Errors
/// If the program is missing or fails.
pub fn in_view(command: &mut Command, what: &str) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("{what}: cannot start {}", name_of(command)))?;
    if !status.success() {
        bail!("{what} failed ({})", ending(status));
    }
    Ok(())
}

/// Runs with its output kept and shown as `output` says; kills it and all it started when `limit` has passed.
///
/// # Errors
/// If the program cannot be started.
pub fn watched(command: &mut Command, limit: Duration, output: Output) -> Result<Watched> {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {}", name_of(command)))?;
    let (sender, lines) = mpsc::channel();
    if let Some(pipe) = child.stdout.take() {
        forward(pipe, sender.clone());
    }
    if let Some(pipe) = child.stderr.take() {
        forward(pipe, sender);
    }
    collect(&mut child, &lines, limit, output)
}

/// The last lines of a long text.
pub fn tail(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(TAIL_LINES)..].join("\n")
}

fn collect(
    child: &mut Child,
    lines: &mpsc::Receiver<String>,
    limit: Duration,
    output: Output,
) -> Result<Watched> {
    let end = Instant::now() + limit;
    let mut text = String::new();
    let mut timed_out = false;
    loop {
        match lines.recv_timeout(Duration::from_millis(200)) {
            Ok(line) => {
                if output == Output::AsItComes {
                    print!("{line}");
                    std::io::stdout().flush().ok();
                }
                text.push_str(&line);
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Err(mpsc::RecvTimeoutError::Timeout) => {
                // A grandchild that keeps the pipe open must not keep us.
                if child
                    .try_wait()
                    .context("cannot ask how a program ended")?
                    .is_some()
                {
                    break;
                }
            }
        }
        if Instant::now() > end {
            kill_tree(child.id());
            timed_out = true;
            break;
        }
    }
    while !timed_out && Instant::now() <= end {
        if child
            .try_wait()
            .context("cannot ask how a program ended")?
            .is_some()
        {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    if child
        .try_wait()
        .context("cannot ask how a program ended")?
        .is_none()
    {
        kill_tree(child.id());
        timed_out = true;
    }
    let status = child.wait().context("cannot ask how a program ended")?;
    Ok(Watched {
        text,
        succeeded: status.success() && !timed_out,
        timed_out,
    })
}

fn forward(pipe: impl Read + Send + 'static, sender: mpsc::Sender<String>) {
    std::thread::spawn(move || {
        let mut reader = BufReader::new(pipe);
        let mut line = Vec::new();
        while matches!(reader.read_until(b'\n', &mut line), Ok(count) if count > 0) {
            if sender
                .send(String::from_utf8_lossy(&line).into_owned())
                .is_err()
            {
                return;
            }
            line.clear();
        }
    });
}

/// Kills `id` and its descendants, parents first so that none is started anew.
fn kill_tree(id: u32) {
    if cfg!(windows) {
        Command::new("taskkill")
            .args(["/T", "/F", "/PID", &id.to_string()])
            .status()
            .ok();
        return;
    }
    let mut doomed = vec![id];
    let mut next = 0;
    while next < doomed.len() {
        let parent = doomed[next];
        doomed.extend(children_of(parent));
        next += 1;
    }
    for process in doomed {
        Command::new("kill")
            .args(["-KILL", &process.to_string()])
            .status()
            .ok();
    }
}

fn children_of(parent: u32) -> Vec<u32> {
    let Ok(processes) = std::fs::read_dir("/proc") else {
        return Vec::new();
    };
    processes
        .flatten()
        .filter_map(|entry| entry.file_name().to_string_lossy().parse().ok())
        .filter(|&process| parent_of(process) == Some(parent))
        .collect()
}

fn parent_of(process: u32) -> Option<u32> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name in brackets may hold spaces; the state and the parent follow the last bracket.
    let after_name = stat.rsplit_once(')')?.1;
    after_name.split_whitespace().nth(1)?.parse().ok()
}

fn ending(status: ExitStatus) -> String {
    match status.code() {
        Some(code) => format!("exit code {code}"),
        None => "killed by a signal".to_string(),
    }
}

fn name_of(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn quiet_returns_output_or_what_failed_with_its_tail() {
        assert_eq!(quiet(&mut shell("echo yes"), "asking").unwrap(), "yes\n");
        let error = quiet(&mut shell("echo reason >&2; exit 3"), "asking")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("asking failed (exit code 3)") && error.contains("reason"),
            "{error}"
        );
    }

    #[test]
    fn watched_keeps_output_of_both_pipes() {
        let end = watched(
            &mut shell("echo out; echo err >&2"),
            Duration::from_secs(20),
            Output::AsItComes,
        )
        .unwrap();
        assert!(end.succeeded && end.text.contains("out") && end.text.contains("err"));
    }

    #[test]
    fn watched_kills_a_hanging_program_and_what_it_started() {
        let start = Instant::now();
        let end = watched(
            &mut shell("sleep 61.25 & sleep 61.25; :"),
            Duration::from_millis(600),
            Output::AtTheEnd,
        )
        .unwrap();
        assert!(end.timed_out && !end.succeeded);
        assert!(start.elapsed() < Duration::from_secs(20));
        let left = Command::new("pgrep")
            .args(["-f", "^sleep 61.25"])
            .output()
            .unwrap();
        assert!(left.stdout.is_empty(), "a grandchild survived");
    }

    #[test]
    fn watched_ends_although_a_grandchild_keeps_the_pipe() {
        let start = Instant::now();
        let end = watched(
            &mut shell("sleep 5 & echo done"),
            Duration::from_secs(30),
            Output::AtTheEnd,
        )
        .unwrap();
        assert!(end.succeeded && end.text.contains("done"));
        assert!(start.elapsed() < Duration::from_secs(4));
    }
}
