//! The thenar binary: arguments, files, exit codes. Knows no algorithm.

mod commands;
mod arguments;
mod effects;
mod fault;
mod interrupt;
mod materials;
mod progress;
mod protocol;
mod regions;
mod results;
mod table;
mod terminal;
mod threads;

use arguments::{Command, Thenar};
use clap::Parser;
use fault::Fault;
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
            terminal::write(&help.to_string());
            return Ok(());
        }
    };
    match thenar.command {
        Command::Press(arguments) => commands::press::run(&arguments),
        Command::Compare(arguments) => commands::compare::run(&arguments),
        Command::Diagnose(arguments) => commands::diagnose::run(&arguments),
        Command::Read(arguments) => {
            terminal::write(&commands::read::report(&arguments)?);
            Ok(())
        }
    }
}
