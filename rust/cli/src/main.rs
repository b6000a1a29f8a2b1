//! The thenar binary: arguments, files, exit codes. Knows no algorithm.

mod arguments;
mod compare;
mod diagnose;
mod effects;
mod fault;
mod interrupt;
mod materials;
mod press;
mod progress;
mod protocol;
mod read;
mod regions;
mod results;
mod table;
mod threads;

use arguments::{Command, Thenar};
use clap::Parser;
use fault::{Fault, printable};
use std::io::Write;
use std::panic::catch_unwind;
use std::process::ExitCode;
use std::sync::Mutex;

/// Where the last panic happened.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST_PANIC.lock() {
            *last = panic.to_string().replace('\n', " ");
        }
    }));
    let outcome = catch_unwind(run).unwrap_or_else(|_| {
        let place = LAST_PANIC
            .lock()
            .map(|last| last.clone())
            .unwrap_or_default();
        Err(Fault::Other(format!(
            "an error inside thenar ({place}); please report it with the files that caused it"
        )))
    });
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            fault.complain();
            ExitCode::from(fault.code() as u8)
        }
    }
}

fn run() -> Result<(), Fault> {
    let thenar = match Thenar::try_parse() {
        Ok(thenar) => thenar,
        Err(error) if error.use_stderr() => return Err(Fault::Input(arguments::sentence(&error))),
        Err(help) => {
            tell(&help.to_string());
            return Ok(());
        }
    };
    match thenar.command {
        Command::Press(arguments) => press::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Read(arguments) => {
            tell(&read::report(&arguments)?);
            Ok(())
        }
    }
}

/// Writes to the terminal; a reader that has gone away (`thenar ... | head`) is no fault.
fn tell(text: &str) {
    let _ = std::io::stdout().write_all(printable(text).as_bytes());
}
