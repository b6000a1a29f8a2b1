//! Stage 3: the response of the skin to forces.

pub mod assembly;
pub mod bonded_layer;
pub mod entries;
pub mod grid;
pub mod kernel;
pub mod near;
pub mod near_along;
mod near_home;
mod near_rows;
pub mod rounded;
pub mod stiff_skin;
pub mod rows;
pub mod sheet;
pub mod skin_metric;

#[cfg(test)]
pub(crate) mod test_sheet;
