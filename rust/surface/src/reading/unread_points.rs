//! Which points that face away from a wall are worth reading through it.

use rayon::prelude::*;

use crate::reading::facing::PosedSkin;
use crate::reading::neighborhood::Vicinity;
use crate::solid::gap::Gap;
use crate::solid::product::Product;

/// Growth of depth, mm a mm, that neighbors may show; 1 in a smooth field, and some for the corners of a product.
pub(super) const STEEPEST: f64 = 1.1;

/// Settled neighbors needed, so that no vertex is judged by one other alone.
pub(super) const WITNESSES: usize = 2;

/// Up to so many items are answered one after the other: to wake other threads takes as long.
const FEW: usize = 256;

/// Points that face away from what they were measured to.
pub(super) struct Away<'a> {
    pub vicinity: &'a Vicinity<'a>,
    pub points: &'a [u32],
    pub is_unread: &'a [bool],
}

impl Away<'_> {
    /// Which of the points that face away to read next: those that some neighbors could agree with, as far as these are known.
    ///
    /// Through a wall a point is at least as deep as it is now away, so that most are never read.
    pub fn needed(
        &self,
        skin: &PosedSkin<'_>,
        product: &Product,
        gaps: &[Option<Gap>],
    ) -> Vec<usize> {
        let Away {
            vicinity,
            points: away,
            is_unread,
        } = *self;
        let gap = |i: u32| gaps[i as usize].as_ref();
        let distance = |i: u32| gap(i).map_or(f64::INFINITY, |g| g.distance);
        let (distances, deepest) = (vicinity.values(distance), STEEPEST * vicinity.reach());
        let least = vicinity.least_near(away, &distances);
        let may_be = |&k: &usize| {
            let is_deep = distance(away[k]).abs() + least[k] <= deepest;
            is_unread[k] && (is_deep || product.is_sheet_at(gap(away[k])))
        };
        let may_be: Vec<usize> = (0..away.len()).filter(may_be).collect();
        let agreeing = |&k: &usize| {
            let (i, own) = (away[k], distance(away[k]).abs());
            let agrees = |&j: &u32| {
                let apart = (skin.points[i as usize] - skin.points[j as usize]).norm();
                own + distance(j) <= STEEPEST * apart && faces_alike(skin, i, j)
            };
            let mut near = vicinity.around_where(i, &distances, |other| own + other <= deepest);
            near.retain(agrees);
            near
        };
        let found = each(&may_be, agreeing);
        let mut is_needed = vec![false; away.len()];
        for (k, agreeing) in may_be.into_iter().zip(found) {
            if agreeing.len() >= WITNESSES || product.is_sheet_at(gap(away[k])) {
                is_needed[k] = true;
                for other in agreeing {
                    if let Ok(other) = away.binary_search(&other) {
                        is_needed[other] = is_unread[other];
                    }
                }
            }
        }
        (0..away.len()).filter(|&k| is_needed[k]).collect()
    }
}

/// What `f` gives for each item, in order.
pub(super) fn each<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    if items.len() <= FEW {
        items.iter().map(f).collect()
    } else {
        items.par_iter().map(f).collect()
    }
}

/// Whether skin at two different points faces the same way, by and large.
pub(super) fn faces_alike(skin: &PosedSkin<'_>, i: u32, j: u32) -> bool {
    i != j && skin.normals[j as usize].dot(&skin.normals[i as usize]) > 0.0
}

impl Product {
    /// Whether a gap was measured to a sheet.
    pub(super) fn is_sheet_at(&self, gap: Option<&Gap>) -> bool {
        gap.is_some_and(|gap| self.is_sheet(gap.triangle as usize))
    }
}
