//! Sorting by a bucket number, then by key.

/// Sorts by a bucket number below `buckets`, then by key: counted first, so that only the few of one bucket are compared.
pub(crate) fn sort_by_bucket<T: Copy, K: Ord>(
    buckets: usize,
    items: Vec<T>,
    bucket: impl Fn(&T) -> u32,
    key: impl Fn(&T) -> K,
) -> Vec<T> {
    let mut next = vec![0u32; buckets + 1];
    items
        .iter()
        .for_each(|item| next[bucket(item) as usize + 1] += 1);
    for i in 1..next.len() {
        next[i] += next[i - 1];
    }
    let mut sorted = items.clone();
    for item in &items {
        let at = &mut next[bucket(item) as usize];
        sorted[*at as usize] = *item;
        *at += 1;
    }
    // Each bucket now ends where the next one of the untouched counts would begin.
    let mut start = 0;
    for end in next.into_iter().take(buckets) {
        sorted[start..end as usize].sort_unstable_by_key(&key);
        start = end as usize;
    }
    sorted
}
