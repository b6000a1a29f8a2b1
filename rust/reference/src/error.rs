//! What can go wrong in a reference solve.

/// Why a reference solve has no result.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The tissue cannot be meshed or computed as given.
    #[error("{what}: found {found}; {remedy}")]
    Tissue {
        /// Which input, and where.
        what: String,
        /// The value found there.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// Tissue thicker than the body: its columns to the bone cross.
    #[error(
        "the columns from skin to bone cross at {crossed} of {pressed} vertices inside the product, most of all at skin vertex {vertex}, where \
         tissue is {thickness_mm:.1} mm thick; give thinner tissue there, the body is not as thick as that"
    )]
    TooThick {
        /// Vertices inside the product whose column crosses a neighbor's.
        crossed: usize,
        /// Vertices inside the product.
        pressed: usize,
        /// The one of them with the most tissue.
        vertex: usize,
        /// Its tissue, mm.
        thickness_mm: f64,
    },
    /// The equations were not solved to their tolerance.
    #[error(
        "the reference solve stopped at {share:.0} % of the depth: {unbalanced:.1} % of the contact force is not balanced, most at skin \
         vertex {vertex}; {}", if *.share > 99.0 && *.unbalanced < 5.0 {
             "round sharp edges of the product there (Bevel), subdivide the skin, or press less deep"
         } else {
             "press less deep, or give thicker tissue there"
         }
    )]
    Unsolved {
        /// How much of the depth was reached, %.
        share: f64,
        /// Norm of the residual over the norm of the contact forces, %.
        unbalanced: f64,
        /// Vertex with the largest residual.
        vertex: usize,
    },
    /// The product reaches into the bone.
    #[error(
        "the product reaches {depth_mm:.1} mm into the bone under skin vertex {vertex}; press less deep"
    )]
    Bone {
        /// Skin vertex over the deepest place.
        vertex: usize,
        /// How deep, mm.
        depth_mm: f64,
    },
    /// Skin stays inside the product.
    #[error(
        "skin vertex {vertex} stays {depth_mm:.2} mm inside the product, which leaves {bone_gap_mm:.1} mm to the bone there; press less deep"
    )]
    Inside {
        /// The deepest vertex.
        vertex: usize,
        /// How deep it stays, mm.
        depth_mm: f64,
        /// Distance of the bone under it to the product, mm.
        bone_gap_mm: f64,
    },
    /// The product comes through the skin between its vertices.
    #[error(
        "between the vertices of the skin the product cuts {depth_mm:.2} mm into it, most at skin vertex {vertex}, with {share:.0} % of the \
         overlap; subdivide the skin there, round sharp edges of the product (Bevel), or press less deep"
    )]
    Cut {
        /// The nearest vertex.
        vertex: usize,
        /// How deep, mm.
        depth_mm: f64,
        /// Volume that stays in the product, % of that before the press.
        share: f64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl ReferenceError {
    /// Skin vertex that it names.
    pub fn vertex(&self) -> Option<usize> {
        match self {
            ReferenceError::TooThick { vertex, .. }
            | ReferenceError::Unsolved { vertex, .. }
            | ReferenceError::Inside { vertex, .. }
            | ReferenceError::Bone { vertex, .. }
            | ReferenceError::Cut { vertex, .. } => Some(*vertex),
            ReferenceError::Tissue { .. } | ReferenceError::Cancelled => None,
        }
    }

    /// The same with a vertex that was given in place of one that was added between two; `parents` of those after `count`.
    pub(crate) fn without(mut self, count: usize, parents: &[[u32; 2]]) -> ReferenceError {
        if let ReferenceError::TooThick { vertex, .. }
        | ReferenceError::Unsolved { vertex, .. }
        | ReferenceError::Inside { vertex, .. }
        | ReferenceError::Bone { vertex, .. }
        | ReferenceError::Cut { vertex, .. } = &mut self
        {
            while *vertex >= count {
                *vertex = parents[*vertex - count][0] as usize;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a sharp edge, as that of a hole, a small part of the force finds no balance at full depth.
    #[test]
    fn a_small_rest_at_full_depth_names_sharp_edges() {
        let said = |share, unbalanced| {
            let error = ReferenceError::Unsolved {
                share,
                unbalanced,
                vertex: 7,
            };
            error.to_string()
        };
        assert!(said(100.0, 1.5).contains("(Bevel)") && said(100.0, 1.5).contains("skin vertex 7"));
        assert!(said(60.0, 1.5).contains("thicker") && said(100.0, 30.0).contains("thicker"));
    }

    /// Vertices that were added follow those that were given.
    #[test]
    fn a_vertex_that_was_added_is_named_by_one_that_was_given() {
        let error = ReferenceError::Cut {
            vertex: 11,
            depth_mm: 1.0,
            share: 50.0,
        };
        assert_eq!(error.without(10, &[[3, 4], [10, 5]]).vertex(), Some(3));
    }
}
