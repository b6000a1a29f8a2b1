//! Three edits that keep a closed mesh closed: split an edge, collapse an edge, flip an edge.

use super::topology::{GONE, Topology, next, previous};
use thenar_surface::Vec3;

/// A triangle may turn by at most 60 degrees in an edit.
const LEAST_COSINE: f64 = 0.5;

impl Topology {
    fn pair(&mut self, a: u32, b: u32) {
        self.twins[a as usize] = b;
        self.twins[b as usize] = a;
    }

    fn place(&mut self, t: u32, corners: [u32; 3]) {
        self.triangles[t as usize] = corners;
        for k in 0..3 {
            self.leaving[corners[k as usize] as usize] = 3 * t + k;
        }
    }

    /// Cuts an edge and its two triangles in half; returns the new vertex.
    pub fn split(&mut self, h: u32, at: Vec3) -> u32 {
        let o = self.twin(h);
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.end(next(h)), self.end(next(o)));
        let v = self.positions.len() as u32;
        self.positions.push(at);
        self.leaving.push(GONE);
        let (outer_bc, outer_ad) = (self.twin(next(h)), self.twin(next(o)));
        let (t, u) = (h / 3, o / 3);
        let new_t = self.triangles.len() as u32;
        let new_u = new_t + 1;
        self.triangles.extend([[0; 3]; 2]);
        self.twins.extend([GONE; 6]);
        let (outer_ca, outer_db) = (self.twin(previous(h)), self.twin(previous(o)));
        // t: a v c, new_t: v b c, u: b v d, new_u: v a d.
        self.place(t, [a, v, c]);
        self.place(new_t, [v, b, c]);
        self.place(u, [b, v, d]);
        self.place(new_u, [v, a, d]);
        self.pair(3 * t, 3 * new_u);
        self.pair(3 * t + 1, 3 * new_t + 2);
        self.pair(3 * t + 2, outer_ca);
        self.pair(3 * new_t, 3 * u);
        self.pair(3 * new_t + 1, outer_bc);
        self.pair(3 * u + 1, 3 * new_u + 2);
        self.pair(3 * u + 2, outer_db);
        self.pair(3 * new_u + 1, outer_ad);
        v
    }

    /// Merges the start of `h` into its end at `at`; false and unchanged if that would pinch or fold the skin.
    pub fn collapse(&mut self, h: u32, at: Vec3, longest: f64) -> bool {
        let o = self.twin(h);
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.end(next(h)), self.end(next(o)));
        if c == d || self.valence(c) <= 4 || self.valence(d) <= 4 {
            return false;
        }
        let around_b: Vec<u32> = self.spokes(b).map(|s| self.end(s)).collect();
        let shared = self
            .spokes(a)
            .filter(|&s| around_b.contains(&self.end(s)))
            .count();
        let valence = self.valence(a) + around_b.len() - 4;
        if shared != 2
            || !(4..=9).contains(&valence)
            || !self.may_move((a, b), at, longest)
            || !self.may_move((b, a), at, longest)
        {
            return false;
        }
        let spokes: Vec<u32> = self.spokes(a).collect();
        for s in spokes {
            self.triangles[s as usize / 3][s as usize % 3] = b;
        }
        let (bc, ca) = (self.twin(next(h)), self.twin(previous(h)));
        let (ad, db) = (self.twin(next(o)), self.twin(previous(o)));
        self.pair(bc, ca);
        self.pair(ad, db);
        for t in [h / 3, o / 3] {
            (0..3).for_each(|k| self.twins[(3 * t + k) as usize] = GONE);
        }
        self.leaving[a as usize] = GONE;
        self.positions[b as usize] = at;
        for kept in [bc, ca, ad, db] {
            let v = self.start(kept);
            self.leaving[v as usize] = kept;
        }
        true
    }

    /// True if `v` may move to `to` without folding a triangle or making an edge longer than `longest`; triangles that also hold `gone` are ignored.
    fn may_move(&self, (v, gone): (u32, u32), to: Vec3, longest: f64) -> bool {
        self.spokes(v).all(|s| {
            let (p, q) = (self.end(s), self.end(next(s)));
            if p == gone || q == gone {
                return true;
            }
            let (p, q, from) = (self.position(p), self.position(q), self.position(v));
            let (before, after) = ((p - from).cross(&(q - from)), (p - to).cross(&(q - to)));
            (p - to).norm() < longest
                && before.dot(&after) > LEAST_COSINE * before.norm() * after.norm()
        })
    }

    /// Turns the edge of `h` within its two triangles; false and unchanged if the other diagonal is there already or the skin would fold.
    pub fn flip(&mut self, h: u32) -> bool {
        let o = self.twin(h);
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.end(next(h)), self.end(next(o)));
        if c == d
            || self.valence(a) <= 4
            || self.valence(b) <= 4
            || self.spokes(c).any(|s| self.end(s) == d)
            || !self.may_flip([a, b, c, d])
        {
            return false;
        }
        let (bc, ca) = (self.twin(next(h)), self.twin(previous(h)));
        let (ad, db) = (self.twin(next(o)), self.twin(previous(o)));
        let (t, u) = (h / 3, o / 3);
        self.place(t, [c, d, b]);
        self.place(u, [d, c, a]);
        self.pair(3 * t, 3 * u);
        self.pair(3 * t + 1, db);
        self.pair(3 * t + 2, bc);
        self.pair(3 * u + 1, ca);
        self.pair(3 * u + 2, ad);
        true
    }

    fn may_flip(&self, [a, b, c, d]: [u32; 4]) -> bool {
        let [a, b, c, d] = [a, b, c, d].map(|v| self.position(v));
        let old = ((b - a).cross(&(c - a)), (a - b).cross(&(d - b)));
        let new = ((d - c).cross(&(b - c)), (c - d).cross(&(a - d)));
        let mean = old.0 + old.1;
        let fits = |n: Vec3| n.dot(&mean) > 0.7 * n.norm() * mean.norm();
        fits(new.0) && fits(new.1) && new.0.dot(&new.1) > LEAST_COSINE * new.0.norm() * new.1.norm()
    }
}
