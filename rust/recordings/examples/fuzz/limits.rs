//! Time and memory of one input: an allocator that counts, a thread that ends a hang, and the input on disk before it is read.

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Longest that an input may take.
pub const LONGEST: Duration = Duration::from_secs(5);
/// Most memory that an input may take, bytes.
pub const MOST_BYTES: usize = 1 << 30;
/// When a read that goes on is taken for a hang; the process then ends.
const HANGS: Duration = Duration::from_secs(60);
/// What the allocator refuses, bytes.
const REFUSED: usize = 8 << 30;
/// No input is being read.
const IDLE: u64 = u64::MAX;

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
/// When the input began, ms since the start; or `IDLE`.
static BEGAN: AtomicU64 = AtomicU64::new(IDLE);
static PANIC: Mutex<String> = Mutex::new(String::new());

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// SAFETY: every call goes to the system's allocator with the same layout.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Relaxed) + layout.size();
        PEAK.fetch_max(now, Relaxed);
        if now > REFUSED {
            return std::ptr::null_mut();
        }
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let now = NOW.fetch_add(size, Relaxed) + size;
        // Old and new exist at once where the system copies.
        PEAK.fetch_max(now, Relaxed);
        NOW.fetch_sub(layout.size(), Relaxed);
        if now > REFUSED {
            return std::ptr::null_mut();
        }
        unsafe { System.realloc(place, layout, size) }
    }
}

/// Where inputs are kept, and the clock.
pub struct Limits {
    out: PathBuf,
    started: Instant,
}

/// One input that is being read.
pub struct Watch {
    began: Instant,
    before: usize,
}

/// What an input took.
pub struct Taken {
    pub time: Duration,
    pub bytes: usize,
}

impl Limits {
    pub fn start(out: &Path) -> Limits {
        let started = Instant::now();
        let folder = out.to_path_buf();
        std::thread::spawn(move || {
            loop {
                std::thread::sleep(Duration::from_millis(500));
                let began = BEGAN.load(Relaxed);
                let now = started.elapsed().as_millis() as u64;
                if began != IDLE && now.saturating_sub(began) > HANGS.as_millis() as u64 {
                    println!(
                        "HANG of more than {} s: {}",
                        HANGS.as_secs(),
                        last(&folder).display()
                    );
                    std::process::abort();
                }
            }
        });
        Limits {
            out: out.to_path_buf(),
            started,
        }
    }

    /// Writes the input where it is found if the process ends, and starts the clock.
    pub fn begin(&self, name: &str, input: &[u8]) -> Watch {
        let named = [name.as_bytes(), b"\n", input].concat();
        std::fs::write(last(&self.out), named).unwrap();
        let before = NOW.load(Relaxed);
        PEAK.store(before, Relaxed);
        BEGAN.store(self.started.elapsed().as_millis() as u64, Relaxed);
        Watch {
            began: Instant::now(),
            before,
        }
    }

    /// Keeps an input that broke a bound.
    pub fn keep(&self, name: &str, input: &[u8], number: usize) -> PathBuf {
        let file = self
            .out
            .join(format!("fault_{number}_{}", name.replace(' ', "_")));
        std::fs::write(&file, input).unwrap();
        file
    }
}

impl Watch {
    pub fn end(self) -> Taken {
        BEGAN.store(IDLE, Relaxed);
        Taken {
            time: self.began.elapsed(),
            bytes: PEAK.load(Relaxed).saturating_sub(self.before),
        }
    }
}

/// The input that is being read: a line with the reader's name, then its bytes.
fn last(out: &Path) -> PathBuf {
    out.join("last")
}

/// Keeps where a panic came from, for the fault that it is.
pub fn note_panic(info: &std::panic::PanicHookInfo) {
    *PANIC.lock().unwrap() = info.to_string().replace('\n', " ");
}

pub fn last_panic() -> String {
    PANIC.lock().unwrap().clone()
}
