//! Which edges of the program an input reached, where the build counts them.
//!
//! Builds with LLVM's inline 8-bit counters call the two functions below for every object file before `main`; other builds never do,
//! and then no input is ever new.

use std::sync::Mutex;

/// Start and length of each object file's counters.
static COUNTERS: Mutex<Vec<(usize, usize)>> = Mutex::new(Vec::new());

/// SAFETY of the name: the one LLVM's instrumentation calls; nothing else defines it.
#[unsafe(no_mangle)]
extern "C" fn __sanitizer_cov_8bit_counters_init(start: *mut u8, stop: *mut u8) {
    let mut all = COUNTERS.lock().unwrap();
    let length = stop as usize - start as usize;
    if !all.contains(&(start as usize, length)) {
        all.push((start as usize, length));
    }
}

#[unsafe(no_mangle)]
extern "C" fn __sanitizer_cov_pcs_init(_: *const usize, _: *const usize) {}

fn each(mut visit: impl FnMut(usize, &mut u8)) {
    let mut number = 0;
    for (start, length) in COUNTERS.lock().unwrap().iter() {
        // SAFETY: LLVM's linker section of counters, alive for the whole run; races of other threads change counts only.
        let counters = unsafe { std::slice::from_raw_parts_mut(*start as *mut u8, *length) };
        for counter in counters {
            if *counter != 0 {
                visit(number, counter);
            }
            number += 1;
        }
    }
}

/// Begins to count for one input.
pub fn clear() {
    each(|_, counter| *counter = 0);
}

/// Whether the input since `clear` reached an edge, or a number of times, that is not in `seen`; notes it there.
pub fn is_new(seen: &mut Vec<u8>) -> bool {
    let mut is_new = false;
    each(|number, counter| {
        if seen.len() <= number {
            seen.resize(number + 1, 0);
        }
        // 1, 2, 3, 4-7, 8-15, 16-31, 32-127, 128 and more.
        let class = match *counter {
            count @ 1..=3 => 1 << (count - 1),
            4..=7 => 8,
            8..=15 => 16,
            16..=31 => 32,
            32..=127 => 64,
            _ => 128_u8,
        };
        is_new |= seen[number] & class == 0;
        seen[number] |= class;
    });
    is_new
}
