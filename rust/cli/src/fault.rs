//! Why the binary ends without a result, and the exit code that says so.

use std::io::Write;

use thenar_contact::ContactError;
use thenar_inference::InferenceError;
use thenar_recordings::RecordingError;

/// One sentence each.
#[derive(Debug)]
pub enum Fault {
    /// Bad input or usage: exit code 2.
    Input(String),
    /// Anything else: exit code 1.
    Other(String),
}

impl Fault {
    /// Ctrl-C before anything was written.
    pub fn cancelled() -> Fault {
        Fault::Other("cancelled; nothing was written".into())
    }

    /// Exit code of the process.
    pub fn code(&self) -> i32 {
        match self {
            Fault::Input(_) => 2,
            Fault::Other(_) => 1,
        }
    }

    /// Writes why the work failed; a standard error that is closed or full changes nothing, least of all the exit code.
    pub fn complain(&self) {
        let _ = writeln!(
            std::io::stderr(),
            "thenar: {}",
            printable(&self.to_string())
        );
    }
}

/// The text without what moves a terminal's cursor or changes its state: names out of files stand in it.
pub fn printable(text: &str) -> String {
    let safe = |c: char| if c.is_control() && c != '\n' { '?' } else { c };
    text.chars().map(safe).collect()
}

impl std::fmt::Display for Fault {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (Fault::Input(sentence) | Fault::Other(sentence)) = self;
        formatter.write_str(sentence)
    }
}

impl From<ContactError> for Fault {
    fn from(error: ContactError) -> Fault {
        match error {
            ContactError::Cancelled => Fault::cancelled(),
            error => Fault::Input(error.to_string()),
        }
    }
}

impl From<RecordingError> for Fault {
    fn from(error: RecordingError) -> Fault {
        Fault::Input(error.to_string())
    }
}

impl From<InferenceError> for Fault {
    fn from(error: InferenceError) -> Fault {
        match error {
            InferenceError::Cancelled => Fault::cancelled(),
            error => Fault::Input(error.to_string()),
        }
    }
}
